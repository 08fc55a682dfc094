"""A calibrated fit taken apart: what each record's low and high band, early and late part says of the unknowns.

The information A = J J' and the score J r of a part add up over parts, so any way of giving a number a value of its own
in some of them is a matter of small matrices. Data are counted as often as they speak: a line whose noise the force
brings to all channels counts for one channel, and all data of a band for what the model leaves there.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import fft

from identification.consistency.modes import frequency_of
from identification.evaluate import Evaluator, Target, TimeTarget
from identification.fit import Fit
from identification.rest_target import FrfTarget
from models.arrays import BoolArray, FloatArray

NOISE_DOUBT = 1.15
"""Residual over noise up to which there may be no misfit: the noise itself is known to about a tenth."""


@dataclass(frozen=True, eq=False)
class Cell:
    """A part of one record.

    Attributes:
        record: index of the evaluator's target.
        part: 0 for the low band or the early part, 1 for the other.
        information: (p, p) of the unknowns, in their own coordinates.
        score: (p,) slope of half the chi-square.
    """

    record: int
    part: int
    information: FloatArray
    score: FloatArray


@dataclass(frozen=True, eq=False)
class Weighted:
    """One record of a fit, its data weighted so that no sum of them varies more than if all were apart.

    Attributes:
        target: the record.
        rows: (p, n_data) of the Jacobian.
        rest: (n_data,) residual.
        plain: (n_data,) residual in units of the noise.
        shared: (n_data,) the part of the weight that is for noise in common.
        is_high: (n_data,) lines above the edge between low and high modes.
    """

    target: Target
    rows: FloatArray
    rest: FloatArray
    plain: FloatArray
    shared: FloatArray
    is_high: BoolArray

    @cached_property
    def bands(self) -> list[FloatArray]:
        """(p, n_data) rows of the lines below the edge, and of those above it where there are any."""
        if not self.is_high.any():
            return [self.rows]
        return [np.where(self.is_high, 0.0, self.rows), np.where(self.is_high, self.rows, 0.0)]

    @cached_property
    def times(self) -> list[FloatArray]:
        """(p, n_data) rows before and after half of the record's energy has passed; whole for what is at rest.

        The residual in units of the noise has a flat spectrum, so its inverse transform is a series without memory, but
        for the edge of the band. A slope cut off in time and seen through the band again is a row like all others.
        """
        if not isinstance(self.target, TimeTarget):
            return [self.rows]
        late = np.stack([_after(row, self.target) for row in self.rows])
        return [self.rows - late, late]

    @cached_property
    def missed(self) -> float:
        """Weighted chi-square beyond the noise and the doubt about it."""
        total = 0.0
        for mask in (self.is_high, ~self.is_high):
            ratio = float(np.sqrt(np.mean(self.plain[mask] ** 2))) if mask.any() else 0.0
            if ratio > NOISE_DOUBT:
                total += float(self.rest[mask] @ self.rest[mask]) * (1.0 - (NOISE_DOUBT / ratio) ** 2)
        return total

    def by_line(self, values: FloatArray) -> FloatArray:
        """(n_lines,) sums of what belongs to one line, whose channels may share their noise.

        Args:
            values: (n_data,).
        """
        if not isinstance(self.target, TimeTarget | FrfTarget):
            return values
        n_channels = len(self.target.record.sensors)
        return np.asarray(values.reshape(n_channels, -1, 2).sum(axis=(0, 2)))


def weighted(evaluator: Evaluator, found: Fit, edge: float | None) -> list[Weighted]:
    """The records of a fit, each with its data weighted.

    Args:
        evaluator: records that were fitted.
        found: the fit, at its minimum.
        edge: Hz between low and high modes, below and above which residuals are weighed apart; None without.
    """
    ends = np.cumsum([0, *(target.n_data for target in evaluator.targets)]).tolist()
    parts = []
    for target, start, end in zip(evaluator.targets, ends[:-1], ends[1:], strict=True):
        residual = found.residual[start:end]
        is_high = np.zeros(target.n_data, dtype=bool)
        if edge is not None and isinstance(target, TimeTarget | FrfTarget):
            is_high = frequency_of(target) > edge
        shared = _for_noise_in_common(target)
        weight = shared.copy()
        for mask in (is_high, ~is_high):
            if mask.any():
                weight[mask] /= max(1.0, float(np.sqrt(np.mean(residual[mask] ** 2))))
        rows = found.jacobian[:, start:end] * weight
        parts.append(Weighted(target, rows, residual * weight, residual, shared, is_high))
    return parts


def cells_of(data: Sequence[Weighted], *, in_time: bool) -> Iterator[Cell]:
    """All parts of all records, record by record.

    Args:
        data: the records.
        in_time: early and late, instead of low and high.
    """
    for index, record in enumerate(data):
        for part, rows in enumerate(record.times if in_time else record.bands):
            yield Cell(index, part, rows @ rows.T, rows @ record.rest)


def _for_noise_in_common(target: Target) -> FloatArray:
    """(n_data,) weight of each datum by how many times its line's sums over channels may count the same noise.

    The largest eigenvalue of a line's correlation between channels, diag(own) + h h' with |h|^2 = 1 - own, is at most
    max(own) + sum(1 - own).
    """
    if not isinstance(target, TimeTarget):
        return np.ones(target.n_data)
    own = np.minimum(target.with_noise(target.noise).density / target.density, 1.0)
    repeats = own.max(axis=0) + (1.0 - own).sum(axis=0)
    return np.tile(np.repeat(repeats**-0.5, 2), len(own))


def _after(row: FloatArray, target: TimeTarget) -> FloatArray:
    """(n_data,) the lines of what a row is in time after half of the record's energy has passed."""
    n, shape = target.record.n_samples, target.measured.shape
    series = fft.irfft(np.ascontiguousarray(row).view(complex).reshape(shape), n, axis=1)
    series[:, : _half_of_energy(target)] = 0.0
    return np.ascontiguousarray(fft.rfft(series, axis=1)[:, : shape[1]]).view(float).ravel()


def _half_of_energy(target: TimeTarget) -> int:
    """The sample at which half of what the record tells has passed: a decay tells most at its start."""
    lines = target.measured / np.sqrt(target.density)
    power = np.sum(fft.irfft(lines, target.record.n_samples, axis=1) ** 2, axis=0)
    return int(np.clip(np.searchsorted(np.cumsum(power), 0.5 * power.sum()), 1, target.record.n_samples - 1))
