"""Whether frequency and damping change with time or with amplitude, by the evidence of simple laws of either.

A law adds g times a shape to the rate: a power of the amplitude, or of the time from the decay's start. Whatever no law
holds is left to a wandering rate, so that laws are judged by how much they leave to it. Decays from several levels
share a law of amplitude; in a single decay the amplitude falls with time, and only the shapes differ.
docs/theory.md, section 12.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from identification.decay.course import RATE_SPREAD, WANDERS, integral_of
from identification.decay.walk import Freedom, Jumps, Points, evidence
from models.arrays import FloatArray

AMPLITUDE_POWERS = (-1.0, -0.5, 0.5, 1.0, 1.5, 2.0, 3.0)
"""Of the amplitude in a rate: -1 dry friction, 1 drag of the velocity's square or slip in joints, 2 a cubic force."""

TIME_POWERS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
"""Of the time in a rate: 1 a straight drift, less where it slows down, more where it speeds up."""

DECISIVE = 20.0
"""Odds against every other from which a cause of a change is named."""

NOTHING = Jumps(np.empty(0), np.empty(0))


@dataclass(frozen=True, eq=False)
class Watched:
    """One rate of one mode in one decay.

    Attributes:
        points: levels beside the rate's guess.
        log_amplitude: (n,) of the mode at the points' times, Np, on one scale in all decays.
        scale: how much the rate may well change, 1/s.
    """

    points: Points
    log_amplitude: FloatArray
    scale: float


@dataclass(frozen=True)
class Law:
    """One simple law.

    Attributes:
        of: ``amplitude`` or ``time``.
        power: of it.
    """

    of: str
    power: float


@dataclass(frozen=True)
class Cause:
    """What a mode's rate depends on.

    Attributes:
        verdict: ``steady``, ``irregular``, ``amplitude``, ``time`` or ``undecided``.
        probabilities: of the first four, equally likely beforehand.
        law: the most probable law of amplitude or time, where that is the verdict.
    """

    verdict: str
    probabilities: dict[str, float]
    law: Law | None


def find_cause(decays: Sequence[Watched]) -> Cause:
    """Weigh a steady rate, laws of amplitude and laws of time against each other.

    Args:
        decays: the same rate of the same mode in one or more decays, which share its law.
    """
    laws = {law: _evidence(decays, law, (0.0, *WANDERS)) for law in _laws()}
    marginal = {
        "steady": _evidence(decays, None, (0.0,)),
        "irregular": _evidence(decays, None, tuple(WANDERS)),
        "amplitude": _mean([value for law, value in laws.items() if law.of == "amplitude"]),
        "time": _mean([value for law, value in laws.items() if law.of == "time"]),
    }
    total = logsumexp(list(marginal.values()))
    probabilities = {name: float(np.exp(value - total)) for name, value in marginal.items()}
    first, second = sorted(marginal, key=marginal.__getitem__)[:1:-1]
    if first != "steady" and marginal[first] - marginal[second] < np.log(DECISIVE):
        return Cause("undecided", probabilities, None)
    own = [law for law in laws if law.of == first]
    return Cause(first, probabilities, max(own, key=laws.__getitem__, default=None))


def _laws() -> Iterator[Law]:
    yield from (Law("amplitude", power) for power in AMPLITUDE_POWERS)
    yield from (Law("time", power) for power in TIME_POWERS)


def _mean(logs: Sequence[float]) -> float:
    return float(logsumexp(logs) - np.log(len(logs)))


def _evidence(decays: Sequence[Watched], law: Law | None, sizes: Sequence[float]) -> float:
    """Log-evidence of all decays under one law of the same strength, averaged over how much the rest wanders."""
    shapes = _shapes(decays, law)
    return _mean([_with_freedom(decays, shapes, size) for size in sizes])


def _with_freedom(decays: Sequence[Watched], shapes: Sequence[FloatArray], size: float) -> float:
    """The strength g is integrated out: the log-evidence is a parabola in it, known from three values."""
    scale = decays[0].scale
    if not shapes:
        return sum(_single(decay, 0.0, size) for decay in decays)
    low, middle, high = (
        sum(_single(decay, g * shape, size) for decay, shape in zip(decays, shapes, strict=True))
        for g in (-scale, 0.0, scale)
    )
    slope, bend = (high - low) / (2.0 * scale), (high + low - 2.0 * middle) / scale**2
    precision = 1.0 / scale**2 - bend
    return float(middle + 0.5 * slope**2 / precision - 0.5 * np.log(precision * scale**2))


def _single(decay: Watched, rate: FloatArray | float, size: float) -> float:
    """Log-evidence of one decay whose rate is a known (n,) part and one that wanders by a size."""
    points, scale = decay.points, decay.scale
    duration = float(points.edges[-1] - points.edges[0])
    free = Freedom((RATE_SPREAD * scale) ** 2, 0.0, (size * scale) ** 2 / duration, 0.0, 0.0)
    known = integral_of(points.times, np.broadcast_to(rate, points.times.shape), points.times)
    return float(evidence(points._replace(levels=points.levels - known), free, NOTHING))


def _shapes(decays: Sequence[Watched], law: Law | None) -> list[FloatArray]:
    """(n,) for each decay, the law's power, which runs over a range of 1 in all of them together."""
    if law is None:
        return []
    if law.of == "amplitude":
        highest = max(decay.log_amplitude.max() for decay in decays)
        shapes = [np.exp(law.power * (decay.log_amplitude - highest)) for decay in decays]
    else:
        longest = max(decay.points.edges[-1] - decay.points.edges[0] for decay in decays)
        shapes = [((decay.points.times - decay.points.edges[0]) / longest) ** law.power for decay in decays]
    lowest, highest = min(shape.min() for shape in shapes), max(shape.max() for shape in shapes)
    return [(shape - lowest) / (highest - lowest) for shape in shapes]
