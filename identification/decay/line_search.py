"""The ordinary searches that a quantum genetic algorithm has to beat: golden section, evolution and a grid."""

import numpy as np
from scipy.optimize import Bounds, OptimizeResult, differential_evolution, minimize_scalar

from identification.decay.search import Objective, RememberingObjective, Search, check_box
from models.arrays import FloatArray
from models.errors import InputError

FINEST = 3.0 * float(np.sqrt(np.finfo(float).eps))
"""Share of the position below which the bracket of a minimum does not shrink: a parabola is flat there in rounding."""

MEMBERS_PER_VARIABLE = 15
"""Population of the differential evolution for each variable."""

SPREAD = 1e-4
"""The evolution stops when its values spread by less than this share of their mean, the quantum search's tolerance."""

MAX_GENERATIONS = 100
"""Generations of the evolution at most, as many as the quantum search has iterations."""


def golden_search(objective: Objective, lower: FloatArray, upper: FloatArray, tolerance: float) -> Search:
    """Look for the minimum of one variable by golden sections, with parabolic steps where they fit.

    It finds the only minimum of a function that has one, and some minimum of any other.

    Args:
        objective: takes (1,), returns a number.
        lower: (1,) lower bound, not itself evaluated.
        upper: (1,) upper bound, not itself evaluated.
        tolerance: of the position, in the unit of the variable; not finer than ``FINEST`` of the position.

    Raises:
        InputError: a box that is empty, not finite or of several variables, no tolerance, or an objective of nan.

    Source: Brent, Algorithms for Minimization without Derivatives, 1973, chapter 5.
    """
    check_box(lower, upper)
    if lower.size != 1:
        raise InputError(
            f"a box of {lower.size} variables", "golden section has one", "use evolution_search or quantum_search"
        )
    if not tolerance > 0.0:
        raise InputError(
            f"a tolerance of {tolerance:g}", "it is above 0", "ask for the accuracy that the variable is worth"
        )
    ask = RememberingObjective(objective)
    with np.errstate(invalid="ignore"):  # beside a value of inf no parabola fits, and scipy takes a golden section
        found = minimize_scalar(
            lambda x: ask(np.array([x])),
            bounds=(lower.item(), upper.item()),
            method="bounded",
            options={"xatol": tolerance},
        )
    reached = max(tolerance, FINEST * abs(float(found.x)))
    narrow = f"a minimum lies within {reached:g} of the best position"
    reason = narrow if found.success else f"the limit of {ask.evaluations} evaluations was reached"
    return ask.close("golden section", reason)


def evolution_search(objective: Objective, lower: FloatArray, upper: FloatArray, seed: int) -> Search:
    """Look for the minimum by differential evolution, without polishing.

    Polishing would follow differences over 1e-8 of the variables, which are 0 on a step and noise on a measured time.

    Args:
        objective: takes (n_var,), returns a number.
        lower: (n_var,) lower bounds.
        upper: (n_var,) upper bounds.
        seed: of the random numbers.

    Raises:
        InputError: a box that is empty or not finite, or an objective of nan.

    Source: Storn and Price, J. Global Optim. 11 (1997) 341, strategy best/1/bin.
    """
    check_box(lower, upper)
    ask = RememberingObjective(objective)
    history: list[float] = []

    def note(intermediate_result: OptimizeResult) -> None:
        history.append(float(intermediate_result.fun))

    try:
        found = differential_evolution(
            ask,
            Bounds(lower, upper),
            maxiter=MAX_GENERATIONS,
            popsize=MEMBERS_PER_VARIABLE,
            tol=SPREAD,
            seed=np.random.default_rng(seed),
            callback=note,
            polish=False,
        )
    except RuntimeError as error:  # in the first generation scipy takes any ValueError for one of its own
        if isinstance(error.__cause__, InputError):
            raise error.__cause__ from None
        raise
    settled = f"the values of a generation spread by less than {SPREAD:g} of their mean"
    reason = settled if found.success else f"the limit of {MAX_GENERATIONS} generations was reached"
    return ask.close("differential evolution", reason, np.array(history))


def grid_search(objective: Objective, points: FloatArray) -> Search:
    """Take the lowest of given points, such as scales that are powers of two.

    Args:
        objective: takes (n_var,), returns a number.
        points: (n, n_var) positions, one or more.

    Raises:
        InputError: points of another size or not finite, or an objective of nan.
    """
    if points.ndim != 2 or points.size == 0 or not np.isfinite(points).all():
        raise InputError(
            f"points of size {points.shape} from {points.min(initial=np.inf):g} to {points.max(initial=-np.inf):g}",
            "a grid is (n, n_var) finite positions, one or more",
            "pass one row per point",
        )
    ask = RememberingObjective(objective)
    for point in points:
        ask(point)
    return ask.close("grid", f"all {ask.evaluations} points of the grid were evaluated")
