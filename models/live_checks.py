"""What a running model carries and what of it may change."""

from dataclasses import replace
from math import isclose, isfinite

import numpy as np

from models.arrays import FloatArray
from models.effects.protocol import Effect, Measurement
from models.errors import InputError
from models.plant import Plant
from models.ports import Contact

PROBES = (1e-4, 2e-4)
"""Penetrations, m, at which a law is asked what its damping is."""

MEND = "start a new model with LiveModel.of"
STAYS = "a running model keeps its modes, its ports and its rest; laws and contacts may take other numbers"


def check_live(plant: Plant, fs: float) -> None:
    """Refuse a plant that cannot run block by block.

    Args:
        plant: the rig with its effects.
        fs: rate of force and channels, Hz.

    Raises:
        InputError: no force, no sensor, an effect that looks beyond a block, or a stiffness that drifts.
    """
    quantity = None if plant.excitation is None else plant.excitation.quantity
    if quantity != "force":
        raise InputError(
            f"excitation.quantity = {quantity!r}" if quantity else "a rig without excitation",
            "a live model is driven by a force",
            "simulate the whole record",
        )
    if not plant.sensors:
        raise InputError("a rig without sensors", "a live model answers with their channels", "give the rig a sensor")
    for effect in plant.effects:
        if not _is_pointwise(effect, plant, fs):
            raise InputError(
                effect.label(),
                "a live model carries what acts sample by sample; no shaken base, delay or number of a record's own",
                "leave it out or simulate the whole record",
            )
    if plant.structure.stiffness_rate != 0.0:
        still = replace(plant.structure, stiffness_rate=0.0)
        drifting = [e.label() for e in plant.effects if e.change_structure(still).stiffness_rate != 0.0]
        raise InputError(
            ", ".join(drifting) or f"structure.stiffness_rate = {plant.structure.stiffness_rate:g} 1/s",
            "a live model keeps its linear structure; laws and contacts may change in time",
            "leave it out or simulate the whole record",
        )


def _is_pointwise(effect: Effect, plant: Plant, fs: float) -> bool:
    """Whether an effect on the measurement does to a signal what it does to its two parts."""
    kind = type(effect)
    if kind.record_parameters or kind.base_acceleration is not Effect.base_acceleration:
        return False
    measurement = Measurement(tuple(sensor.name for sensor in plant.sensors), fs, {})

    def read(signals: FloatArray) -> FloatArray:
        return np.vstack(
            [effect.change_excitation(signals[0]), effect.change_channels(signals[1:].copy(), measurement)]
        )

    probe = np.cos(np.arange(64.0) ** 2 + np.arange(1.0 + len(plant.sensors))[:, None])
    return np.array_equal(read(probe), np.hstack([read(probe[:, :40]), read(probe[:, 40:])]))


def check_change(plant: Plant, old: Plant) -> None:
    """Refuse a plant whose modes, ports or sensors are not those of the plant that runs.

    Args:
        plant: to go on with.
        old: that runs.

    Raises:
        InputError: the first part that differs.
    """
    pairs = {
        "structure": (plant.structure, old.structure),
        "excitation": (plant.excitation, old.excitation),
        "sensors": (plant.sensors, old.sensors),
        "point laws": tuple([(law.port, law.force, law.rate) for law in p.laws] for p in (plant, old)),
        "sleeves": tuple([(c.sleeve, c.position) for c in p.contacts] for p in (plant, old)),
    }
    for name, (new, running) in pairs.items():
        if new != running:
            raise InputError(f"a plant with other {name}", STAYS, MEND)


def check_rest(forces: FloatArray, old: FloatArray, allowed: float) -> None:
    """Refuse a plant that rests otherwise.

    Args:
        forces: (n_ports,) at rest, N.
        old: (n_ports,) of the plant that runs, N.
        allowed: difference, N.

    Raises:
        InputError: the forces differ.
    """
    apart = float(np.abs(forces - old).max(initial=0.0))
    if apart > allowed:
        raise InputError(f"a plant whose forces at rest differ by {apart:.3g} N", STAYS, MEND)


def check_steps(needed: int, taken: int) -> None:
    """Refuse a contact that is too stiff for the steps of the running model.

    Args:
        needed: steps per sample for the new contacts.
        taken: steps per sample that were chosen for the old ones.

    Raises:
        InputError: more are needed.
    """
    if needed > taken:
        raise InputError(
            f"a plant whose contacts need {needed} steps per sample",
            f"the running model takes {taken}",
            f"start it with steps = {needed}",
        )


def damped(contact: Contact, damping: float) -> Contact:
    """The contact with another constant damping, its elastic part as it is.

    Args:
        contact: of a sleeve.
        damping: N s/m.

    Raises:
        InputError: no damping, or a law whose damping is not one number in N s/m.
    """
    if not (isfinite(damping) and damping >= 0.0):
        raise InputError(
            f"{contact.sleeve}: damping = {damping:g} N s/m", "a damping is 0 or more", "give the law a passive damping"
        )
    law = type(contact.law).from_sleeve(contact.law.stiffness, damping)
    for p in PROBES:
        if not (isclose(law.elastic(p), contact.law.elastic(p)) and isclose(law.damping_at(p, 1.0), damping)):
            raise InputError(
                f"{contact.sleeve}: law = {law.name!r}",
                "a damping in N s/m is set where the law's force is an elastic one and this number times the rate",
                "change the law's own numbers with LiveModel.changed",
            )
    return replace(contact, law=law)
