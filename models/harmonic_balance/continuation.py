"""Following a curve of solutions around its folds by pseudo-arclength, with steps as long as Newton's method allows.

Source: R. Seydel, Practical Bifurcation and Stability Analysis (2010), chapter 4.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from models.arrays import FloatArray

NEWTON_TOLERANCE = 1e-9
"""Of the last correction beside the point, in the curve's own units; what is left is of the order of its square."""

MOST_ITERATIONS, WANTED_ITERATIONS = 10, 4.0
"""A point that needs more is sought again closer by; steps grow or shrink until the wanted number is needed."""

MOST_HALVINGS = 6
"""Of a correction that leads further away."""

SHARPEST_TURN = 0.8
"""Cosine between the directions of two neighbouring points below which the step was too long."""

CORNER = 1e-4
"""Length of a step below which the curve may turn by up to a right angle: where a dashpot begins to touch it bends."""

STEPS = (1e-8, 0.02, 0.1)
"""Least, first and longest step, in the curve's own units."""

Seen = TypeVar("Seen")
"""What the equations know beside their residual."""

Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray, Seen]]
"""(m + 1,) a point -> (m,) residual, (m, m + 1) slopes and what was seen on the way."""


@dataclass(frozen=True, eq=False)
class Point(Generic[Seen]):
    """A solution on the curve.

    Attributes:
        u: (m + 1,) in the curve's own units.
        direction: (m + 1,) of the curve there, of length 1.
        iterations: that Newton's method took.
        seen: by the equations before the last correction.
    """

    u: FloatArray
    direction: FloatArray
    iterations: int
    seen: Seen


def corrected(evaluate: Evaluate[Seen], guess: FloatArray, direction: FloatArray) -> Point[Seen] | None:
    """The solution in the plane through a guess at right angles to a direction; None where Newton's method fails.

    Args:
        evaluate: the equations.
        guess: (m + 1,) near the curve.
        direction: (m + 1,) of the plane's normal, to which the new direction turns the same way.
    """
    u, step = guess.copy(), np.zeros(len(guess))
    last = np.zeros(len(u))
    last[-1] = 1.0
    left = np.inf
    for iteration in range(1, MOST_ITERATIONS + 1):
        residual, slope, seen = evaluate(u)
        size = float(np.linalg.norm(residual))
        for _ in range(MOST_HALVINGS):
            if size <= left:
                break
            # A contact that just touches has two slopes; the longer way led past the corner.
            step *= 0.5
            u -= step
            residual, slope, seen = evaluate(u)
            size = float(np.linalg.norm(residual))
        left = size
        # One factorisation gives the step and the curve's direction.
        try:
            both = np.linalg.solve(np.vstack([slope, direction]), np.column_stack([np.append(-residual, 0.0), last]))
        except np.linalg.LinAlgError:
            return None
        step = both[:, 0]
        if not np.isfinite(step).all():
            return None
        u += step
        if np.linalg.norm(step) < NEWTON_TOLERANCE * (1.0 + np.linalg.norm(u)):
            return Point(u, both[:, 1] / np.linalg.norm(both[:, 1]), iteration, seen)
    return None


def next_step(step: float, iterations: int) -> float:
    """Length of the next step after one of ``step`` that took so many iterations."""
    return float(np.clip(step * np.clip(WANTED_ITERATIONS / iterations, 0.5, 2.0), STEPS[0], STEPS[2]))
