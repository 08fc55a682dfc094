"""The updated model: Young's modulus, contact stiffness and damping over time, as the soft taps show them.

Frequencies tell Young's modulus and the contacts' stiffness, damping ratios the dampings of the sleeves that are closed
at rest; both are found in turn, since a strong dashpot moves the frequencies too.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp

import numpy as np
from scipy.optimize import least_squares

from identification.decay.several_sleeves import SleeveDampings, several_dampings
from models.arrays import FloatArray
from models.effects import Effect
from models.effects.protocol import Place
from models.effects.time_varying_damping import TimeVaryingDamping
from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import Plant, build_plant
from models.rig import Rig, RigParameter
from testbed.article.reading import MODES, TappedModes
from testbed.article.rig import BAND, at_rest
from testbed.hidden_effects.truth import Truth

ROUNDS = 6
"""Of stiffness after damping; the frequencies then move by less than 1e-5."""

READ_TO = 1e-3, 0.02
"""Shares to which frequencies and damping ratios are believed, besides their noise: what the model lacks shows too."""


@dataclass(frozen=True, eq=False)
class Updated:
    """What the identifier made of the taps.

    Attributes:
        rig: with stiffnesses that give the identified frequencies.
        dampings: per sleeve closed at rest, its damping over time.
        intervals: (n_taps, n_sleeves, 2) 95 % intervals, N s/m.
    """

    rig: Rig
    dampings: tuple[TimeVaryingDamping, ...]
    intervals: FloatArray

    def plant(self, rig: Rig) -> Plant:
        """The model of another test of the same rig.

        Args:
            rig: as its owner describes it, with the other test's excitation.
        """
        return build_plant(self.rig.model_copy(update={"excitation": rig.excitation}), self.dampings)


def updated(rig: Rig, modes: TappedModes) -> Updated:
    """Update a rig.

    Args:
        rig: as its owner describes it.
        modes: identified from its taps.

    Raises:
        InputError: modes that the rig does not have.
    """
    sleeves, better = closed_at_rest(rig), rig
    stds = np.hypot(modes.ratio_stds, READ_TO[1] * modes.damping_ratios)
    for _ in range(ROUNDS):
        linear = linearised(at_rest(better))
        found = [
            several_dampings(linear, sleeves, *row)
            for row in zip(modes.natural_freqs, modes.damping_ratios, stds, strict=True)
        ]
        values = np.stack([one.values for one in found])
        better = _with_frequencies(rig, dict(zip(sleeves, values.mean(axis=0).tolist(), strict=True)), modes)
    effects = tuple(
        TimeVaryingDamping(
            Place(sleeve=name, position=rig.sleeve(name).position),
            times=tuple(_told_at(found, modes, stds, number).tolist()),
            values=tuple(values[:, number].tolist()),
        )
        for number, name in enumerate(sleeves)
    )
    return Updated(better, effects, np.stack([one.intervals for one in found]))


def _told_at(found: Sequence[SleeveDampings], modes: TappedModes, stds: FloatArray, number: int) -> FloatArray:
    """(n_taps,) s, for which a sleeve's damping speaks: each mode's own time by what it tells of the sleeve."""
    told = (np.stack([one.slopes[:, number] for one in found]) / stds) ** 2
    return np.asarray(np.sum(told * modes.times, axis=1) / np.sum(told, axis=1))


def identified_without_error(truth: Truth, given: Rig, sleeves: Sequence[str]) -> tuple[Rig, tuple[Effect, ...]]:
    """What an identifier without error would find: true stiffnesses, true dampings of small motion.

    Args:
        truth: of the same test.
        given: the rig as its owner describes it, whose other numbers stay.
        sleeves: names of those that are closed at rest.
    """
    linear = linearised(build_modal(truth.plant, BAND))
    effects: list[Effect] = []
    for effect in truth.hidden:
        if isinstance(effect, TimeVaryingDamping) and effect.place.sleeve in sleeves:
            sleeve, at = effect.place.sleeve, effect.place.position
            besides = sum(t.damping for t in linear.tangents if t.port.position == at and t.owner != sleeve)
            effects.append(replace(effect, values=tuple(value + besides for value in effect.values)))
    found = [p for p in truth.built.parameters() if _is_found(p)]
    return given.with_values({p.path: p.value for p in found}), tuple(effects)


def _is_found(parameter: RigParameter) -> bool:
    """Whether frequencies tell it."""
    return parameter.path == "youngs_modulus" or parameter.path.endswith(".stiffness")


def closed_at_rest(rig: Rig) -> tuple[str, ...]:
    """Names of the sleeves in which the rod lies.

    Args:
        rig: of this study.
    """
    model = at_rest(rig)
    pairs = zip(model.plant.contacts, model.rest.penetration.tolist(), strict=True)
    return tuple(contact.sleeve for contact, depth in pairs if depth > 0.0)


def _with_frequencies(rig: Rig, dampings: Mapping[str, float], modes: TappedModes) -> Rig:
    """The rig with Young's modulus and contact stiffnesses that give the identified frequencies, within tolerances."""
    paths = {sleeve.name: f"sleeves[{number}].damping" for number, sleeve in enumerate(rig.sleeves)}
    damped = rig.with_values({paths[name]: value for name, value in dampings.items()})
    free = [p for p in rig.parameters() if _is_found(p)]

    def rig_at(shifted: FloatArray) -> Rig:
        moved = zip(free, shifted.tolist(), strict=True)
        return damped.with_values({p.path: p.value * exp(p.tolerance * (place - 1.0)) for p, place in moved})

    def misses(shifted: FloatArray) -> FloatArray:
        freqs = natural_modes(linearised(at_rest(rig_at(shifted))), (), BAND).natural_freqs[:MODES]
        return np.concatenate([np.log(freqs / modes.mean_freqs) / READ_TO[0], shifted - 1.0])

    # About 1, since the steps of differences are in proportion to the unknowns.
    found = least_squares(misses, np.ones(len(free)), x_scale=1.0, diff_step=[1e-4] * len(free))
    return rig_at(np.asarray(found.x))
