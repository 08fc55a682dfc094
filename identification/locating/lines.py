"""The force balance of a record line by line, in units of its noise: what is left, and what could explain it.

The noise is the channels' own and what the laws' forces are uncertain by, because the motion at their places is known
from noisy channels only: draws of that motion say how much, and a force at a law's place is then that much less sure.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from identification.evaluate import scored_spectrum
from identification.locating.beside import BesideRun
from identification.locating.tolerances import tolerances_of
from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError

DRAWS = 3
"""Of the motion at the laws' places."""

SMOOTHED = 33
"""Lines over which the power of their forces' error is averaged."""


@dataclass(frozen=True, eq=False)
class Lines:
    """One record, every channel of every line in standard deviations of the noise: E |noise|^2 = 1.

    Attributes:
        left: (lines, n_channels) what the laws leave at the motion that the channels tell.
        ways: (lines, n_channels, n_ways) what a unit force at each place, or signal on each channel, adds.
        common: (lines, n_channels, n_common) what the toleranced numbers add, then free decays, all real factors.
        at: (n_numbers,) where the numbers are, in standard deviations from the given ones.
    """

    left: ComplexArray
    ways: ComplexArray
    common: ComplexArray
    at: FloatArray

    def parted(self) -> "tuple[Lines, Lines]":
        """The lines below and above that at which half of what is left has passed."""
        power = np.cumsum(np.sum(np.abs(self.left) ** 2, axis=1))
        half = int(np.clip(np.searchsorted(power, 0.5 * power[-1]), LEAST_LINES, len(power) - LEAST_LINES))
        below, above = (
            Lines(self.left[part], self.ways[part], self.common[part], self.at)
            for part in (slice(None, half), slice(half, None))
        )
        return below, above


LEAST_LINES = 64
"""Of a part of a record."""


class Balance:
    """The force balance of one record.

    Args:
        run: the record beside the model's own run of it.
        rng: of the draws.
    """

    def __init__(self, run: BesideRun, rng: np.random.Generator) -> None:
        self.run, numbers = run, tolerances_of(run)
        self._whitener = np.linalg.inv(np.linalg.cholesky(_covariance(run, rng)))
        self._left = (self._whitener @ run.settled.left.T[:, :, None])[:, :, 0]
        self._common = self._whitener @ np.concatenate([numbers.columns, run.decays], axis=2)
        self._at = numbers.at

    def lines(self, positions: Sequence[float], *, channels: bool = True) -> Lines:
        """The balance with a force at each position, and with a signal on each channel.

        Args:
            positions: m from the clamp.
            channels: whether those are asked for.
        """
        shapes = np.array([self.run.model.rows(position) for position in positions])
        ways = self._whitener @ self.run.frf(shapes)
        if channels:
            ways = np.concatenate([ways, self._whitener], axis=2)
        return Lines(self._left, ways, self._common, self._at)


def _covariance(run: BesideRun, rng: np.random.Generator) -> ComplexArray:
    """(lines, n_channels, n_channels) of the noise and of what the laws' uncertain forces add."""
    variance = run.variance
    total = variance[:, :, None] * np.eye(variance.shape[1]).astype(complex)
    if run.places:
        paths = run.frf(run.beam.shapes)
        weighted = paths * _law_errors(run, rng).T[:, None, :]
        total += weighted @ paths.conj().swapaxes(1, 2)
    # What is not known of a law at all drowns the noise of the channels in round-off.
    largest = np.abs(np.diagonal(total, axis1=1, axis2=2)).max(axis=1)
    if not np.isfinite(largest).all():
        raise DivergenceError(f"{run.target.record.name}: what the laws' forces may be wrong by is not finite")
    total += ROUND_OFF * largest[:, None, None] * np.eye(total.shape[1])
    return np.asarray(total)


ROUND_OFF = 1e-14
"""Of the largest variance on a line."""


def _law_errors(run: BesideRun, rng: np.random.Generator) -> FloatArray:
    """(n_places, lines) power of the error of the laws' forces, N^2."""
    settled, still = run.settled, np.zeros(len(run.places))
    assert settled.estimate is not None
    known = run.forces(run.plant, settled.q, settled.v)
    power = np.zeros((len(run.places), run.target.measured.shape[1]))
    for _ in range(DRAWS):
        error = settled.estimate.error(rng)
        moved = run.beam.response(run.beam.shapes, still, error)
        speed = run.beam.response(run.beam.shapes, still + 1.0, error)
        forces = run.forces(run.plant, run.moved(settled.q, moved), run.moved(settled.v, speed))
        change = run.recorded(forces - known) + run.springs[:, None] * moved
        power += np.abs(scored_spectrum(change)) ** 2 / DRAWS
    return np.asarray(uniform_filter1d(power, SMOOTHED, axis=1))
