"""How near each estimator comes to the Cramer-Rao bound, over noise, damping and the distance to the next mode."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import product

import numpy as np

from identification.decay.cramer_rao import poles_bound
from identification.decay.poles import Poles, fit_poles
from identification.decay.ridge import follow_mode
from identification.decay.smoother import smooth_decay
from identification.signals.separate import separate
from models.arrays import ComplexArray, FloatArray

SNRS = (20.0, 30.0, 40.0, 60.0, 80.0)
DAMPINGS = (0.0002, 0.001, 0.005, 0.02, 0.05)
SPACINGS = (0.02, 0.05, 0.1, 0.2, 0.5)
SPACING_SNR = 40.0

FREQ, FS = 10.0, 200.0
LONGEST, TIME_CONSTANTS = 40.0, 6.0
"""A record lasts this many time constants of the decay, and at most so many seconds."""

PHASES = (0.3, 1.7)
"""Of the two modes at the first sample, rad."""

ASTRAY = 0.5
"""Share of the distance to the second mode, or of the frequency itself, beyond which an estimate is another mode's."""


@dataclass(frozen=True)
class Cell:
    """Rms errors of one case over its seeds, as multiples of the bound; None where an estimator found nothing.

    Attributes:
        snr_db: mean power of the record over that of the noise, dB.
        damping_ratio: of both modes.
        spacing: distance of the second mode, as a share of the first one's frequency; None where there is none.
        duration: s.
        bound_freq: standard deviation of the first mode's frequency, Hz.
        bound_ratio: of its damping ratio.
        ratios: estimator -> (frequency, damping ratio).
        lost: estimator -> seeds in which it gave nothing or another mode.
    """

    snr_db: float
    damping_ratio: float
    spacing: float | None
    duration: float
    bound_freq: float
    bound_ratio: float
    ratios: dict[str, tuple[float | None, float | None]]
    lost: dict[str, int]


ESTIMATORS = ("poles", "smoother", "ridge")


def bound_table(seeds: int, pool: Executor) -> Iterator[Cell]:
    """All cells: one mode over noise and damping, then two modes over distance and damping.

    Args:
        seeds: for each cell.
        pool: that they are shared among.
    """
    single = [(snr, ratio, None) for snr, ratio in product(SNRS, DAMPINGS)]
    double = [(SPACING_SNR, ratio, spacing) for spacing, ratio in product(SPACINGS, DAMPINGS)]
    yield from pool.map(cell_of, *zip(*((*case, seeds) for case in [*single, *double]), strict=True))


def cell_of(snr_db: float, ratio: float, spacing: float | None, seeds: int) -> Cell:
    """One cell.

    Args:
        snr_db: dB.
        ratio: damping ratio.
        spacing: of the second mode, or None.
        seeds: their number.
    """
    freqs = FREQ * np.array([1.0] if spacing is None else [1.0, 1.0 + spacing])
    omega = 2.0 * np.pi * freqs
    values = omega * (1j * np.sqrt(1.0 - ratio**2) - ratio)
    duration = float(np.clip(TIME_CONSTANTS / (ratio * omega[0]), 12.0 / FREQ, LONGEST))
    n = round(duration * FS)
    shapes = np.exp(1j * np.array(PHASES[: len(freqs)]))[:, None]
    clean = (shapes[:, 0, None] * np.exp(values[:, None] * np.arange(n) / FS)).real.sum(axis=0)
    noise = float(np.sqrt(np.mean(clean**2))) * 10.0 ** (-snr_db / 20.0)
    bound = poles_bound(values, shapes, np.array([noise]), fs=FS, n_samples=n)
    found: dict[str, list[tuple[float, float] | None]] = {name: [] for name in ESTIMATORS}
    for seed in range(seeds):
        dice = np.random.default_rng([seed, round(snr_db), round(1e5 * ratio), round(100.0 * (spacing or 0.0))])
        measured = (clean + noise * dice.standard_normal(n))[None]
        for name, estimate in _estimates(measured, values, freqs).items():
            found[name].append(estimate)
    truth = (float(np.abs(values[0])) / (2.0 * np.pi), ratio)
    least = (float(bound.natural_freq_stds[0]), float(bound.damping_ratio_stds[0]))
    reach = ASTRAY * truth[0] * (spacing or 1.0)
    errors = {name: _errors(estimates, truth, least, reach) for name, estimates in found.items()}
    ratios = {name: rms for name, (rms, _) in errors.items()}
    lost = {name: count for name, (_, count) in errors.items()}
    return Cell(snr_db, ratio, spacing, duration, *least, ratios, lost)


def _estimates(measured: FloatArray, values: ComplexArray, freqs: FloatArray) -> dict[str, tuple[float, float] | None]:
    """Frequency and damping ratio of the first mode by each estimator, begun 0.2 % off."""
    poles = fit_poles(measured, FS, values * 1.002)
    mode = smooth_decay(measured, FS, poles, np.ones(1))[0]
    return {
        "poles": (float(poles.natural_freqs[0]), float(poles.damping_ratios[0])),
        "smoother": (mode.mean_of(mode.natural_freq)[0], mode.mean_of(mode.damping_ratio)[0]),
        "ridge": _of_ridge(measured[0], poles, freqs),
    }


def _of_ridge(measured: FloatArray, poles: Poles, freqs: FloatArray) -> tuple[float, float] | None:
    """Means over time, each moment weighted by the ridge's power."""
    alone = measured if len(freqs) == 1 else separate(measured, FS, np.array([freqs.mean()]))[0]
    skeleton = follow_mode(alone, FS, float(poles.natural_freqs[0]))
    power = skeleton.amplitude**2
    if not np.isfinite(skeleton.damping_ratio).all():
        return None
    return (
        float(np.average(skeleton.frequency, weights=power)),
        float(np.average(skeleton.damping_ratio, weights=power)),
    )


def _errors(
    estimates: Sequence[tuple[float, float] | None],
    truth: tuple[float, float],
    least: tuple[float, float],
    reach: float,
) -> tuple[tuple[float | None, float | None], int]:
    """Rms errors over the bound, and how many estimates were lost: none at all, or beyond a reach in Hz."""
    given = np.array([estimate for estimate in estimates if estimate is not None]).reshape(-1, 2)
    kept = given[np.abs(given[:, 0] - truth[0]) < reach]
    if not len(kept):
        return (None, None), len(estimates)
    freq, ratio = np.sqrt(np.mean(((kept - truth) / least) ** 2, axis=0))
    return (float(freq), float(ratio)), len(estimates) - len(kept)
