"""Records of one level and several realisations of the excitation: all nonlinear distortion, on any lines.

The best linear approximation of each realisation scatters about that of all by its noise, which the periods tell, and
by the stochastic nonlinear distortion, which changes with the phases. The scatter beyond the noise is the distortion.

Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), section 4.3.1.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.budget.pooled import Share, members, share
from identification.budget.split import Split
from models.arrays import BoolArray, ComplexArray, FloatArray

SAME_LEVEL = 1.1
"""Ratio of two rms below which two records have one level."""

SAME_PHASES = 0.9
"""Correlation of two excitations' spectra from which on they are one realisation, repeated."""


@dataclass(frozen=True, eq=False)
class Level:
    """Records of one level, place and set of lines taken together.

    Attributes:
        splits: the records.
        frequency: (L,) Hz, lines that all of them excite.
        bla: (n, L) mean of their best linear approximations.
        variance: (n, L) of that mean, by noise and, where it is known, by stochastic distortion.
        distortion: all nonlinear distortion on the excited lines, in the bands of the first record; None where there is
            one realisation alone.
        realisations: how many.
    """

    splits: tuple[Split, ...]
    frequency: FloatArray
    bla: ComplexArray
    variance: FloatArray
    distortion: Share | None
    realisations: int

    @property
    def rms(self) -> float:
        """Mean of the records' levels."""
        return float(np.mean([split.level for split in self.splits]))

    @property
    def scatter_known(self) -> bool:
        """Whether ``variance`` holds the stochastic distortion."""
        return self.distortion is not None or all(bool(s.lines_of("odd")[_inside(s)].any()) for s in self.splits)


def levels_of(splits: Sequence[Split]) -> tuple[Level, ...]:
    """Records sorted by what they excite where, from the lowest level up.

    Args:
        splits: of the records whose excitation repeats.
    """
    groups: list[list[Split]] = []
    for split in sorted(splits, key=lambda s: s.level):
        for group in groups:
            if _alike(group[0], split) and split.level < SAME_LEVEL * group[0].level:
                group.append(split)
                break
        else:
            groups.append([split])
    return tuple(_level(group) for group in groups)


def comparable(one: Split, other: Split) -> bool:
    """Whether two records drive the rig at one place, have the same sensors, and have lines to compare."""
    return (
        one.record.sensors == other.record.sensors
        and one.record.excitation_position == other.record.excitation_position
    )


def _alike(one: Split, other: Split) -> bool:
    same_lines = one.record.fs == other.record.fs and one.periods.samples == other.periods.samples
    if not same_lines or not comparable(one, other) or one.periods.plan != other.periods.plan:
        return False
    both = one.periods.excited & other.periods.excited
    return bool(both.sum() > 0.5 * max(one.periods.excited.sum(), other.periods.excited.sum()))


def _level(group: list[Split]) -> Level:
    first = group[0]
    both = np.all([split.periods.excited for split in group], axis=0)
    blas = np.stack([split.bla[:, both[split.periods.excited]] for split in group])
    noise = np.stack([split.bla_variance[:, both[split.periods.excited]] for split in group])
    frequency, count = first.periods.frequency[both], _realisations(group, both)
    mean = blas.mean(axis=0)
    if count < len(group) or count < 2:
        scatter = np.mean([_odd_on(split)[:, both[split.periods.excited]] for split in group], axis=0)
        return Level(tuple(group), frequency, mean, noise.mean(axis=0) / len(group) + scatter / count, None, count)
    between = np.sum(np.abs(blas - mean) ** 2, axis=0) / (count - 1)
    power = np.mean([np.abs(split.excitation[both]) ** 2 for split in group], axis=0)
    bands = list(members(frequency, first.bands))
    freedom = np.full(len(frequency), float(count * max(1, first.periods.n_blocks - 2)))
    # With more than two realisations the scatter is known better than that of one line, so the test errs to its side.
    found = share(between * power, noise.mean(axis=0) * power, freedom, [(band, band) for band in bands])
    return Level(tuple(group), frequency, mean, np.maximum(between, noise.mean(axis=0)) / count, found, count)


def _realisations(group: list[Split], both: BoolArray) -> int:
    """Records whose phases differ from those of all before them."""
    kept: list[ComplexArray] = []
    for split in group:
        drive = split.excitation[both]
        drive = drive / np.sqrt(np.sum(np.abs(drive) ** 2))
        if all(abs(np.vdot(other, drive)) < SAME_PHASES for other in kept):
            kept.append(drive)
    return len(kept)


def _inside(split: Split) -> BoolArray:
    reached = np.flatnonzero(split.periods.excited)
    lines = np.arange(len(split.periods.excited))
    return np.asarray((lines > reached[0]) & (lines < reached[-1]))


def _odd_on(split: Split) -> FloatArray:
    """(n, L) variance of the best linear approximation by odd distortion, as its detection lines tell it; else 0."""
    frequency, reached = split.periods.frequency, split.periods.excited
    telling = split.lines_of("odd") & _inside(split)
    scatter = np.zeros(split.bla.shape)
    for band in members(frequency, split.bands):
        if (telling & band).any() and (reached & band).any():
            extra = np.mean((split.lines.distortion - split.lines.chance)[:, telling & band], axis=1)
            on = band[reached]
            scatter[:, on] = np.maximum(extra, 0.0)[:, None] / np.abs(split.excitation[reached & band]) ** 2
    return scatter
