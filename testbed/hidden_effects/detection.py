"""From which size on effects are found, at which SNR: a logistic curve of the share found over the size.

Source: D. J. Finney, Probit Analysis (3rd ed., 1971), chapters 2 and 16: the dose of which a share responds, and its
interval by likelihood; with the logistic curve of J. Berkson, J. Am. Stat. Assoc. 39 (1944) 357.
"""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from math import exp, log

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import chi2

from testbed.hidden_effects.sets import MANY, Span
from testbed.outputs import Json

SIZE_EDGES = (0.0, 2.0, 3.0, MANY, 10.0, np.inf)
"""Calibrated errors over the noise, between which the cases are counted."""

FOUND = 0.9
"""Share of the effects of a size that are right, at which that size is called detected."""

SIZES = np.geomspace(1.0, 100.0, 161)
"""Times the noise, among which the limit is looked for: what is not there leaves the noise itself."""

STEEPNESS = (log(0.02), log(20.0))
"""Logarithms of the slopes between which the curve's is looked for, e-folds of the odds in an e-fold of the size."""

FALL = float(0.5 * chi2.ppf(0.95, 1))
"""Of the log likelihood, at the ends of the interval of 95 %."""


def detection(rows: Sequence[Json], snr: Span) -> Json:
    """How many effects of each size are found, and from which size on, for two ranges of SNR.

    Args:
        rows: of each case with one effect its ``snr_db``, its ``ratio`` and whether it is ``right``.
        snr: of the set, dB; its halves are the ranges.
    """
    ranges = tuple(pairwise((snr.low, 0.5 * (snr.low + snr.high), snr.high)))
    limits = []
    for low, high in ranges:
        inside = [row for row in rows if low <= row["snr_db"] <= high]
        limits.append({"snr_db": [low, high], "cases": len(inside), **limit_of(inside)})
    return {
        "rows": list(rows),
        "limits": limits,
        "by_size": [_of_size(rows, ranges, *edges) for edges in pairwise(SIZE_EDGES)],
    }


def limit_of(rows: Sequence[Json]) -> Json:
    """The size at which the share found comes to ``FOUND``, and its interval of 95 % by the profile of the likelihood.

    Args:
        rows: with ``ratio`` and ``right``.

    Returns:
        the ``ratio``, None where all or none are right, or where it lies beyond ``SIZES``; the ``interval``, an end of
        which is None where that does. Misses that have nothing to do with size raise the limit too.
    """
    right = np.array([row["right"] for row in rows], dtype=float)
    if not 0.0 < right.sum() < len(right):
        return {"ratio": None, "interval": [None, None]}
    size = np.log([row["ratio"] for row in rows])

    def cost(limit: float, steepness: float) -> float:
        odds = log(FOUND / (1.0 - FOUND)) + exp(steepness) * (size - limit)
        return float(np.sum(np.logaddexp(0.0, odds) - right * odds))

    def least(limit: float) -> float:
        return float(minimize_scalar(partial(cost, limit), bounds=STEEPNESS, method="bounded").fun)

    costs = np.array([least(limit) for limit in np.log(SIZES)])
    inside = np.flatnonzero(costs <= costs.min() + FALL)
    found = [float(SIZES[i]) if 0 < i < len(SIZES) - 1 else None for i in (int(costs.argmin()), inside[0], inside[-1])]
    return {"ratio": found[0], "interval": found[1:]}


def _of_size(rows: Sequence[Json], ranges: Sequence[tuple[float, float]], low: float, high: float) -> Json:
    """Counts of the cases between two sizes, for each range of SNR."""
    alike = [row for row in rows if low <= row["ratio"] < high]
    within = [[r for r in alike if least <= r["snr_db"] <= most] for least, most in ranges]
    counts = [{"right": sum(row["right"] for row in some), "cases": len(some)} for some in within]
    return {"from": low, "to": high if np.isfinite(high) else None, "counts": counts}
