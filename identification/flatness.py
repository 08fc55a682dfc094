"""Intervals where the valley of a number is flatter than its slopes say.

A contact whose spring is nearly gone has an exponent: by its slopes it is known to a quarter, but twice as large it
says the same, since there is no force left. So the model is moved to where two standard deviations of a number would
cost four, all others along as the slopes say, and farther for as long as it costs less.
"""

from dataclasses import replace

import numpy as np

from identification.evaluate import Evaluator
from identification.fit import Fit, prior_of
from identification.hypothesis import EffectUnknown, PlaceUnknown, at_coordinates, coordinates
from models.arrays import FloatArray

MOVE = 2.0
"""Standard deviations by which a number is moved first."""

FLATTER = 0.25
"""Share of what the slopes say that the move costs at least; below it the valley is twice as wide."""

FARTHEST = 32.0
"""Standard deviations beyond which nobody looks."""

HELD = 0.5
"""Share of a move that has to be left of it: what is at its bound is not moved beyond."""


def flattened(evaluator: Evaluator, found: Fit) -> Fit:
    """The fit with wider deviations of the effects' own numbers where a valley is flatter than its slopes say.

    The move is that of a profile with all other numbers on the straight line that the covariance gives; the true
    profile costs less, so no factor is too large. Source: D. M. Bates, D. G. Watts, Nonlinear Regression Analysis
    (1988), section 6.1.

    Args:
        evaluator: records that were fitted.
        found: the fit with its covariance.
    """
    factors = np.ones(len(found.unknowns))
    own = [i for i, unknown in enumerate(found.unknowns) if isinstance(unknown, EffectUnknown | PlaceUnknown)]
    base = _cost(evaluator, found, coordinates(found.hypothesis, found.unknowns)) if own else None
    if base is None:
        return found
    cost, gradient = base
    normal = found.jacobian @ found.jacobian.T + np.diag(prior_of(found.unknowns))
    for i in own:
        line = found.covariance[:, i] / np.sqrt(found.covariance[i, i])
        told = float(line @ normal @ line)
        for side in (-line, line):
            factors[i] = max(factors[i], _width(evaluator, found, i, side, cost, gradient, told))
    return replace(found, covariance=found.covariance * np.outer(factors, factors), widened=found.widened * factors)


def _width(
    evaluator: Evaluator, found: Fit, index: int, side: FloatArray, cost: float, gradient: FloatArray, told: float
) -> float:
    """How many times as far as the slopes say the model may be moved to one side of a number."""
    x, move = coordinates(found.hypothesis, found.unknowns), MOVE
    while move <= FARTHEST and told * move**2 < cost:  # farther than that slopes say nothing
        there = x + move * side
        held = found.unknowns[index].get(at_coordinates(found.hypothesis, found.unknowns, there))
        if abs(held - x[index]) < HELD * abs(move * side[index]):
            break
        moved = _cost(evaluator, found, there)
        if moved is None or moved[0] - cost - 2.0 * move * float(gradient @ side) >= FLATTER * told * move**2:
            break
        move *= 2.0
    return move / MOVE


def _cost(evaluator: Evaluator, found: Fit, x: FloatArray) -> tuple[float, FloatArray] | None:
    """Chi-square and prior at these coordinates, and half its gradient by the fit's slopes; None where it diverges."""
    (residual,) = evaluator.residuals([(at_coordinates(found.hypothesis, found.unknowns, x), None)])
    if residual is None:
        return None
    prior = prior_of(found.unknowns)
    return float(residual @ residual + prior @ x**2), found.jacobian @ residual + prior * x
