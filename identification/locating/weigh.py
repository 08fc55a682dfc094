"""How well a force at one place, free in time, explains what is left of all channels and records.

A force at one place is one complex number a line, out of as many as there are channels; the toleranced numbers of the
rig, shared by all records, and each record's free decays are fitted with it. Two figures are formed: what is left when
the force is free at every line, which is compared with the noise after the freedom it took is discounted; and the
evidence, in which the force has a density that the lines themselves choose in bands, so that nothing is gained by
freedom alone.

Source: D. J. C. MacKay, Neural Computation 4 (1992) 415 (evidence and the density chosen by it); for the least squares
with common factors eliminated G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from identification.force_estimate import BANDS
from identification.locating.lines import Lines
from identification.parallel import in_threads
from models.arrays import ComplexArray, FloatArray

DENSITIES = np.geomspace(1e-2, 1e8, 21)
"""Power of a force in a band over its variance, all as probable beforehand, together as probable as no force there."""

RIDGE = 1e-9
"""Share of a decay's own weight that holds its size."""


@dataclass(frozen=True, eq=False)
class Weighed:
    """What each way explains, over all records.

    Attributes:
        nothing: reduced chi-square without any.
        left: (n_ways,) reduced chi-square with each.
        evidence: (n_ways,) natural logarithm of the odds against nothing.
        forces: for each record (lines, n_ways) spectrum of the force (or signal), N, shrunk to what can be told of it.
        told: for each record (lines, n_ways) by how much it was shrunk.
        numbers: (n_ways, n_numbers) the toleranced numbers beside each, in standard deviations from the given ones.
    """

    nothing: float
    left: FloatArray
    evidence: FloatArray
    forces: tuple[ComplexArray, ...]
    told: tuple[FloatArray, ...]
    numbers: FloatArray


def weigh(records: Sequence[Lines], jobs: int = 1) -> Weighed:
    """Weigh every way against nothing.

    Args:
        records: with the same ways and numbers.
        jobs: cores.
    """
    at, parts = records[0].at, in_threads(jobs, _Way, records)
    n_ways = records[0].ways.shape[2]
    bare = _solved([part.normal for part in parts], at)
    nothing = sum(part.chi2(x) for part, x in zip(parts, bare, strict=True))
    common = _solved(in_threads(jobs, _Way.beside, parts, [np.repeat(x, n_ways, axis=0) for x in bare]), at)
    found = in_threads(jobs, _Way.shares, parts, common)
    last = [(part, x, share) for part, x, (_, share) in zip(parts, common, found, strict=True)]
    chi2 = sum(part.chi2(x) for part, x, _ in last)
    taken = sum(np.sum((2.0 - share) * share * np.abs(part.seen(x)) ** 2, axis=0) for part, x, share in last)
    freedom = sum(np.sum((2.0 - share) * share, axis=0) for _, _, share in last)
    n_data = sum(lines.left.size - 0.5 * (lines.common.shape[2] - len(at)) for lines in records)
    numbers, before = at + common[0][:, : len(at)], at + bare[0][:, : len(at)]
    prior = 0.5 * np.sum(numbers**2, axis=1) - 0.5 * np.sum(before**2, axis=1)
    return Weighed(
        nothing=float(np.sum(nothing)) / max(n_data, 1.0),
        left=np.asarray((chi2 - taken) / np.maximum(n_data - freedom, 1.0)),
        evidence=np.asarray(nothing - chi2 + sum(gain for gain, _ in found) - prior),
        forces=tuple(share * part.seen(x) / part.size for part, x, share in last),
        told=tuple(share for _, _, share in last),
        numbers=numbers,
    )


@dataclass(frozen=True, eq=False)
class _Normal:
    """(n_ways, ...) normal equations of the common factors, N x = b."""

    b: FloatArray
    n: FloatArray


class _Way:
    """One record: each way as a direction of unit size a line."""

    def __init__(self, lines: Lines) -> None:
        self.lines = lines
        self.size = np.maximum(np.linalg.norm(lines.ways, axis=1), np.finfo(float).tiny)
        direction = (lines.ways / self.size[:, None, :]).conj().swapaxes(1, 2)
        self.along = (direction @ lines.left[:, :, None])[:, :, 0]
        across = (direction @ lines.common).swapaxes(0, 1)
        self._across = np.concatenate([across.real, across.imag], axis=1)  # (n_ways, twice the lines, n_common)
        self._common, self._left = _flat(lines.common), _flat(lines.left[:, :, None])[:, 0]
        self.normal = _Normal((self._common.T @ self._left)[None], (self._common.T @ self._common)[None])

    def chi2(self, x: FloatArray) -> FloatArray:
        """(n_ways,) what is left of all channels without any way, at (n_ways, n_common) common factors."""
        b, n = self.normal.b[0], self.normal.n[0]
        return np.asarray(self._left @ self._left - 2.0 * x @ b + np.sum((x @ n) * x, axis=1))

    def seen(self, x: FloatArray) -> ComplexArray:
        """(lines, n_ways) what is left along each way."""
        real, imag = np.split((self._across @ x[:, :, None])[:, :, 0].T, 2)
        return np.asarray(self.along - (real + 1j * imag))

    def freed(self, share: FloatArray) -> _Normal:
        """The normal equations with a (lines, n_ways) share of what lies along each way taken out."""
        b, n = [], []
        for along, across, weight in zip(self.along.T, self._across, np.sqrt(share.T), strict=True):
            rows = np.concatenate([weight, weight])[:, None] * across
            b.append(self.normal.b[0] - rows.T @ np.concatenate([weight * along.real, weight * along.imag]))
            n.append(self.normal.n[0] - rows.T @ rows)
        return _Normal(np.array(b), np.array(n))

    def beside(self, x: FloatArray) -> _Normal:
        """The normal equations without what each way takes beside given common factors."""
        _, share = self.shares(x)
        return self.freed(share)

    def shares(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n_ways,) gain of log evidence at common factors, and (lines, n_ways) share of the way that is told."""
        power = np.abs(self.seen(x)) ** 2
        gain, share = np.zeros(power.shape[1]), np.zeros(power.shape)
        edges = np.unique(np.round(np.geomspace(min(4, len(power)), len(power), BANDS + 1)).astype(int))
        for first, last in zip([0, *edges[:-1]], edges, strict=True):
            best, share[first:last] = _weighed_band(power[first:last], self.size[first:last] ** 2)
            gain += best
        return gain, share


def _weighed_band(power: FloatArray, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n_ways,) gain of log evidence in a band, and (lines, n_ways) mean shrinkage of the force there."""
    trials = DENSITIES[:, None, None] * (size / np.mean(size, axis=0))
    raised = 1.0 + trials
    shrinkage = trials / raised
    gains = np.einsum("tlw,lw->tw", shrinkage, power) - _log_of_product(raised) - np.log(len(DENSITIES))
    none = np.zeros((1, gains.shape[1]))
    gain = logsumexp(np.concatenate([none, gains]), axis=0)
    return gain - np.log(2.0), np.einsum("tw,tlw->lw", np.exp(gains - gain), shrinkage)


def _log_of_product(factors: FloatArray) -> FloatArray:
    """(n_trials, n_ways) logarithm of the product over lines: a logarithm of each takes many times as long.

    Args:
        factors: (n_trials, lines, n_ways) from 1 up to the largest density times the lines.
    """
    products = np.multiply.reduceat(factors, np.arange(0, factors.shape[1], MULTIPLIED), axis=1)
    return np.asarray(np.sum(np.log(products), axis=1))


MULTIPLIED = 16
"""Factors whose product is no overflow: of a million lines each is below 1e15."""


def _flat(columns: ComplexArray) -> FloatArray:
    """Real and imaginary parts below each other, all lines and channels."""
    rows = columns.reshape(-1, columns.shape[2])
    return np.concatenate([rows.real, rows.imag])


def _solved(normals: Sequence[_Normal], at: FloatArray) -> list[FloatArray]:
    """For each record (n_ways, n_common) numbers, which all records share, and its own decays."""
    n = len(at)
    reduced = [_reduced(normal, n) for normal in normals]
    b = np.asarray(sum(right for right, _ in reduced)) - 0.5 * at
    matrix = np.asarray(sum(left for _, left in reduced)) + 0.5 * np.eye(n)
    numbers = np.linalg.solve(matrix, b[:, :, None])[:, :, 0]
    return [np.concatenate([numbers, _decays(normal, np.asarray(numbers))], axis=1) for normal in normals]


def _reduced(normal: _Normal, n: int) -> tuple[FloatArray, FloatArray]:
    """(n_ways, n) right sides and (n_ways, n, n) matrices of the first factors, the others eliminated."""
    cross = normal.n[:, n:, :n]
    solved = np.linalg.solve(_held(normal.n[:, n:, n:]), np.concatenate([cross, normal.b[:, n:, None]], axis=2))
    b = normal.b[:, :n] - (cross.swapaxes(1, 2) @ solved[:, :, n:])[:, :, 0]
    return b, normal.n[:, :n, :n] - cross.swapaxes(1, 2) @ solved[:, :, :n]


def _decays(normal: _Normal, numbers: FloatArray) -> FloatArray:
    """(n_ways, n_decays) the decays that go with some numbers."""
    n = numbers.shape[1]
    right = normal.b[:, n:, None] - normal.n[:, n:, :n] @ numbers[:, :, None]
    return np.asarray(np.linalg.solve(_held(normal.n[:, n:, n:]), right)[:, :, 0])


def _held(matrix: FloatArray) -> FloatArray:
    """The matrix with a small share of its diagonal added, where two decays look the same."""
    size = np.diagonal(matrix, axis1=1, axis2=2) + np.finfo(float).tiny
    return matrix + RIDGE * size[:, :, None] * np.eye(matrix.shape[1])
