"""A model whose toleranced numbers need not go as far from what their owner says.

Where only one wall of a sleeve is touched, its clearance and its offset are known together and neither alone. Least
squares then follow what the model misses a little, as far as to where the other wall begins to touch, and stop at that
edge, of which they think that it tells both. What the records say is weighed in the unit of the model's own error, what
the owner says as it is.
"""

import numpy as np

from identification.calibrate import PULLED_SIGMA
from identification.evaluate import Evaluator
from identification.evidence import misfit_of
from identification.fit import LEAST_GAIN, Fit, fit, newton_step, prior_of
from identification.hypothesis import RigUnknown, at_coordinates, coordinates

FAR, FAR_BESIDE_LAW = 2.0, 1.0
"""Standard deviations from the given number from which another place for it is tried; beside a law of several numbers,
which trade off along a curved valley: of a friction that never sticks, force and slip velocity seemed to be known to
40 % where three times both left as much."""


def unstrained(evaluator: Evaluator, found: Fit) -> Fit:
    """The fit, or that from where its far numbers are as given and all others follow, if it is the likelier one.

    Steps by the slopes of the fit, which take no differences, show where that goes; it is followed only where it has
    come to a likelier place, or promises one.

    Args:
        evaluator: records that were fitted.
        found: at its minimum; without effects only numbers that something seems to have pulled are tried elsewhere.
    """
    x = coordinates(found.hypothesis, found.unknowns)
    effects = found.hypothesis.effects
    several = any(effect.n_numbers > 1 for effect in effects)
    least = FAR_BESIDE_LAW if several else FAR if effects else PULLED_SIGMA
    far = [i for i, unknown in enumerate(found.unknowns) if isinstance(unknown, RigUnknown) and abs(x[i]) > least]
    if not far:
        return found
    together = found.covariance[:, far] @ np.linalg.solve(found.covariance[np.ix_(far, far)], -x[far])
    unit = misfit_of(found)

    def unlikely(one: Fit) -> float:
        return one.chi2 / unit + one.penalty

    try:
        start = at_coordinates(found.hypothesis, found.unknowns, x + together)
        look = fit(evaluator, start, found.unknowns, max_iterations=STEPS, jacobian=found.jacobian, keep=True)
        if min(unlikely(look), _promised(look, unit)) > unlikely(found) - LEAST_GAIN:
            return found
        again = fit(evaluator, look.hypothesis, found.unknowns, precise=True, like=found)
    except ArithmeticError:
        return found
    return min((found, again), key=unlikely)


STEPS = 6
"""By the slopes of a fit from where its far numbers are as given."""


def _promised(look: Fit, unit: float) -> float:
    """How unlikely the place is to which a step more leads, were the model linear."""
    step, _ = newton_step(look.hypothesis, look.unknowns, look.jacobian, look.residual)
    left = look.residual + step @ look.jacobian
    there = coordinates(look.hypothesis, look.unknowns) + step
    return float(left @ left / unit + prior_of(look.unknowns) @ there**2)


def moved_back(found: Fit, back: Fit) -> str:
    """Where the numbers are now that were far from what their owner says; empty where they are as far.

    Args:
        found: a fit.
        back: from where its far numbers are as given (``unstrained``), with the same unknowns.
    """
    before, after = (coordinates(each.hypothesis, each.unknowns) for each in (found, back))
    moves = [
        f"{unknown.parameter.label} at {now:+.1f} standard deviations instead of {then:+.1f}"
        for unknown, then, now in zip(found.unknowns, before, after, strict=True)
        if isinstance(unknown, RigUnknown) and abs(then) > FAR and abs(then) - abs(now) > NEARER
    ]
    if not moves:
        return ""
    return f"likelier by what the records and the owner say together: {', '.join(moves)}"


NEARER = 0.1
"""Standard deviations that are worth telling."""
