"""A damping over time as the effect ``time_varying_damping``, with as few knots as its interval asks for."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray, IntArray
from models.effects.protocol import Place
from models.effects.time_varying_damping import TimeVaryingDamping
from models.errors import InputError

MOST_KNOTS = 20

OUTSIDE, BY_CHANCE, FAR_OUTSIDE = 0.05, 2.0, 3.0
"""Share of the times at which the table may leave a 95 % interval, with how many standard deviations of that share, and
by how many half widths at most: six standard deviations, which no noise reaches."""

CANDIDATES = 100
"""Times, evenly among all, at which the next knot is tried."""

STEEP, LAGS = 4, (1, 2, 4, 8, 16)
"""Pairs of knots that are tried together: those between which the values change most, over so many times."""


def damping_effect(
    place: Place, times: FloatArray, values: FloatArray, low: FloatArray, high: FloatArray, *, most: int = MOST_KNOTS
) -> TimeVaryingDamping:
    """The effect whose table runs within the interval at 95 % of the times, or comes closest with the most knots.

    Knots are set one after the other where they help most, and those that are not needed are taken away again. Their
    values are fitted to all, each weighted by its interval.

    Args:
        place: the sleeve.
        times: (n,) s, growing, from the record's first sample.
        values: (n,) N s/m.
        low: (n,) lower bounds of the 95 % interval.
        high: (n,) upper bounds.
        most: knots.

    Raises:
        InputError: sizes that do not fit, times that do not grow, or an interval without width.
    """
    _check(times, values, low, high)
    course = _Course(times, values, 0.5 * (high - low))
    knots = np.zeros(1, np.int64)
    while not course.holds(knots) and len(knots) < min(most, len(times)):
        knots = course.with_more(knots, most)
    knots = course.thinned(knots)
    at, fitted = times[knots], course.fitted(knots)
    return TimeVaryingDamping(place, times=tuple(at.tolist()), values=tuple(np.maximum(fitted, 0.0).tolist()))


def _check(times: FloatArray, values: FloatArray, low: FloatArray, high: FloatArray) -> None:
    if not times.size or not times.shape == values.shape == low.shape == high.shape or times.ndim != 1:
        raise InputError(
            f"times, values and bounds of sizes {', '.join(str(a.shape) for a in (times, values, low, high))}",
            "they are (n,) each, n 1 or more",
            "leave out times at which nothing was identified",
        )
    finite = all(np.isfinite(a).all() for a in (times, values, low, high))
    if not finite or (np.diff(times) <= 0.0).any() or (high <= low).any():
        raise InputError(
            "a damping over time with times that do not grow, an empty interval or numbers that are not finite",
            "an interval has a width at every time, and times grow",
            "sort the times and leave out what was not identified",
        )


@dataclass(frozen=True, eq=False)
class _Course:
    """What the table is to follow: (n,) times, values and half widths of their intervals."""

    times: FloatArray
    values: FloatArray
    half: FloatArray

    def fitted(self, knots: IntArray) -> FloatArray:
        """(n_knots,) values at the knots, by weighted least squares over all times."""
        hats = self._hats(knots) / self.half[:, None]
        return np.asarray(np.linalg.lstsq(hats, self.values / self.half, rcond=None)[0])

    def holds(self, knots: IntArray) -> bool:
        """Whether the table keeps to the interval."""
        missed, n = self._missed(knots), len(self.times)
        allowed = OUTSIDE + BY_CHANCE * np.sqrt(OUTSIDE * (1.0 - OUTSIDE) / n)
        return bool(np.mean(missed > 1.0) <= allowed and missed.max() <= FAR_OUTSIDE)

    def with_more(self, knots: IntArray, most: int) -> IntArray:
        """With both ends after the first, then with the one, or the two beside a jump, that help most for each."""
        last = len(self.times) - 1
        if len(knots) == 1:
            return np.array([0, last], np.int64)
        options = [np.union1d(knots, place) for place in self._places(knots)]
        if len(knots) + 2 <= most:
            options += [np.union1d(knots, pair) for pair in self._pairs(knots)]
        now = self._misfit(knots)
        return max(options, key=lambda option: (now - self._misfit(option)) / (len(option) - len(knots)))

    def _places(self, knots: IntArray) -> IntArray:
        evenly = np.linspace(0, len(self.times) - 1, min(CANDIDATES, len(self.times))).astype(np.int64)
        beside = np.clip(np.concatenate([knots - 1, knots + 1]), 0, len(self.times) - 1)
        return np.setdiff1d(np.concatenate([evenly, beside]), knots)

    def _pairs(self, knots: IntArray) -> Iterator[IntArray]:
        for lag in (lag for lag in LAGS if lag < len(self.times)):
            change = np.abs(self.values[lag:] - self.values[:-lag]) / (self.half[lag:] + self.half[:-lag])
            for place in np.argsort(-change)[:STEEP]:
                pair = np.array([place, place + lag])
                if not np.isin(pair, knots).any():
                    yield pair

    def thinned(self, knots: IntArray) -> IntArray:
        """Without the knots that the interval does not ask for, the least missed first."""
        while len(knots) > 2 and self.holds(knots):
            options = [np.delete(knots, i) for i in range(1, len(knots) - 1)]
            best = min(options, key=self._misfit)
            if not self.holds(best):
                break
            knots = best
        return knots

    def _missed(self, knots: IntArray) -> FloatArray:
        """(n,) distances from the table, in half widths."""
        return np.asarray(np.abs(self._hats(knots) @ self.fitted(knots) - self.values) / self.half)

    def _misfit(self, knots: IntArray) -> float:
        return float(np.sum(self._missed(knots) ** 2))

    def _hats(self, knots: IntArray) -> FloatArray:
        at = self.times[knots]
        return np.stack([np.interp(self.times, at, unit) for unit in np.eye(len(knots))], axis=1)
