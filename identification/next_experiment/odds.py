"""How sure one may expect to be after a test: the distribution of the log odds, and the probability it leads to."""

import numpy as np
from scipy.special import expit, logsumexp

from models.arrays import FloatArray

NODES = 96
"""Of the Gauss-Hermite rule; the least smooth integrand, a step as steep as the odds scatter, is then good to 1e-3."""

DRAWS = 4096
"""Of the odds against two rivals and more at once, which are drawn and not integrated; good to 0.005."""


def expected_probability(chances: FloatArray, scatter: FloatArray) -> float:
    """Probability that the right rival is expected to have after a test, averaged over which one is right.

    If rival a is right, the logarithm of its odds against b is normal with the mean log(p_a / p_b) + d^2 / 2 and the
    variance d^2 (docs/theory.md, "The next experiment").

    Args:
        chances: (K,) present probabilities, above 0; their sum counts as 1.
        scatter: (K, K, K) covariance of the log odds of the first against the others, d^2 on its diagonal.

    Source: G. E. P. Box, W. J. Hill, Technometrics 9 (1967) 57; K. Chaloner, I. Verdinelli, Statistical Science 10
    (1995) 273, section 2.
    """
    shares = chances / chances.sum()
    return float(sum(share * _if_right(a, shares, scatter[a]) for a, share in enumerate(shares.tolist())))


def present_probability(chances: FloatArray) -> float:
    """The same before the test: the mean of what each one has if it is right.

    Args:
        chances: (K,) as above.
    """
    shares = chances / chances.sum()
    return float(np.sum(shares**2))


def _if_right(a: int, shares: FloatArray, scatter: FloatArray) -> float:
    others = np.flatnonzero(np.arange(len(shares)) != a)
    spread = scatter[np.ix_(others, others)]
    mean = np.log(shares[a] / shares[others]) + 0.5 * np.diag(spread)
    if len(others) == 1:
        node, weight = np.polynomial.hermite_e.hermegauss(NODES)
        return float(weight @ expit(mean[0] + np.sqrt(spread[0, 0]) * node) / weight.sum())
    value, vector = np.linalg.eigh(spread)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    odds = mean + np.random.default_rng(0).standard_normal((DRAWS, len(others))) @ root.T
    against = logsumexp(np.column_stack([np.zeros(DRAWS), -odds]), axis=1)
    return float(np.mean(np.exp(-against)))
