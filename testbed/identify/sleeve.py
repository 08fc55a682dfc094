"""The damping of a sleeve over time, from the modes of a decay, and the rig that has it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from identification.decay.course import NORMAL_95
from identification.decay.damping_table import damping_effect
from identification.decay.identify import Decay, Identification
from identification.decay.sleeve_damping import DampingTable, contact_damping
from identification.decay.sleeve_poles import Dashpots
from identification.decay.smoother import SmoothedMode
from models.arrays import BoolArray, FloatArray
from models.effects import entry_of
from models.effects.protocol import Place
from models.effects.time_varying_damping import TimeVaryingDamping
from models.errors import InputError
from models.linear import linearised
from models.modal import build_modal
from models.plant import build_plant
from models.rig import Rig
from models.rig_file import write_rig

TIMES = 120
"""Moments at which the damping is read, evenly over each decay."""

SOME = 0.1
"""Share of the time above which contradicting modes are told."""

ABOVE = 1.2
"""The model is looked at up to this many times the highest identified frequency."""


@dataclass(frozen=True, eq=False)
class SleeveDamping:
    """One sleeve's contact damping over a decay.

    Attributes:
        times: (n,) s from the record's first sample.
        value: (n,) N s/m.
        low: (n,) of the 95 % interval.
        high: (n,) of the 95 % interval.
        effect: the same as a table of few knots.
        most_telling: the mode that tells most of it, Hz.
        contradicted: share of the times at which no damping gives the modes their ratios.
        stretches: begin and end of each part of the record in which it is told without a gap, s.
    """

    times: FloatArray
    value: FloatArray
    low: FloatArray
    high: FloatArray
    effect: TimeVaryingDamping
    most_telling: float
    contradicted: float
    stretches: tuple[tuple[float, float], ...]


def check_sleeve(rig: Rig, sleeve: str) -> None:
    """See that a sleeve touches at rest, before a decay is read.

    Args:
        rig: with the sleeve.
        sleeve: its name.

    Raises:
        InputError: an unknown sleeve or one that is open at rest.
    """
    Dashpots.of(linearised(build_modal(build_plant(rig), 0.0)), (sleeve,))


def sleeve_damping(found: Identification, rig: Rig, sleeve: str) -> SleeveDamping:
    """What a decay's damping ratios say of one sleeve's dashpot, the rest of the rig being as its file says.

    Args:
        found: of the rig's sensors.
        rig: the model, in whose rest state the sleeve touches.
        sleeve: its name.

    Raises:
        InputError: an unknown sleeve or one that is open at rest, or a mode that the rig does not have.
    """
    freqs = np.array([mode.natural_freq for mode in found.decays[0].modes])
    linear = linearised(build_modal(build_plant(rig), ABOVE * float(freqs.max())))
    table = DampingTable.of(linear, sleeve, ABOVE * float(freqs.max()))
    numbers = table.matched(freqs)
    columns = [_decay(decay) for decay in found.decays]
    times, ratios, stds = (np.concatenate(parts) for parts in zip(*columns, strict=True))
    damping = contact_damping(table, numbers, ratios, stds)
    known = np.isfinite(damping.value) & (damping.high > damping.low)
    if not known.any():
        raise InputError(
            f"sleeve {sleeve!r}: the identified modes tell nothing of its damping",
            "a mode tells a sleeve's damping where it moves the beam there",
            "identify another mode, or name another sleeve",
        )
    at = times[known]
    course = damping.value[known], damping.low[known], damping.high[known]
    effect = damping_effect(Place(sleeve=sleeve), at, *course)
    telling = float(freqs[damping.most_telling])
    contradicted = float(np.mean(damping.contradicted[known]))
    return SleeveDamping(at, *course, effect, telling, contradicted, stretches_of(times, known))


def stretches_of(times: FloatArray, known: BoolArray) -> tuple[tuple[float, float], ...]:
    """Begin and end of each stretch that is known from one moment to the next, s; none reaches into another decay.

    Args:
        times: (n_decays * TIMES,) s, of one decay after the other.
        known: (n_decays * TIMES,).
    """
    told = np.flatnonzero(known)
    gaps = np.flatnonzero((np.diff(told) > 1) | (np.diff(told // TIMES) > 0))
    begins, ends = told[np.append(0, gaps + 1)], told[np.append(gaps, len(told) - 1)]
    return tuple(zip(times[begins].tolist(), times[ends].tolist(), strict=True))


def _decay(decay: Decay) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(n,) s from the record's first sample, and (n, n_modes) ratios and standard deviations in one decay."""
    end = max(float(mode.smoothed.decay.times[-1]) for mode in decay.modes)
    times = np.linspace(0.0, end, TIMES)
    read = [_ratio_and_std(mode.smoothed, times) for mode in decay.modes]
    ratios, stds = (np.stack(columns, axis=1) for columns in zip(*read, strict=True))
    return times + decay.start, ratios, stds


def _ratio_and_std(mode: SmoothedMode, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n,) damping ratio and its standard deviation, nan after the mode has drowned."""
    course = mode.damping_ratio
    seen = times <= course.times[-1]
    ratio = np.where(seen, course.at(times), np.nan)
    spread = np.interp(times, course.times, course.high - course.low) / (2.0 * NORMAL_95)
    return ratio, np.where(seen, spread, np.nan)


def sleeve_findings(damping: SleeveDamping, found: Identification, sleeve: str) -> list[str]:
    """What the damping of a sleeve comes to, and what speaks against taking it for one of time, in words.

    Args:
        damping: of the sleeve.
        found: where it comes from.
        sleeve: its name.
    """
    mean, half = float(np.mean(damping.value)), float(np.mean(damping.high - damping.low)) / 2.0
    sentences = [
        f"{sleeve}: {mean:.4g} +- {half:.2g} N s/m (95 %) in the mean, told best by {damping.most_telling:.4g} Hz"
    ]
    if damping.contradicted > SOME:
        sentences.append(
            f"{sleeve}: the modes contradict each other {damping.contradicted:.0%} of the time; something else in the "
            "rig is not as its file says"
        )
    if any(cause.verdict == "amplitude" for cause in found.damping_causes):
        sentences.append(f"{sleeve}: damping depends on amplitude; a table over time holds for this record alone")
    return sentences


def write_updated(path: Path, rig: Rig, damping: SleeveDamping, updated: Path) -> None:
    """The owner's rig file with the damping as its effect, in place of one that it had there.

    Args:
        path: the owner's file, whose comments are kept.
        rig: what it says.
        damping: of a sleeve.
        updated: file to write.
    """
    entry = entry_of(damping.effect)
    others = tuple(e for e in rig.effects if (e.kind, e.sleeve) != (entry.kind, entry.sleeve))
    write_rig(rig.model_copy(update={"effects": (*others, entry)}), updated, like=path)
