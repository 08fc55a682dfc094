"""The course of a rate along a record, its form not told: steady, straight, wandering or bending, with jumps.

Every form is a linear Gaussian model (``walk``), so its probability given the points is exact. Jumps are looked for one
after the other at every place; their times keep their own uncertainty. What is reported is the average over all that
is not improbable, and its intervals those of the mixture. docs/theory.md, section 10.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import erfc, sqrt

import numpy as np
from scipy.special import logsumexp

from identification.decay.walk import Freedom, Jumps, Points, evidence, evidence_with_jump, smoothed
from models.arrays import FloatArray
from models.compiled import compiled

RATE_SPREAD = 3.0
"""Standard deviation of the rate at the start about its guess, in scales; the same in all forms."""

SLOPE_SPREAD = 2.0
"""Standard deviation of the rate's change over the record by a straight slope, in scales."""

WANDERS = 10.0 ** np.arange(-2.0, 1.01, 0.25)
"""Standard deviations of the rate's change over the record by wandering, in scales, all equally likely beforehand."""

BENDS = 10.0 ** np.arange(-1.5, 2.01, 0.25)
"""The same for the change of its slope, in scales per record."""

FORMS = ("constant", "line", "wandering", "bending")

JUMP_ODDS = 0.3
"""Of each further jump beforehand."""

MOST_JUMPS = 6
LEAST_POINTS = 8
"""Fewer do not tell a change from anything else."""

LEAST_WEIGHT = 1e-3
"""A form that is less probable than this share of the best is left out."""

DRAWS = 32
"""Of the jumps' times for a form that is certain, one from each of as many equally likely stretches."""

FINE, ZOOMS = 64, 2
"""Places at which the time of a jump is weighed where it may lie, and how often that is narrowed down."""

IMPROBABLE = 12.0
"""Log of the odds beyond which a place is left out."""

BISECTIONS = 44
ROOT_2 = sqrt(2.0)
TINY = 1e-300


@dataclass(frozen=True)
class Told:
    """What is known of a course's form beforehand; nothing by default.

    Attributes:
        forms: of ``constant``, ``line``, ``wandering`` and ``bending``.
        jumps: their number, or None where the data decide.
    """

    forms: tuple[str, ...] = FORMS
    jumps: int | None = None


UNTOLD = Told()


@dataclass(frozen=True, eq=False)
class Jump:
    """A sudden change of a rate.

    Attributes:
        time: most probable, s.
        std: of the time, s.
        probability: that the rate jumps here at all.
        size: change of the rate, 1/s.
    """

    time: float
    std: float
    probability: float
    size: float


@dataclass(frozen=True, eq=False)
class Component:
    """One model of the average: how probable, which form, what it is free to do, and where it jumps."""

    weight: float
    form: str
    free: Freedom
    jumps: Jumps


@dataclass(frozen=True, eq=False)
class Course:
    """A rate along a record with its intervals.

    Attributes:
        times: (n,) s, finest where the rate may jump; the first and last are the ends of what is followed.
        rate: (n,) mean of all forms, each kept within the interval, 1/s.
        low, high: (n,) bounds of the 95 % interval.
        forms: how probable each form is.
        jumps: those more probable than not.
    """

    times: FloatArray
    rate: FloatArray
    low: FloatArray
    high: FloatArray
    forms: dict[str, float]
    jumps: tuple[Jump, ...]

    @cached_property
    def std(self) -> FloatArray:
        """(n,) standard deviation of a normal law with the same interval, 1/s."""
        return (self.high - self.low) / (2.0 * NORMAL_95)

    def beside(self, rate: float) -> "Course":
        """The course of a rate whose levels were taken beside a line of another rate, 1/s."""
        return replace(self, rate=self.rate + rate, low=self.low + rate, high=self.high + rate)

    def at(self, times: FloatArray) -> FloatArray:
        """The rate at (m,) times, s."""
        return np.interp(times, self.times, self.rate)


NORMAL_95 = 1.959964
"""Half-width of the 95 % interval of a normal law, in standard deviations."""

Kick = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class _Stage:
    """All forms with one more jump than the stage before."""

    evidence: float
    candidates: tuple[tuple[float, str, Freedom], ...]
    jumps: FloatArray
    posteriors: tuple[tuple[FloatArray, FloatArray], ...]


@dataclass(frozen=True, eq=False)
class Weighed:
    """All forms with all jumps that the points ask for, each with its probability.

    Attributes:
        points: observed levels.
        span: ends of what is followed, s.
        kick: (m,) s, the level's jump for a unit jump of the rate at each of (m,) times.
        stages: without jumps, with one, and so on.
    """

    points: Points
    span: tuple[float, float]
    kick: Kick
    stages: tuple["_Stage", ...]

    def most_likely(self) -> tuple[FloatArray, FloatArray]:
        """(n,) s and (n,) 1/s, the rate by the most probable model alone."""
        stage = max(self.stages, key=lambda stage: stage.evidence)
        part = Component(1.0, "", max(stage.candidates)[2], Jumps(stage.jumps, self.kick(stage.jumps)))
        times = _reading_times(self.points, self.span, stage.jumps)
        return times, _rate_of(self.points, part, times)[0]

    def average(self) -> Course:
        """The average over all that is not improbable, with the intervals of the mixture."""
        total = float(logsumexp([stage.evidence for stage in self.stages]))
        components = [part for stage in self.stages for part in _components(stage, total, self.kick)]
        times = _reading_times(self.points, self.span, np.concatenate([part.jumps.times for part in components]))
        means, stds = np.empty((2, len(components), len(times)))
        for i, part in enumerate(components):
            means[i], stds[i] = _rate_of(self.points, part, times)
        weights = np.array([part.weight for part in components])
        weights /= weights.sum()
        low, high = quantiles(weights, means, np.maximum(stds, TINY), np.array([0.025, 0.975]))
        rate = weights @ np.clip(means, low, high)
        forms = {form: float(weights[[p.form == form for p in components]].sum()) for form in FORMS}
        return Course(times, rate, low, high, forms, tuple(_jumps(self.stages, total, times, rate)))


def weigh(points: Points, span: tuple[float, float], scale: float, kick: Kick, told: Told = UNTOLD) -> Weighed:
    """Weigh all forms with all jumps that the points ask for.

    Args:
        points: observed levels.
        span: ends of what is followed, s.
        scale: how much a rate may well change, 1/s.
        kick: see ``Weighed``.
        told: what is known of the form.
    """
    few = len(points.times) < LEAST_POINTS
    if few and told is UNTOLD:
        told = Told(("constant",), 0)
    forms = tuple(_forms(scale, span[1] - span[0], told))
    stages = [_stage(points, forms, np.empty(0), (), kick, 0.0)]
    most = MOST_JUMPS if told.jumps is None else told.jumps
    while len(stages) <= most:
        stages.append(_one_more(points, forms, stages[-1], kick))
        if told.jumps is None and stages[-1].evidence < max(s.evidence for s in stages) - IMPROBABLE / 2.0:
            break
    return Weighed(points, span, kick, tuple(stages if told.jumps is None else stages[-1:]))


def integral_of(times: FloatArray, rate: FloatArray, at: FloatArray) -> FloatArray:
    """(m,) integral from the first of (n,) times to each of (m,) others, of a rate straight between, constant outside.

    Args:
        times: (n,) s.
        rate: (n,) 1/s.
        at: (m,) s.
    """
    sums = np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times)))
    k = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    inside = np.clip(at, times[0], times[-1]) - times[k]
    slope = (rate[k + 1] - rate[k]) / (times[k + 1] - times[k])
    outside = (at - np.clip(at, times[0], times[-1])) * np.interp(at, times, rate)
    return np.asarray(sums[k] + inside * (rate[k] + 0.5 * inside * slope) + outside)


def _forms(scale: float, duration: float, told: Told) -> Iterator[tuple[float, str, Freedom]]:
    """(log of the prior, form, freedom) of every form with every size."""
    rate, jump = (RATE_SPREAD * scale) ** 2, scale**2
    slope = (SLOPE_SPREAD * scale / duration) ** 2
    prior = -np.log(len(told.forms))
    if "constant" in told.forms:
        yield prior, "constant", Freedom(rate, 0.0, 0.0, 0.0, jump)
    if "line" in told.forms:
        yield prior, "line", Freedom(rate, slope, 0.0, 0.0, jump)
    if "wandering" in told.forms:
        for size in WANDERS:
            wander = (size * scale) ** 2 / duration
            yield prior - np.log(len(WANDERS)), "wandering", Freedom(rate, 0.0, wander, 0.0, jump)
    if "bending" in told.forms:
        for size in BENDS:
            bend = (size * scale / duration) ** 2 / duration
            yield prior - np.log(len(BENDS)), "bending", Freedom(rate, slope, 0.0, bend, jump)


def _stage(
    points: Points,
    forms: Sequence[tuple[float, str, Freedom]],
    jumps: FloatArray,
    posteriors: tuple[tuple[FloatArray, FloatArray], ...],
    kick: Kick,
    prior: float,
) -> _Stage:
    at = Jumps(jumps, kick(jumps))
    candidates = tuple((prior + p + evidence(points, free, at), form, free) for p, form, free in forms)
    return _Stage(float(logsumexp([c[0] for c in candidates])), candidates, jumps, posteriors)


def _one_more(points: Points, forms: Sequence[tuple[float, str, Freedom]], stage: _Stage, kick: Kick) -> _Stage:
    """The stage with another jump where it explains most, all jumps then placed anew, each beside the others."""
    likely = max(stage.candidates)[2]
    stiff = max((c for c in stage.candidates if c[1] in {"constant", "line"}), default=max(stage.candidates))[2]
    options = [_place(points, free, stage.jumps, kick) for free in dict.fromkeys((likely, stiff))]
    free, placed = max(zip(dict.fromkeys((likely, stiff)), options, strict=True), key=lambda option: option[1].best)
    jumps = np.append(stage.jumps, placed.most_likely)
    posteriors, prior = [], 0.0
    for j in range(len(jumps)):
        placed = _place(points, free, np.delete(jumps, j), kick)
        jumps[j] = placed.most_likely
        posteriors.append((placed.where, placed.weights))
        prior += placed.share + np.log(JUMP_ODDS)
    return _stage(points, forms, jumps, tuple(posteriors), kick, prior)


@dataclass(frozen=True, eq=False)
class _Placed:
    """Where a jump may lie.

    Attributes:
        where: (n,) s.
        weights: (n,) probabilities.
        best: the largest log-evidence.
        share: log of the mean over the record against the best, what an unknown place costs.
    """

    where: FloatArray
    weights: FloatArray
    best: float
    share: float

    @property
    def most_likely(self) -> float:
        return float(self.where[int(np.argmax(self.weights))])


def _place(points: Points, free: Freedom, others: FloatArray, kick: Kick) -> _Placed:
    """Weigh every place of one jump beside the others, ever finer where it may lie."""
    given = Jumps(others, kick(others))
    where = points.edges[1:-1]
    step = float(np.median(np.diff(where)))
    start, end = float(where[0]), float(points.edges[-1])
    gains = evidence_with_jump(points, free, given, where, kick(where))
    for _ in range(ZOOMS):
        likely = where[gains > gains.max() - IMPROBABLE]
        low, high = max(likely[0] - step, start), min(likely[-1] + step, end)
        step = (high - low) / FINE
        where = low + step * (np.arange(FINE) + 0.5)
        gains = evidence_with_jump(points, free, given, where, kick(where))
    total = logsumexp(gains)
    best = float(gains.max())
    return _Placed(where, np.exp(gains - total), best, float(total - best + np.log(step / (end - start))))


def _reading_times(points: Points, span: tuple[float, float], jumps: FloatArray) -> FloatArray:
    """(n,) s, the points' and both sides of every jump, within the span."""
    edge = 1e-6 * (span[1] - span[0])
    times = np.unique(np.concatenate([points.times, span, jumps - edge, jumps + edge]))
    return np.asarray(times[(times >= span[0]) & (times <= span[1])])


def _components(stage: _Stage, total: float, kick: Kick) -> Iterator[Component]:
    for log_evidence, form, free in stage.candidates:
        weight = float(np.exp(log_evidence - total))
        if weight < LEAST_WEIGHT:
            continue
        draws = _draws(stage.posteriors, max(round(DRAWS * weight), 4))
        for times in draws:
            yield Component(weight / len(draws), form, free, Jumps(times, kick(times)))


def _draws(posteriors: Sequence[tuple[FloatArray, FloatArray]], n: int) -> FloatArray:
    """(n, n_jumps) times; one row without any where nothing jumps."""
    if not posteriors:
        return np.empty((1, 0))
    shares = (np.arange(n) + 0.5) / n
    turn = np.random.default_rng(0)  # only the pairing of independent draws
    columns = []
    for where, weights in posteriors:
        step = where[1] - where[0]
        edges = np.append(where - 0.5 * step, where[-1] + 0.5 * step)
        columns.append(turn.permutation(np.interp(shares, np.append(0.0, np.cumsum(weights)), edges)))
    return np.stack(columns, axis=1)


def _rate_of(points: Points, part: Component, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(m,) mean and standard deviation of one model's rate at (m,) times."""
    states, covariances = smoothed(points, part.free, part.jumps)
    t = points.times
    k = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    share = (times - t[k]) / (t[k + 1] - t[k])
    nearest = np.where(share < 0.5, k, k + 1)
    inside = np.clip(share, 0.0, 1.0)
    rate = states[k, 1] + inside * (states[k + 1, 1] - states[k, 1])
    variance = covariances[k, 1, 1] + inside * (covariances[k + 1, 1, 1] - covariances[k, 1, 1])
    apart = (share < 0.0) | (share > 1.0)
    for jump in part.jumps.times:
        own = int(np.searchsorted(points.edges, jump, side="right")) - 1
        around = (times > t[own - 1]) & (times < t[min(own + 1, len(t) - 1)])
        nearest = np.where(around, np.where(times < jump, own - 1, own), nearest)
        apart |= around
    h = (times - t[nearest])[apart]
    x, P = states[nearest[apart]], covariances[nearest[apart]]
    rate[apart] = x[:, 1] + h * x[:, 2]
    spread = part.free.wander * np.abs(h) + part.free.bend * np.abs(h) ** 3 / 3.0
    variance[apart] = P[:, 1, 1] + 2.0 * h * P[:, 1, 2] + h**2 * P[:, 2, 2] + spread
    return rate, np.sqrt(np.maximum(variance, 0.0))


@compiled
def quantiles(weights: FloatArray, means: FloatArray, stds: FloatArray, shares: FloatArray) -> FloatArray:
    """(n_shares, m) quantiles of mixtures of (n,) normal laws at each of m times, by bisection."""
    n, m = means.shape
    out = np.empty((shares.shape[0], m))
    for k in range(m):
        for s in range(shares.shape[0]):
            low, high = means[0, k], means[0, k]
            for i in range(n):
                low, high = min(low, means[i, k] - 9.0 * stds[i, k]), max(high, means[i, k] + 9.0 * stds[i, k])
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                below = 0.0
                for i in range(n):
                    below += weights[i] * 0.5 * erfc((means[i, k] - middle) / (stds[i, k] * ROOT_2))
                if below < shares[s]:
                    low = middle
                else:
                    high = middle
            out[s, k] = 0.5 * (low + high)
    return out


def _jumps(stages: Sequence[_Stage], total: float, times: FloatArray, rate: FloatArray) -> Iterator[Jump]:
    """The jumps of the most probable stage, in order of time."""
    best = max(stages, key=lambda stage: stage.evidence)
    for j in np.argsort(best.jumps):
        where, weights = best.posteriors[j]
        mean = float(weights @ where)
        std = float(np.sqrt(weights @ (where - mean) ** 2))
        margin = 4.0 * std + where[1] - where[0]
        size = float(np.interp(best.jumps[j] + margin, times, rate) - np.interp(best.jumps[j] - margin, times, rate))
        probability = float(np.exp(logsumexp([s.evidence for s in stages if len(s.jumps) > j]) - total))
        yield Jump(float(best.jumps[j]), std, min(probability, 1.0), size)
