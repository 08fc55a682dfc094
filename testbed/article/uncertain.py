"""What uncertain numbers do to the natural frequencies: the article's three conditions, and the posterior beside them.

The article draws stiffness, damping and clearance of the contacts from assumed normal distributions. What the taps
say of these numbers is a distribution too: the posterior, sampled here, of which the assumed ones know nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import gaussian_kde, t

from models.arrays import FloatArray
from models.rig import Rig
from testbed.article.reading import TappedModes
from testbed.article.small_motion import MODES, Draws, SmallMotion
from testbed.article.updating import READ_TO

SAMPLES = 10_000
"""Rigs a condition."""

SEED = 57

CONDITIONS: Mapping[str, float] = {"stiffness": 0.1, "damping": 0.3, "clearance": 0.1}
"""What is random in each of the three conditions: both sleeves' numbers, and one standard deviation as a share."""

WALKERS, STEPS, BURNT = 40, 1500, 300
"""Of the sampler of the posterior; the steps at the begin that are thrown away."""

LOG_DAMPING = 1.0
"""Prior of the dampings: one e-fold about what the owner of the rig wrote."""

ACCEPTABLE = 0.1
"""The article's acceptable range of relative differences is from minus to plus this."""

CONFIDENCE = 0.95

GRID = 2000


@dataclass(frozen=True, eq=False)
class Statistics:
    """Of N natural frequencies of each order.

    Attributes:
        mean, std: (4,) Hz.
        mean_within, std_within: (4,) half the 95 % interval of both, Hz.
    """

    mean: FloatArray
    std: FloatArray
    mean_within: FloatArray
    std_within: FloatArray

    @classmethod
    def of(cls, freqs: FloatArray) -> "Statistics":
        """Of (N, 4) frequencies, Hz."""
        n, mean, std = len(freqs), freqs.mean(axis=0), freqs.std(axis=0, ddof=1)
        fourth = np.mean((freqs - mean) ** 4, axis=0)
        quantile = t.ppf(0.5 + 0.5 * CONFIDENCE, n - 1)
        spread = np.sqrt(np.maximum(fourth - std**4, 0.0) / n) / (2.0 * np.maximum(std, np.finfo(float).tiny))
        return cls(mean, std, quantile * std / np.sqrt(n), quantile * spread)

    @property
    def variation(self) -> FloatArray:
        """(4,) std over mean."""
        return np.asarray(self.std / self.mean)


@dataclass(frozen=True, eq=False)
class Posterior:
    """Samples of what the taps leave open.

    Attributes:
        draws: N rigs.
        autocorrelation: (5,) steps of the sampler after which it has forgotten, per number.
    """

    draws: Draws
    autocorrelation: FloatArray


def condition(motion: SmallMotion, rig: Rig, what: str, n: int = SAMPLES) -> FloatArray:
    """(n, 4) natural frequencies with one kind of number random, Hz.

    Args:
        motion: of the rod.
        rig: with the means.
        what: key of ``CONDITIONS``.
        n: samples.
    """
    rng = np.random.default_rng([SEED, list(CONDITIONS).index(what)])
    means = Draws.of(rig, n)
    factors = 1.0 + CONDITIONS[what] * rng.standard_normal((n, 2))
    while (factors <= 0.0).any():
        factors = np.where(factors > 0.0, factors, 1.0 + CONDITIONS[what] * rng.standard_normal((n, 2)))
    return motion.natural_freqs(replace(means, **{what: getattr(means, what) * factors}))


def posterior(motion: SmallMotion, given: Rig, modes: TappedModes, n: int = SAMPLES) -> Posterior:
    """What the taps say of Young's modulus, stiffness and damping of the contacts, by an affine-invariant sampler.

    Args:
        motion: of the rod as given.
        given: the rig as its owner describes it, with his tolerances.
        modes: identified from the taps.
        n: samples that are kept.

    Source: D. Foreman-Mackey et al., Publ. Astron. Soc. Pacific 125 (2013) 306.
    """
    import emcee

    tolerance = np.array(
        [p.tolerance for p in given.parameters() if p.path == "youngs_modulus"] + [_tolerance(given)] * 2
    )
    ratios = modes.damping_ratios.mean(axis=0)

    def draws_of(x: FloatArray) -> Draws:
        nominal, moved = Draws.of(given, len(x)), np.exp(x[:, :3] * tolerance)
        return Draws(
            nominal.stiffness * moved[:, 1:], nominal.damping * np.exp(x[:, 3:]), nominal.clearance, moved[:, 0]
        )

    def log_density(x: FloatArray) -> FloatArray:
        poles = motion.poles(draws_of(x))
        misses = np.log(np.abs(poles) / (2.0 * np.pi) / modes.mean_freqs) / READ_TO[0]
        ratio_misses = (-poles.real / np.abs(poles) / ratios - 1.0) / READ_TO[1]
        prior = np.sum(x[:, :3] ** 2, axis=1) + np.sum((x[:, 3:] / LOG_DAMPING) ** 2, axis=1)
        return np.asarray(-0.5 * (np.sum(misses**2, axis=1) + np.sum(ratio_misses**2, axis=1) + prior))

    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]
    sampler = emcee.EnsembleSampler(WALKERS, 5, log_density, vectorize=True, moves=moves)
    sampler.random_state = np.random.RandomState(SEED).get_state()
    begin = np.random.default_rng(SEED).standard_normal((WALKERS, 5)) * 0.3
    begin[:, 3:] += np.log(3.0)
    sampler.run_mcmc(begin, STEPS)
    kept = sampler.get_chain(discard=BURNT, flat=True)
    chosen = np.random.default_rng([SEED, 9]).choice(len(kept), n, replace=len(kept) < n)
    return Posterior(draws_of(kept[chosen]), np.asarray(sampler.get_autocorr_time(quiet=True)))


def coincidence(one: FloatArray, other: FloatArray) -> float:
    """Share that two distributions have in common: the area below both densities.

    Args:
        one: samples.
        other: samples.
    """
    low, high = min(one.min(), other.min()), max(one.max(), other.max())
    room = 0.2 * (high - low)
    grid = np.linspace(low - room, high + room, GRID)
    return float(np.trapezoid(np.minimum(gaussian_kde(one)(grid), gaussian_kde(other)(grid)), grid))


@dataclass(frozen=True, eq=False)
class Difference:
    """Computed over measured frequency less one, of each order.

    Attributes:
        measured: (4,) Hz.
        computed: (4,) mean, Hz.
        mean, std: (4,).
        interval: (4, 2) of the mean over the tests, Student's.
        inside: (4,) share of the samples within ``ACCEPTABLE``.
    """

    measured: FloatArray
    computed: FloatArray
    mean: FloatArray
    std: FloatArray
    interval: FloatArray
    inside: FloatArray


def difference(samples: FloatArray, tests: FloatArray) -> Difference:
    """Of all samples against all tests.

    Args:
        samples: (N, 4) computed, Hz.
        tests: (n_taps, 4) measured, Hz.
    """
    apart = samples[:, None, :] / tests[None, :, :] - 1.0
    of_test = apart.mean(axis=0)
    n = len(tests)
    within = t.ppf(0.5 + 0.5 * CONFIDENCE, n - 1) * of_test.std(axis=0, ddof=1) / np.sqrt(n)
    mean = of_test.mean(axis=0)
    return Difference(
        tests.mean(axis=0),
        samples.mean(axis=0),
        mean,
        apart.reshape(-1, MODES).std(axis=0),
        np.stack([mean - within, mean + within], axis=1),
        np.mean(np.abs(apart) < ACCEPTABLE, axis=(0, 1)),
    )


def _tolerance(given: Rig) -> float:
    return next(p.tolerance for p in given.parameters() if p.path.endswith(".stiffness"))
