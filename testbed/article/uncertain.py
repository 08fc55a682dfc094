"""What uncertain numbers do to the natural frequencies: the article's three conditions, and the posterior beside them.

The article draws stiffness, damping and clearance of the contacts from assumed normal distributions. What the taps say
of these numbers is a distribution too: the posterior. The model is a little wrong; how much is not told beforehand but
inferred with the numbers. It is wrong in the same way after every tap, so all taps together count as one.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np
from scipy.stats import gaussian_kde, t

from models.arrays import FloatArray
from models.rig import Rig
from testbed.article.reading import TappedModes
from testbed.article.small_motion import MODES, Draws, SmallMotion

SAMPLES = 10_000
"""Rigs a condition."""

SEED = 57

CONDITIONS: Mapping[str, float] = {"stiffness": 0.1, "damping": 0.3, "clearance": 0.1}
"""What is random in each of the three conditions: both sleeves' numbers, and one standard deviation as a share."""

LEAST = 0.05
"""Share of its mean at which a normal number is cut off."""

WALKERS, STEPS, BURNT = 40, 1000, 300
"""Of the sampler of the posterior; the steps at the begin that are thrown away."""

EVERY = 2
"""Of the taps one in so many informs the posterior; the course of the dampings over all of them is the identifier's."""

LOG_COURSE = 0.3
"""Prior of the factors on the identified courses of the dampings."""

MISFITS = (1e-3, 2e-2)
"""Medians of the priors of the model's own relative errors, of frequencies and of damping ratios; one decade wide."""

NUMBERS = ("E", "k1", "k2", "c1", "c2", "error of f", "error of the ratios")
"""That the posterior is about: logarithms of factors, the first three in tolerances."""

ACCEPTABLE = 0.1
"""The article's acceptable range of relative differences is from minus to plus this."""

CONFIDENCE = 0.95

BOOTSTRAPS = 100
"""Sets of taps drawn anew, for the interval of a coincidence."""

GRID = 500


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
    def of(cls, freqs: FloatArray, independent: float | None = None) -> "Statistics":
        """Of (N, 4) frequencies, Hz, of which so many are worth; all where None."""
        mean, std = freqs.mean(axis=0), freqs.std(axis=0, ddof=1)
        n = len(freqs) if independent is None else independent
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
        numbers: (N, 7) in the order of ``NUMBERS``.
        draws: N rigs, their dampings as factors on the identified courses.
        forgotten: steps after which the sampler has forgotten, at most.
        independent: what the samples are worth.
    """

    numbers: FloatArray
    draws: Draws
    forgotten: float
    independent: float

    def at_taps(self, motion: SmallMotion, course: FloatArray) -> FloatArray:
        """(N, n_taps, 4) natural frequencies after every tap, Hz.

        Args:
            motion: of the rod.
            course: (n_taps, 2) identified dampings, N s/m.
        """
        rows = [np.abs(motion.poles(_damped(self.draws, at))) / (2.0 * np.pi) for at in course]
        return np.stack(rows, axis=1)


def draws_at(rig: Rig, points: FloatArray) -> Draws:
    """The rigs of (N, 6) standard normal numbers, two a kind in the order of ``CONDITIONS``.

    Args:
        rig: with the means.
        points: in standard deviations.
    """
    means = Draws.of(rig, len(points))
    spread = np.repeat([CONDITIONS[what] for what in CONDITIONS], 2)
    factors = np.maximum(1.0 + spread * points, LEAST)
    stiffness, damping = means.stiffness * factors[:, :2], means.damping * factors[:, 2:4]
    return Draws(stiffness, damping, means.clearance * factors[:, 4:], means.modulus)


def condition(motion: SmallMotion, rig: Rig, what: str | None, n: int = SAMPLES) -> FloatArray:
    """(n, 4) natural frequencies with one kind of number random, or all of them, Hz.

    Args:
        motion: of the rod.
        rig: with the means.
        what: key of ``CONDITIONS``; None for all at once.
        n: samples.
    """
    kinds = list(CONDITIONS)
    number = len(kinds) if what is None else kinds.index(what)
    points = np.random.default_rng([SEED, number]).standard_normal((n, 6))
    if what is not None:
        points[:, [column for column in range(6) if column // 2 != number]] = 0.0
    return motion.natural_freqs(draws_at(rig, points))


def posterior(motion: SmallMotion, given: Rig, modes: TappedModes, course: FloatArray, n: int = 2000) -> Posterior:
    """What the taps say of Young's modulus, stiffness and damping of the contacts, by differential evolution.

    Args:
        motion: of the rod as given.
        given: the rig as its owner describes it, with his tolerances.
        modes: identified from the taps.
        course: (n_taps, 2) identified dampings of the sleeves, N s/m.
        n: samples that are kept.

    Source: C. J. F. ter Braak, Statistics and Computing 16 (2006) 239, as in emcee: D. Foreman-Mackey et al., Publ.
        Astron. Soc. Pacific 125 (2013) 306.
    """
    import emcee

    toleranced = {p.path: p.tolerance for p in given.parameters()}
    tolerance = np.array(
        [toleranced[f"{path}"] for path in ("youngs_modulus", "sleeves[0].stiffness", "sleeves[1].stiffness")]
    )
    freqs, ratios, seen = modes.natural_freqs[::EVERY], modes.damping_ratios[::EVERY], course[::EVERY]

    def draws_of(x: FloatArray) -> Draws:
        nominal, moved = Draws.of(given, len(x)), np.exp(x[:, :3] * tolerance)
        return Draws(nominal.stiffness * moved[:, 1:], np.exp(x[:, 3:5]), nominal.clearance, moved[:, 0])

    def log_density(x: FloatArray) -> FloatArray:
        draws, errors = draws_of(x), np.array(MISFITS) * np.exp(x[:, 5:])
        total = -0.5 * (np.sum(x[:, :3] ** 2, axis=1) + np.sum((x[:, 3:5] / LOG_COURSE) ** 2, axis=1))
        total -= 0.5 * np.sum((x[:, 5:] / np.log(10.0)) ** 2, axis=1)
        for freq, ratio, at in zip(freqs, ratios, seen, strict=True):
            poles = motion.poles(_damped(draws, at))
            omega = np.maximum(np.abs(poles), np.finfo(float).tiny)  # far out a dashpot may hold the rod for good
            apart = np.log(omega / (2.0 * np.pi) / freq), -poles.real / omega / ratio - 1.0
            for which, misses in enumerate(apart):
                scale = errors[:, which]
                told = 0.5 * np.sum((misses / scale[:, None]) ** 2, axis=1) + MODES * np.log(scale)
                total -= told / len(freqs)
        return np.asarray(total)

    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]
    sampler = emcee.EnsembleSampler(WALKERS, len(NUMBERS), log_density, vectorize=True, moves=moves)
    sampler.random_state = np.random.RandomState(SEED).get_state()
    sampler.run_mcmc(np.random.default_rng(SEED).standard_normal((WALKERS, len(NUMBERS))) * 0.3, STEPS)
    forgotten = float(np.max(sampler.get_autocorr_time(discard=BURNT, tol=0)))
    chain = sampler.get_chain(discard=BURNT, thin=max(ceil(0.5 * forgotten), 1), flat=True)
    chosen = chain[np.random.default_rng([SEED, 9]).choice(len(chain), min(n, len(chain)), replace=False)]
    worth = min(len(chosen), WALKERS * (STEPS - BURNT) / forgotten)
    return Posterior(chosen, draws_of(chosen), forgotten, worth)


def _damped(draws: Draws, course: FloatArray) -> Draws:
    """The rigs with their factors on the (2,) dampings of one moment."""
    return Draws(draws.stiffness, draws.damping * course, draws.clearance, draws.modulus)


def coincidence(one: FloatArray, other: FloatArray) -> tuple[float, float]:
    """Share that two distributions have in common, the area below both densities, and half its 95 % interval.

    Args:
        one: samples, many.
        other: samples, few, which are drawn anew for the interval.
    """
    low, high = min(one.min(), other.min()), max(one.max(), other.max())
    room = 0.2 * (high - low)
    grid = np.linspace(low - room, high + room, GRID)
    density, rng = gaussian_kde(one)(grid), np.random.default_rng(SEED)

    def shared(samples: FloatArray) -> float:
        return float(np.trapezoid(np.minimum(density, gaussian_kde(samples)(grid)), grid))

    again: list[float] = []
    while len(again) < BOOTSTRAPS:
        drawn = rng.choice(other, len(other))
        if np.ptp(drawn) > 0.0:
            again.append(shared(drawn))
    low_half, high_half = np.quantile(again, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE])
    return shared(other), float(0.5 * (high_half - low_half))


@dataclass(frozen=True, eq=False)
class Difference:
    """Computed over measured frequency less one, of each order, each tap against the model at its own time.

    Attributes:
        measured, computed: (4,) means over the taps, Hz.
        mean, std: (4,) over taps and samples.
        interval: (4, 2) of the mean, Student's over the taps.
        inside: (4,) share of samples and taps within ``ACCEPTABLE``.
    """

    measured: FloatArray
    computed: FloatArray
    mean: FloatArray
    std: FloatArray
    interval: FloatArray
    inside: FloatArray


def difference(samples: FloatArray, tests: FloatArray) -> Difference:
    """Of all samples from the test's taps.

    Args:
        samples: (N, n_taps, 4) computed, Hz.
        tests: (n_taps, 4) measured, Hz.
    """
    apart = samples / tests - 1.0
    of_tap, n = apart.mean(axis=0), len(tests)
    within = t.ppf(0.5 + 0.5 * CONFIDENCE, n - 1) * of_tap.std(axis=0, ddof=1) / np.sqrt(n)
    mean = of_tap.mean(axis=0)
    return Difference(
        tests.mean(axis=0),
        samples.mean(axis=(0, 1)),
        mean,
        apart.reshape(-1, MODES).std(axis=0),
        np.stack([mean - within, mean + within], axis=1),
        np.mean(np.abs(apart) < ACCEPTABLE, axis=(0, 1)),
    )
