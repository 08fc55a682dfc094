"""The rig at rest and its modes for small motion about rest."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from models.linear import Linearised, NaturalModes, linearised, natural_modes
from models.modal import build_modal
from models.plant import Plant, build_plant
from models.rig import Rig, Sensor

SHAPE_POINTS = 201

LOWEST_LOOKED_UP_TO, HIGHEST_LOOKED_UP_TO = 10.0, 1e4
"""Hz, between which the first mode is looked for where none was asked for."""


@dataclass(frozen=True, eq=False)
class RigModes:
    """What ``testbed modes`` shows.

    Attributes:
        linear: the model at rest.
        modes: at the rig's sensors.
        x: (n,) m from the clamp; None on an oscillator.
        shapes: (n_modes, n) along the beam, the largest 1; on an oscillator those of ``modes``.
    """

    linear: Linearised
    modes: NaturalModes
    x: FloatArray | None
    shapes: ComplexArray


def rig_modes(rig: Rig, highest: float) -> RigModes:
    """State at rest and modes up to a frequency.

    Args:
        rig: with its effects.
        highest: Hz.

    Raises:
        InputError: no equilibrium, or no mode up to that frequency.
    """
    plant = build_plant(rig)
    linear = linearised(build_modal(plant, highest))
    modes = natural_modes(linear, plant.sensors, highest)
    if not len(modes.natural_freqs):
        first = _first_mode(plant, highest)
        raise InputError(
            f"no mode oscillates up to {highest:g} Hz",
            "modes are shown up to the frequency of --up-to",
            "raise it" if first is None else f"raise it: the first mode is at {first:.4g} Hz",
        )
    if not plant.structure.is_beam:
        return RigModes(linear, modes, None, modes.shapes)
    x = np.linspace(0.0, plant.structure.length, SHAPE_POINTS)
    along = [Sensor(name=f"{position:g} m", position=float(position), quantity="displacement") for position in x]
    return RigModes(linear, modes, x, natural_modes(linear, along, highest).shapes)


def _first_mode(plant: Plant, above: float) -> float | None:
    """The lowest natural frequency, Hz, of a rig that has none up to one; None where none is found."""
    highest = max(above, LOWEST_LOOKED_UP_TO)
    while highest < HIGHEST_LOOKED_UP_TO:
        highest *= 4.0
        freqs = natural_modes(linearised(build_modal(plant, highest)), plant.sensors, highest).natural_freqs
        if len(freqs):
            return float(freqs.min())
    return None


def modes_json(found: RigModes) -> dict[str, Any]:
    """The content of ``modes.json``: the sleeves at rest, then the modes with their shapes at the sensors.

    Args:
        found: finished.
    """
    model = found.linear.model
    names = [sensor.name for sensor in model.plant.sensors]
    modes = zip(found.modes.natural_freqs, found.modes.damping_ratios, found.modes.shapes, strict=True)
    return {
        "sleeves": sleeves_at_rest(found),
        "modes": [
            {
                "natural_freq": freq,
                "damping_ratio": ratio,
                "shape": {
                    name: {"real": value.real, "imag": value.imag} for name, value in zip(names, shape, strict=True)
                },
            }
            for freq, ratio, shape in modes
        ],
    }


def sleeves_at_rest(found: RigModes) -> list[dict[str, Any]]:
    """Each sleeve's name and position, whether it touches, its force on the beam (N, positive up) and its gap (m).

    Args:
        found: finished.
    """
    rest, contacts = found.linear.model.rest, found.linear.model.plant.contacts
    rows = zip(contacts, rest.contact_forces, rest.penetration, strict=True)
    return [
        {
            "sleeve": contact.sleeve,
            "position": contact.position,
            "touches": bool(depth > 0),
            "contact_force": float(force),
            "gap": max(0.0, -float(depth)),
        }
        for contact, force, depth in rows
    ]
