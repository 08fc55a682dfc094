"""How a force runs over one quantity: which simple function predicts it as well as any does."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from identification.locating.columns import Columns, predicted
from models.arrays import FloatArray

BENDS = np.linspace(0.05, 0.8, 12)
"""Where a saturation is reached or a threshold lies, as shares of the largest value seen often."""

OFTEN = 0.99
"""Share of the samples below the largest value that is seen often."""

CLOSE = 0.01
"""Of the force's power: functions that predict so much less than the best are as good as it."""


@dataclass(frozen=True, eq=False)
class Course:
    """A force over one quantity.

    Attributes:
        form: linear, hardening, softening, saturating or threshold; other where no simple function is as good as any.
        bend: where the saturation is reached or the threshold lies, in the quantity's unit; 0 for the others.
        side: odd, even, lopsided, or one side where the motion stays on one.
        against: whether the force is against the quantity.
    """

    form: str
    bend: float
    side: str
    against: bool


def course_of(own: Columns, name: str) -> Course:
    """The simplest course that predicts as well as any.

    Args:
        own: functions of the quantity, for what other quantities leave of the force.
        name: of the quantity.
    """
    values = [record.signals[name] for record in own.records]
    pooled = np.concatenate(values)
    often = float(np.quantile(np.abs(pooled), OFTEN))
    low, high = np.quantile(pooled, [1.0 - OFTEN, OFTEN])

    def by(function: Callable[[FloatArray], FloatArray]) -> Columns:
        return own.laid([function(x / often) for x in values])

    straight = by(lambda x: x[:, None])
    linear = predicted(straight)
    cubic = by(lambda x: np.stack([x, x**3], axis=1))
    flat = _bent(lambda bend: predicted(by(partial(_up_to, bend=bend))))
    stop = _bent(lambda bend: predicted(by(partial(_beyond, bend=bend))))
    one_sided = bool(min(-low, high) < ONE_SIDE * max(-low, high))
    side = "one side" if one_sided else _side(*(predicted(by(f)) for f in (_odd, _even, _both)))
    against = bool(straight.weights[0] < 0.0)
    best = max(linear, predicted(cubic), flat[0], stop[0])
    if linear >= best - CLOSE:
        return Course("linear", 0.0, side, against)
    if flat[0] >= best - CLOSE and flat[1] < SHARP:
        return Course("saturating", flat[1] * often, side, against)
    if stop[0] >= best - CLOSE and stop[0] > predicted(cubic) + CLOSE:
        return Course("threshold", stop[1] * often, side, against)
    bent = cubic.weights
    return Course(
        "hardening" if bent[0] * bent[1] > 0.0 or abs(bent[1]) > abs(bent[0]) else "softening", 0.0, side, against
    )


SHARP = 0.45
"""Share of the largest value before which a saturation is reached that is more than a bend."""

ONE_SIDE = 0.15
"""Reach on the lesser side over that on the larger, below which the motion stays on one side."""


def _bent(score: Callable[[float], float]) -> tuple[float, float]:
    """The best score and its bend, from a coarse row of bends and a finer one about the best."""
    _, about = max((score(float(bend)), float(bend)) for bend in BENDS)
    step = float(BENDS[1] - BENDS[0])
    return max((score(bend), bend) for bend in (about + step * np.arange(-0.75, 1.0, 0.25)).tolist() if bend > 0.0)


def _up_to(x: FloatArray, bend: float) -> FloatArray:
    return np.clip(x, -bend, bend)[:, None]


def _beyond(x: FloatArray, bend: float) -> FloatArray:
    return (x - np.clip(x, -bend, bend))[:, None]


def _odd(x: FloatArray) -> FloatArray:
    """(N, n) odd broken lines."""
    return np.stack([x, *(np.clip(x, -k, k) / k for k in (0.05, 0.15, 0.3, 0.5, 0.75))], axis=1)


def _even(x: FloatArray) -> FloatArray:
    """(N, n) even broken lines."""
    return np.abs(_odd(x))


def _both(x: FloatArray) -> FloatArray:
    return np.concatenate([_odd(x), _even(x)], axis=1)


def _side(odd: float, even: float, both: float) -> str:
    if odd >= (1.0 - SAME) * both:
        return "odd"
    return "even" if even >= (1.0 - SAME) * both else "lopsided"


SAME = 0.05
"""Share of what functions of both kinds predict, by which one kind may fall short."""
