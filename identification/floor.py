"""The floor of a spectrum: the density that its quietest bands have in common, without the bias of a minimum.

The least of k bands of noise lies below the noise by the expected extreme of k numbers times their scatter: the least
of the medians of twenty bands of twenty lines at half of it. So the bands are sorted, and the lowest ones pooled for as
long as the next is no higher than the highest of that many bands of equal noise may be. If all are noise, all are
pooled and the mean has no bias; if few are, the others stand clear of them.
"""

from dataclasses import dataclass
from math import log, sqrt

import numpy as np
from scipy.stats import norm

from models.arrays import FloatArray


@dataclass(frozen=True)
class Floor:
    """What the quietest bands have in common.

    Attributes:
        density: their mean.
        n_bands: how many were pooled.
        lines: free lines in them; the density is known to about 1.4 / sqrt(lines) of itself.
    """

    density: float
    n_bands: int
    lines: float


def spectral_floor(density: FloatArray, width: int, correlated: float) -> Floor:
    """The floor of a periodogram, from the medians of half-overlapping bands.

    Args:
        density: (n_lines,) periodogram.
        width: lines of a band.
        correlated: lines that scatter like one free one, N sum(w^4) / sum(w^2)^2 of the window.
    """
    width = min(width, len(density))
    starts = range(0, len(density) - width + 1, max(1, width // 2))
    free = width / correlated
    medians = np.array([np.median(density[i : i + width]) for i in starts]) / median_over_mean(free)
    return common_floor(medians, free)


def common_floor(levels: FloatArray, free: float) -> Floor:
    """The mean of the lowest levels that can be one level.

    Args:
        levels: (k,) density of each half-overlapping band by its median, unbiased.
        free: lines of a band that scatter independently.
    """
    ordered = np.sort(levels)
    means = np.cumsum(ordered) / np.arange(1, len(ordered) + 1)
    scatter = scatter_of_medians(free)
    limits = [mean * (1.0 + scatter * (expected_extreme(n + 2) + CHANCE)) for n, mean in enumerate(means[:-1])]
    above = np.flatnonzero(ordered[1:] > np.array(limits))
    n = int(above[0]) + 1 if above.size else len(ordered)
    return Floor(float(means[n - 1]), n, 0.5 * (n + 1) * free)


CHANCE = 1.5
"""Standard deviations by which the highest of some bands may lie above its expectation."""


def expected_extreme(k: int) -> float:
    """Expectation of the largest of k standard normal numbers.

    Source: G. Blom, Statistical Estimates and Transformed Beta-Variables (1958), section 6.9.
    """
    return float(norm.ppf((k - 0.375) / (k + 0.25)))


def median_over_mean(lines: float) -> float:
    """Expected median of periodogram ordinates over their mean.

    Args:
        lines: free ordinates, each exponentially distributed; the expectation is sum 1/i over the upper half of them.
    """
    return log(2.0) + 0.5 / max(lines, 1.0)


def scatter_of_medians(lines: float) -> float:
    """Standard deviation of the median of so many ordinates, as a share of it: 1 / (density at the median sqrt(n))."""
    return 1.0 / (log(2.0) * sqrt(max(lines, 1.0)))
