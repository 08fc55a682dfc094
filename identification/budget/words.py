"""The budget in an engineer's words: each sentence rests on a test at the stated false-alarm rate.

Source: the reading for users follows P. Z. Csurcsia, B. Peeters, J. Schoukens, MSSP 145 (2020) 106926.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from identification.budget.modes import LevelChange
from identification.budget.pooled import FALSE_ALARM, Share, excess
from identification.budget.realisations import Level
from identification.budget.split import Cause, Split
from identification.budget.unsplit import Unsplit
from models.arrays import FloatArray

if TYPE_CHECKING:
    from identification.budget.budget import Budget

NEXT_TEST = (
    "a random-phase multisine of odd lines with one left out at random in each group of four, one or two periods to "
    "settle and at least five more, at two levels, with two realisations each"
)

CAUSES: dict[Cause, str] = {
    "even": "even distortion: an asymmetric law (a gap off centre or closed by gravity, a breathing crack)",
    "odd": "odd distortion: a symmetric law (a gap passed on both sides, friction, a hardening or softening spring)",
    "odd_or_even": "nonlinear distortion, odd or even (lines of both kinds are excited)",
}


def findings_of(budget: "Budget") -> tuple[str, ...]:
    """Sentences, record by record, then over the levels, then what another test would tell."""
    found: list[str] = []
    for split in budget.splits:
        found += _of_split(split, budget.excitation_unit)
    for level in budget.levels:
        found += _of_level(level, budget.excitation_unit)
    found += _of_noise(budget.levels, budget.excitation_unit)
    for change in budget.changes:
        found += _of_change(change, budget.excitation_unit)
    found += [_of_other(other) for other in budget.others]
    untold = _untold(budget)
    if untold:
        found.append(f"{'; '.join(untold)}; this would tell: {NEXT_TEST}")
    return tuple(found)


def _of_split(split: Split, unit: str) -> Iterator[str]:
    name = f"{split.record.name} (rms {split.level:.3g}{_unit(unit)}, {split.n_periods} periods)"
    noise = 10.0 * np.log10(np.sum(split.noise, axis=1) / np.maximum(split.mean_square, np.finfo(float).tiny))
    worst = int(np.argmax(noise))
    yield (
        f"{name}: what does not repeat is {-noise.max():.0f} dB below the response at worst, at "
        f"{split.record.sensors[worst]}"
        + (", and holds the transient, which two periods do not tell apart" if split.n_periods == 2 else "")
    )
    distortions: tuple[Cause, ...] = ("even", "odd", "odd_or_even")
    found = [cause for cause in distortions if split.shares[cause].found.any()]
    for cause in found:
        yield f"{name}: {_strongest(split, split.shares[cause])}: {CAUSES[cause]}"
    if not found and split.told.any():
        tested = [c for c in distortions if not np.isnan(split.shares[c].power).all()]
        kinds = "no nonlinear" if "odd_or_even" in tested else "neither odd nor even" if len(tested) > 1 else "no even"
        yield (
            f"{name}: {kinds} distortion above the noise on the lines that tell it "
            f"(tested at {FALSE_ALARM:.0%}): what a model misses there is linear or noise"
        )
    if split.shares["time_variation"].found.any() and split.drift is not None:
        gain, phase, std = split.drift.gain, split.drift.phase, split.drift.std
        n = int(np.argmax(np.hypot(gain, phase) / std))
        yield (
            f"{name}: the response changes with time, most clearly at {split.record.sensors[n]}: gain by "
            f"{gain[n]:+.2%} and phase by {np.degrees(phase[n]):+.2g} degrees from the first period used to the last "
            f"(+- {std[n]:.1%}), on all lines together"
        )
    if split.shares["transient"].found.any():
        share = 10.0 * np.log10(split.shares["transient"].total / split.mean_square + np.finfo(float).tiny)
        yield (
            f"{name}: a transient is left in the periods used, {-share.max():.0f} dB below the response at "
            f"{split.record.sensors[int(np.argmax(share))]}; it was taken out"
        )


def _strongest(split: Split, share: Share) -> str:
    """Where a distortion is largest beside the response, and how large: ``P3, 80-120 Hz: 22 dB above ...``."""
    # Above the excited range there is no response to compare with but that of the whole band.
    response = np.where(split.response > 0.0, split.response, split.mean_square[:, None])
    size = np.where(share.found, share.power / np.maximum(response, np.finfo(float).tiny), -1.0)
    sensor, band = np.unravel_index(int(np.argmax(size)), size.shape)
    low, high = list(pairwise(split.bands))[band]
    where = [name for name, row in zip(split.record.sensors, share.found, strict=True) if row.any()]
    others = "" if len(where) == 1 else f" (found at {', '.join(where)})"
    against = "the response there" if split.response[sensor, band] > 0.0 else "the whole response"
    return (
        f"{split.record.sensors[sensor]}, {low:.0f}-{high:.0f} Hz: "
        f"{_db(share.above_chance[sensor, band])} dB above what noise leaves and "
        f"{_beside(size[sensor, band])} {against}{others}"
    )


def _beside(ratio: float) -> str:
    decibels = 10.0 * np.log10(max(ratio, 1e-30))
    return f"{abs(decibels):.0f} dB {'below' if decibels < 0 else 'above'}"


def _db(ratio: float) -> str:
    return f"{10.0 * np.log10(max(ratio, 1e-30)):.0f}"


def _of_level(level: Level, unit: str) -> Iterator[str]:
    if level.distortion is None:
        return
    name = f"{level.realisations} realisations at rms {level.rms:.3g}{_unit(unit)}"
    if level.distortion.found.any():
        first = level.splits[0]
        yield f"{name}: {_strongest(first, level.distortion)}: nonlinear distortion, odd and even together"
    else:
        yield f"{name}: the best linear approximation is the same within the noise: no stochastic distortion"


def _of_noise(levels: tuple[Level, ...], unit: str) -> Iterator[str]:
    """Whether what does not repeat grows faster with the level than the response does."""
    for low, high in pairwise(levels):
        one, other = low.splits[0], high.splits[0]
        if one.record.sensors != other.record.sensors:
            continue
        # The logarithm of a variance with n complex degrees of freedom scatters by 1 / sqrt(n).
        freedom = [_free_lines(split) for split in (one, other)]
        if min(f.min() for f in freedom) < 1.0:
            continue
        std = np.sqrt(1.0 / freedom[0] + 1.0 / freedom[1])
        shares = [np.maximum(s.noise.sum(axis=1) / s.mean_square, np.finfo(float).tiny) for s in (one, other)]
        rise = np.log(shares[1] / shares[0])
        n = int(np.argmax(rise / std))
        if rise[n] > norm.isf(FALSE_ALARM / len(rise)) * std[n]:
            yield (
                f"from rms {low.rms:.3g} to {high.rms:.3g}{_unit(unit)} what does not repeat rises by "
                f"{10.0 / np.log(10.0) * rise[n]:.1f} dB more than the response, most clearly at "
                f"{one.record.sensors[n]}: motion that has no period (impacts that differ from period to period), "
                "which no model follows for long"
            )


def _free_lines(split: Split) -> FloatArray:
    """(n,) complex degrees of freedom of the noise's sum over lines of unequal noise (Satterthwaite)."""
    noise, n_blocks = split.lines.noise, split.periods.n_blocks
    squares = np.maximum(np.sum(noise**2, axis=1), np.finfo(float).tiny)
    return np.asarray(noise.sum(axis=1) ** 2 / squares * max(0, n_blocks - 2))


def _of_change(change: LevelChange, unit: str) -> Iterator[str]:
    name = f"from rms {change.low.rms:.3g} to {change.high.rms:.3g}{_unit(unit)}"
    n_blocks = min(s.periods.n_blocks for level in (change.low, change.high) for s in level.splits)
    freedom = np.full(len(change.frequency), float(max(1, n_blocks - 2)))
    ratio, p = excess(np.abs(change.change) ** 2, change.variance, freedom)
    sensors = change.low.splits[0].record.sensors
    if p.min() >= FALSE_ALARM / len(p):
        doubt = np.sqrt(change.variance.sum(axis=1) / np.sum(np.abs(change.low.bla) ** 2, axis=1))
        yield (
            f"{name}: the best linear approximation stays the same within its uncertainty, {doubt.min():.2g} of itself "
            f"at best, at {sensors[int(np.argmin(doubt))]}"
        )
        return
    n = int(np.argmax(np.where(p < FALSE_ALARM / len(p), ratio, 0.0)))
    beside = np.sum(np.abs(change.change[n]) ** 2) / np.sum(np.abs(change.low.bla[n]) ** 2)
    kind = "" if change.scatter_known else " (one realisation of all lines: in part it may be stochastic distortion)"
    yield (
        f"{name}: the best linear approximation changes, most clearly at {sensors[n]}, by {np.sqrt(beside):.1%} of "
        f"itself: nonlinear{kind}"
    )
    limit = norm.isf(0.5 * FALSE_ALARM / max(1, 2 * len(change.modes)))
    for low, high in change.modes:
        shift, spread = high.natural_freq - low.natural_freq, np.hypot(high.natural_freq_std, low.natural_freq_std)
        loss, doubt = high.damping_ratio - low.damping_ratio, np.hypot(high.damping_ratio_std, low.damping_ratio_std)
        words = []
        if abs(shift) > limit * spread:
            how = "stiffens" if shift > 0 else "softens"
            change_of_freq = f"{low.natural_freq:.4g} to {high.natural_freq:.4g} Hz ({shift / low.natural_freq:+.2%})"
            words.append(f"{how}, {change_of_freq}")
        if abs(loss) > limit * doubt:
            words.append(f"its damping ratio goes from {low.damping_ratio:.2%} to {high.damping_ratio:.2%}")
        if words:
            yield f"{name}: the mode at {low.natural_freq:.4g} Hz: {'; '.join(words)}"


def _of_other(other: Unsplit) -> str:
    if other.noise is None or other.mean_square is None:
        return f"{other.name}: {other.reason}: nothing can be told apart"
    worst = int(np.argmax(other.noise / other.mean_square))
    below = 10.0 * np.log10(other.mean_square[worst] / max(float(other.noise[worst]), 1e-300))
    return (
        f"{other.name}: {other.reason}: noise can be told ({below:.0f} dB below the response at worst, at "
        f"{other.sensors[worst]}, from {other.method}), but neither odd nor even distortion nor time variation"
    )


def _untold(budget: "Budget") -> list[str]:
    """What none of the records tells."""
    untold = []
    if not any(s.periods.plan != "mixed" for s in budget.splits):
        untold.append("odd and even distortion cannot be told apart from these records")
    elif not any(s.lines_of("odd")[s.periods.excited.argmax() :][: _reach(s)].any() for s in budget.splits):
        untold.append("odd distortion within the excited range cannot be told: no odd line is left out there")
    if all(s.drift is None for s in budget.splits):
        untold.append("time variation cannot be told: that takes five periods or more, the last of which is not used")
    if len({round(level.rms, 9) for level in budget.levels}) < 2:
        untold.append("a change with level cannot be told from one level")
    return untold


def _reach(split: Split) -> int:
    lines = np.flatnonzero(split.periods.excited)
    return int(lines[-1] - lines[0] + 1)


def _unit(unit: str) -> str:
    return f" {unit}" if unit else ""
