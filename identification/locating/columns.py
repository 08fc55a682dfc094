"""Functions of the motion that a force is laid on, and what they predict of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

from identification.locating.located import PlacedForce
from models.arrays import FloatArray

FOLDS = 6
"""Blocks of time of each record, of which one after the other is kept aside."""

RIDGE = 1e-6
"""Share of a function's own weight that holds it where no sample fell."""

TOLD = 0.9
"""Share of a line's force that is told, from which the line is read."""


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of one record, and the force in the lines in which it is told.

    Attributes:
        signals: (N,) displacement from the middle, velocity and acceleration, SI, by name.
        gain: (N // 2 + 1,) what is told of a force at each line.
        force: (N,) N.
        rms: of the force, N.
        n: samples.
    """

    signals: Mapping[str, FloatArray]
    gain: FloatArray
    force: FloatArray
    rms: float
    n: int

    @classmethod
    def of(cls, force: PlacedForce, middle: float) -> "Motion":
        """The motion of a force.

        Args:
            force: of one record.
            middle: of the place, m.
        """
        n = len(force.force)
        gain = np.zeros(n // 2 + 1)
        gain[: len(force.told)] = np.where(force.told > TOLD, force.told, 0.0)
        gain[0] = 0.0
        heard = fft.irfft(fft.rfft(force.force) * (gain > 0.0), n)
        signals = {
            "displacement": force.q - middle,
            "velocity": force.v,
            "acceleration": np.gradient(force.v) * force.fs,
        }
        return cls(signals, gain, np.asarray(heard), float(heard.std()), n)

    def told(self, columns: FloatArray) -> FloatArray:
        """(N, n) what of some columns would be told, were they the force.

        Args:
            columns: (N, n).
        """
        return np.asarray(fft.irfft(fft.rfft(columns, axis=0) * self.gain[:, None], self.n, axis=0))


@dataclass(frozen=True, eq=False)
class Columns:
    """Functions of the motion that the force is laid on, one array a record.

    Attributes:
        raw: (N, n) each.
        told: (N, n) each, in the band of the force, over its rms in the record.
        target: (N,) each, the force over its rms.
        records: whose they are.
    """

    raw: list[FloatArray]
    told: list[FloatArray]
    target: list[FloatArray]
    records: Sequence[Motion]

    @classmethod
    def of(cls, records: Sequence[Motion], raw: list[FloatArray]) -> "Columns":
        """With the force of some records.

        Args:
            records: of the force.
            raw: (N, n) functions.
        """
        told = [record.told(columns) / record.rms for record, columns in zip(records, raw, strict=True)]
        return cls(raw, told, [record.force / record.rms for record in records], records)

    def laid(self, raw: list[FloatArray]) -> "Columns":
        """Other functions, for the same target.

        Args:
            raw: (N, n) functions.
        """
        return replace(Columns.of(self.records, raw), target=self.target)

    def times(self, factors: Sequence[FloatArray]) -> "Columns":
        """The functions times some of time, (N, 1) each."""
        return Columns.of(self.records, [x * f for x, f in zip(self.raw, factors, strict=True)])

    @property
    def weights(self) -> FloatArray:
        """(n,) by all samples."""
        pairs = list(zip(self.told, self.target, strict=True))
        return _solved(np.asarray(sum(x.T @ x for x, _ in pairs)), np.asarray(sum(x.T @ y for x, y in pairs)))


def predicted(columns: Columns) -> float:
    """Share of the force's power that functions predict in blocks of time kept aside.

    Args:
        columns: the functions.
    """
    pieces = [
        list(zip(np.array_split(x, FOLDS), np.array_split(y, FOLDS), strict=True))
        for x, y in zip(columns.told, columns.target, strict=True)
    ]
    normal = [sum(record[k][0].T @ record[k][0] for record in pieces) for k in range(FOLDS)]
    right = [sum(record[k][0].T @ record[k][1] for record in pieces) for k in range(FOLDS)]
    power = [sum(float(record[k][1] @ record[k][1]) for record in pieces) for k in range(FOLDS)]
    whole, along, error = np.asarray(sum(normal)), np.asarray(sum(right)), 0.0
    for k in range(FOLDS):
        weights = _solved(whole - normal[k], along - right[k])
        error += power[k] - 2.0 * float(weights @ right[k]) + float(weights @ normal[k] @ weights)
    return max(0.0, 1.0 - error / sum(power))


def _solved(normal: FloatArray, right: FloatArray) -> FloatArray:
    size = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
    scaled = normal / np.outer(size, size) + RIDGE * np.eye(len(normal))
    return np.asarray(np.linalg.solve(scaled, right / size) / size)
