"""Noise taken out of vibration signals: by wavelet thresholds, and by an ensemble of empirical mode decompositions.

Both take the noise for white, of the rms that the finest wavelet level's median tells, so modes lie below a quarter of
the sampling rate. A threshold distorts what it leaves: the universal soft threshold makes a decay faster by much. The
threshold here, sigma^2 over the rms of the level's signal, falls where the signal is strong, and the garrote leaves
large coefficients alone. A decay rate read from a narrow Gaussian window gains nothing from either, for the window is
narrower than a wavelet level, and loses a little once the decay sinks into the noise;
tests/identification/signals/test_denoise_decay.py measures both.

Source: S. G. Chang, B. Yu, M. Vetterli, IEEE Trans. Image Process. 9 (2000) 1532, BayesShrink; H.-Y. Gao, J. Comput.
Graph. Stat. 7 (1998) 469, the garrote; D. L. Donoho, I. M. Johnstone, Biometrika 81 (1994) 425, the median.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pywt
from scipy.stats import chi2

from models.arrays import FloatArray
from models.errors import InputError

WAVELET = "sym8"

LEAST_COEFFICIENTS = 64
"""Coefficients of the coarsest level: fewer do not tell their variance."""

MEDIAN_OF_NORMAL = 0.6745
"""Median of the magnitude of a standard normal variable."""

TRIALS = 32
"""Decompositions per channel; half of them have the other half's noise with the sign turned."""

NOISE_SHARE = 0.2
"""Rms of the added noise in multiples of the signal's. Source: Wu and Huang (2009)."""

SIFTS = 10
"""Sifting steps per function, fixed. Source: Wu and Huang (2009)."""

MOST_FUNCTIONS = 10

BLOCK_PERIODS = 32
"""Mean periods of a function over which its energy is judged: a damped mode lives in the first few alone."""

FALSE_ALARM = 1e-3
"""Chance that a function of noise alone is kept in a record."""

WHITE_FIRST, WHITE = 1.8, 1.1
"""Energy times mean period, in samples, of unit white noise in the first and in any later function, at most."""


@dataclass(frozen=True, eq=False)
class Denoised:
    """Signals without what was taken for noise.

    Attributes:
        signals: (n_channels, N).
        removed_rms: (n_channels,) rms of what was taken out, in the signals' unit.
        share_removed: (n_channels,) its share of the signals' power.
        what: what was taken out and why, in words.
    """

    signals: FloatArray
    removed_rms: FloatArray
    share_removed: FloatArray
    what: tuple[str, ...]


def denoise_wavelet(signals: FloatArray, fs: float) -> Denoised:
    """Shrink the wavelet coefficients of each channel, level by level.

    Args:
        signals: (n_channels, N).
        fs: sampling rate, Hz.

    Raises:
        InputError: signals of another size, not finite, or too short for one level.

    Source: Chang, Yu and Vetterli (2000), the threshold; Gao (1998), the shrinking.
    """
    _check(signals)
    return _denoised(signals, *_shrunk(signals, fs, noise_rms(signals)))


def denoise_ensemble(
    signals: FloatArray, fs: float, *, seed: int, trials: int = TRIALS, noise_share: float = NOISE_SHARE
) -> Denoised:
    """Take out the intrinsic mode functions that hold no more than white noise would, then shrink wavelet coefficients.

    The functions are the means over many decompositions of the signal with noise added, in pairs of opposite sign, so
    that they add up to the signal. A function is noise where its energy exceeds over no 32 of its mean periods what
    white noise leaves in a function of that period. The same seed gives the same bits.

    Args:
        signals: (n_channels, N).
        fs: sampling rate, Hz.
        seed: of the added noise.
        trials: decompositions per channel, even; they are nearly all of the time this takes.
        noise_share: rms of the added noise in multiples of the channel's.

    Raises:
        InputError: as ``denoise_wavelet``, an odd number of trials, or the package EMD-signal is missing.

    Source: Z. Wu, N. E. Huang, Proc. R. Soc. A 460 (2004) 1597, energy times period of white noise is constant and the
    energy chi-squared distributed, and Adv. Adapt. Data Anal. 1 (2009) 1; pairs: J.-R. Yeh, J.-S. Shieh, N. E. Huang,
    the same 2 (2010) 135.
    """
    _check(signals)
    if trials < 2 or trials % 2:
        raise InputError(
            f"{trials} trials", "trials come in pairs of opposite noise", f"use {trials + trials % 2 or 2}"
        )
    noise = noise_rms(signals)
    kept = signals.copy()
    what = []
    for i, channel in enumerate(signals):
        functions = _functions(channel, np.random.default_rng([seed, i]), trials // 2, noise_share)
        chosen = [k for k, function in enumerate(functions) if _is_noise(function, k, float(noise[i]))]
        kept[i] -= functions[chosen].sum(axis=0)
        names = ", ".join(f"{k + 1} (about {fs / _period(functions[k]):.3g} Hz)" for k in chosen) or "none"
        what.append(
            f"channel {i}: intrinsic mode functions taken for noise: {names}; a function is noise where no part of the"
            f" record holds more of it than white noise of rms {noise[i]:.3g} leaves"
        )
    shrunk, levels = _shrunk(kept, fs, noise)
    return _denoised(signals, shrunk, (*what, *levels))


def noise_rms(signals: FloatArray) -> FloatArray:
    """(n_channels,) rms of white noise, from the median magnitude of the finest wavelet level.

    Args:
        signals: (n_channels, N) whose modes lie below a quarter of the sampling rate.

    Source: Donoho and Johnstone (1994).
    """
    finest = pywt.dwt(signals, WAVELET, axis=-1)[1]
    return np.asarray(np.median(np.abs(finest), axis=-1) / MEDIAN_OF_NORMAL)


def _shrunk(signals: FloatArray, fs: float, noise: FloatArray) -> tuple[FloatArray, tuple[str, ...]]:
    n = signals.shape[-1]
    depth = max(int(np.log2(n / LEAST_COEFFICIENTS)), 1)
    coarse, *details = pywt.wavedec(signals, WAVELET, level=depth, axis=-1)
    what = ["white noise of rms " + _range(noise) + ", from the median of the finest wavelet level"]
    shrunk = [coarse]
    for level, detail in zip(range(depth, 0, -1), details, strict=True):
        power = np.mean(detail**2, axis=-1)
        signal = np.sqrt(np.maximum(power - noise**2, 0.0))
        largest = np.abs(detail).max(axis=-1)
        threshold = np.divide(noise**2, signal, out=largest.copy(), where=signal * largest > noise**2)
        limit = threshold[:, None]
        shrunk.append(detail - np.divide(limit**2, detail, out=detail.copy(), where=np.abs(detail) > limit))
        left = np.mean(shrunk[-1] ** 2, axis=-1) / np.maximum(power, np.finfo(float).tiny)
        done = f"threshold {_range(threshold)}, {_range(100.0 * (1.0 - left))} % of the power removed"
        band = f"{fs / 2 ** (level + 1):.4g} to {fs / 2**level:.4g} Hz"
        what.append(f"{band}: {done if np.any(left) else 'nothing above the noise, all removed'}")
    return np.asarray(pywt.waverec(shrunk, WAVELET, axis=-1)[..., :n]), tuple(what)


def _functions(channel: FloatArray, rng: np.random.Generator, pairs: int, noise_share: float) -> FloatArray:
    """(n_functions, N) intrinsic mode functions, the fastest first; the last holds the rest."""
    decomposition = _decomposition()
    scale = float(np.std(channel))
    total = np.zeros((MOST_FUNCTIONS + 1, channel.size))
    if scale == 0.0:
        return total
    for added in _pairs(rng, pairs, channel.size):
        functions = decomposition.emd(channel / scale + noise_share * added, max_imf=MOST_FUNCTIONS)
        total[: len(functions)] += functions
    return total * (scale / (2 * pairs))


def _pairs(rng: np.random.Generator, pairs: int, size: int) -> Iterator[FloatArray]:
    for _ in range(pairs):
        added = rng.standard_normal(size)
        yield added
        yield -added


def _decomposition() -> Any:
    try:
        from PyEMD import EMD
    except ImportError:
        raise InputError(
            "an ensemble of empirical mode decompositions was asked for",
            "it needs the package EMD-signal",
            "run make once, which installs it, or use the wavelet thresholds alone",
        ) from None
    return EMD(FIXE=SIFTS)


def _is_noise(function: FloatArray, order: int, noise: float) -> bool:
    """Whether no block holds more than white noise leaves in a function of this mean period."""
    if order == MOST_FUNCTIONS or noise == 0.0 or not np.any(function):
        return False
    share = (WHITE_FIRST if order == 0 else WHITE) / _period(function)
    blocks = np.array_split(function, max(round(function.size / (BLOCK_PERIODS * _period(function))), 1))
    freedom = max(blocks[0].size * share, 1.0)
    limit = noise**2 * share / freedom * float(chi2.isf(FALSE_ALARM / (len(blocks) * MOST_FUNCTIONS), freedom))
    return max(float(np.mean(block**2)) for block in blocks) <= limit


def _period(function: FloatArray) -> float:
    """Samples per period, from the sign changes."""
    return 2.0 * function.size / max(int(np.count_nonzero(np.diff(np.signbit(function)))), 1)


def _denoised(signals: FloatArray, kept: FloatArray, what: tuple[str, ...]) -> Denoised:
    removed = np.sqrt(np.mean((signals - kept) ** 2, axis=-1))
    power = np.maximum(np.mean(signals**2, axis=-1), np.finfo(float).tiny)
    return Denoised(kept, removed, removed**2 / power, what)


def _range(values: FloatArray) -> str:
    low, high = f"{values.min():.3g}", f"{values.max():.3g}"
    return low if low == high else f"{low} to {high}"


def _check(signals: FloatArray) -> None:
    if signals.ndim != 2 or signals.shape[-1] < 2 * LEAST_COEFFICIENTS or not np.all(np.isfinite(signals)):
        raise InputError(
            f"signals of size {signals.shape}",
            f"they are (n_channels, N) finite samples, N {2 * LEAST_COEFFICIENTS} or more",
            "pass one row per channel and a longer record",
        )
