"""A random rig and the forces of its tests, chosen so that the sleeves are hit and the motion is as hard as asked."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.errors import DivergenceError
from models.rig import Beam, Rig
from testbed.hidden_effects.motion import amplification, channels_of, growth, impacts, watched
from testbed.hidden_effects.rigs import draw_rig
from testbed.hidden_effects.sets import CaseSet, Tests, one_of
from testbed.hidden_effects.waves import draw_blows
from testbed.virtual.as_built import perturbed

FEWEST_IMPACTS, MOST_IMPACTS = 4.0, 150.0
"""Contacts made at all sleeves in a second of the higher level."""

FEWEST_OF_BLOW = 3
"""Contacts after the hammer's blow."""

MOST_GROWTH, MOST_GROWTH_OF_CHAOTIC = 300.0, 1e4
"""Of a relative change of Young's modulus in the channels: a linear resonance gives about 30, a chaotic record
thousands; the second bound is that of the cases that are to be hard."""

MOST_AMPLIFICATION, MOST_AMPLIFICATION_OF_CHAOTIC = 5.0, 30.0
"""The same of a relative change of the force by noise: 1 or 2 where the sleeves hardly matter; at 140 all is lost."""

HIGHEST = 0.3
"""Upper end of the excited band at most, as a share of the rate."""

MOST_DEFLECTION = 0.005
"""Of the free end over the length: a beam that bends further is not linear by itself, as chains and cables show."""

LEVELS, TRIED = np.geomspace(0.5, 60.0, 8), 5
"""Rms of the force, N, and how many of them are tried on a rig."""

LEARNT, HELD = ("low", "high", "decay"), "holdout"


@dataclass(frozen=True, eq=False)
class Trial:
    """A rig as its owner describes it and the forces of its tests.

    Attributes:
        rig: the description.
        built: the rig as built, its toleranced numbers a little off.
        fs: of the records, Hz.
        forces: (N,) N of each record by name: two levels and a blow to learn from, a level between them held out.
        telling: first seconds of the forces by which the rig is looked at.
        growth: of a small change of Young's modulus, the largest of these records.
        amplification: of the force's noise, the largest of these records.
    """

    rig: Rig
    built: Rig
    fs: float
    forces: dict[str, FloatArray]
    telling: float
    growth: float
    amplification: float

    def first_seconds(self, name: str) -> FloatArray:
        """The part of a force that is looked at, N.

        Args:
            name: of the record.
        """
        return self.forces[name][: round(self.telling * self.fs)]

    @property
    def chaotic(self) -> bool:
        """Whether neighbouring motions part."""
        return self.growth > MOST_GROWTH or self.amplification > MOST_AMPLIFICATION


def draw_trial(case_set: CaseSet, *, chaotic: bool, rng: np.random.Generator) -> Trial:
    """The next random rig whose sleeves are hit.

    Args:
        case_set: what it may be like.
        chaotic: whether neighbouring motions are to part.
        rng: draws it.
    """
    while True:
        rig, fs = draw_rig(case_set, rng), float(rng.choice(case_set.rates))
        tests = one_of(case_set.tests, rng)
        built = perturbed(rig, rng)
        try:
            forces = draw_forces(built, fs, case_set, tests, rng)
            if forces is None or deflection(built, forces.values(), fs) > MOST_DEFLECTION:
                continue
            grown = max(growth(built, force, fs) for force in forces.values())
            amplified = max(amplification(built, force, fs, rng) for force in forces.values())
        except DivergenceError:
            continue
        trial = Trial(rig, built, fs, forces, tests.learnt.telling, grown, amplified)
        within = grown <= MOST_GROWTH_OF_CHAOTIC and amplified <= MOST_AMPLIFICATION_OF_CHAOTIC
        if within and trial.chaotic == chaotic:
            return trial


def draw_forces(
    rig: Rig, fs: float, case_set: CaseSet, tests: Tests, rng: np.random.Generator
) -> dict[str, FloatArray] | None:
    """(N,) N of each record by name, or None where no level hits the sleeves often enough.

    Args:
        rig: to be driven.
        fs: Hz.
        case_set: at which levels it is driven.
        tests: by what.
        rng: draws waves and levels.
    """
    top = min(case_set.top.draw(rng, case_set.shape), HIGHEST * fs)
    wave, blow = tests.learnt.draw(fs, top, rng), draw_blows(fs, case_set.blow_width.draw(rng), tests.blows)
    high = find_level(rig, wave, fs, rng)
    if high is None:
        return None
    low = high * case_set.low_share.draw(rng, case_set.shape)
    between = float(rng.uniform(low, high))
    blow = blow * high * case_set.crest.draw(rng, case_set.shape)
    if impacts(rig, blow, fs) < FEWEST_OF_BLOW:
        return None
    other = tests.learnt.draw(fs, top, rng)
    held = tests.held.draw(fs, top, rng)
    return {"low": low * other, "high": high * wave, "decay": blow, HELD: between * held}


def deflection(rig: Rig, forces: Iterable[FloatArray], fs: float) -> float:
    """Largest motion of the free end from rest, over the length.

    Args:
        rig: a beam.
        forces: (N,) N, of each record.
        fs: Hz.
    """
    assert isinstance(rig.structure, Beam)
    length = rig.structure.length
    end = watched(rig, length)
    return max(float(np.abs(channels_of(end, force, fs)[0]).max()) for force in forces) / length


def find_level(rig: Rig, wave: FloatArray, fs: float, rng: np.random.Generator) -> float | None:
    """An rms of the force, N, at which the sleeves are hit often, if there is one.

    Args:
        rig: to be driven.
        wave: (N,) of rms 1.
        fs: Hz.
        rng: draws the order in which levels are tried.
    """
    seconds = len(wave) / fs
    for level in rng.permutation(LEVELS)[:TRIED]:
        if FEWEST_IMPACTS * seconds <= impacts(rig, level * wave, fs) <= MOST_IMPACTS * seconds:
            return float(level)
    return None
