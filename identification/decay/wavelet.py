"""The complex Morlet transform of channels at many frequencies, scaled so that its modulus is an amplitude.

psi(t) = exp(-t^2 / 2) exp(j omega_0 t), and, with the scale a in samples and the time t in samples,

    W(a, b) = 2 / (a sqrt(2 pi)) sum_t x(t) conj psi((t - b) / a),

so that x = A cos(omega t + phi) gives W = A exp(j (omega b + phi)) at a = omega_0 / omega, to exp(-2 omega_0^2). The
article's eqs. (19) to (24) carry the factor 1 / (2 a) into W, and lose the sqrt(2 pi) of psi's spectrum on the way to
A = 2 |W| / a; with their own definition of W it is A = 2 |W| / sqrt(2 pi). Here no factor is left to the reader.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from scipy.fft import rfft

from identification.decay.ends import continued
from identification.decay.narrow_band import (
    Tables,
    inverse_of_band,
    n_samples,
    tables,
    transform_length,
    workspace,
)
from models.arrays import ComplexArray, FloatArray
from models.errors import InputError

CENTRE_FREQUENCY = 6.0
"""omega_0: radians of the wave within one standard deviation of its envelope."""

LEAST_CENTRE_FREQUENCY = 3.0
"""omega_0 below which the wave is no longer one: it answers to an offset with exp(-omega_0^2 / 2) = 1 % and more."""

REACH = float(np.sqrt(-2.0 * np.log(np.finfo(float).eps)))
"""Standard deviations, in time as in frequency, beyond which a Gaussian is below round-off."""

WORKERS = 2
"""Threads."""


def scale_of(frequency: FloatArray, fs: float, centre_frequency: float = CENTRE_FREQUENCY) -> FloatArray:
    """Scales in samples whose waves have these frequencies, a = omega_0 fs / (2 pi f).

    Args:
        frequency: (...) Hz.
        fs: sampling rate, Hz.
        centre_frequency: omega_0.
    """
    return np.asarray(centre_frequency * fs / (2.0 * np.pi * frequency))


def noise_of_amplitude(scale: FloatArray, noise: float) -> FloatArray:
    """(n,) root of the mean square of what white noise adds to |W|, sums taken as integrals: 2 s^2 / (a sqrt(pi)).

    Args:
        scale: (n,) samples.
        noise: standard deviation of a sample, in the signal's unit.
    """
    return np.asarray(noise * np.sqrt(2.0 / (np.sqrt(np.pi) * scale)))


def morlet_transform(
    signals: FloatArray,
    fs: float,
    frequencies: FloatArray,
    centre_frequency: float = CENTRE_FREQUENCY,
    ends: str = "predicted",
) -> ComplexArray:
    """Complex amplitudes over frequency and time.

    Args:
        signals: (..., N) channels of one record.
        fs: sampling rate, Hz.
        frequencies: (n_freq,) Hz, of the waves.
        centre_frequency: omega_0; a wave's envelope has a standard deviation of omega_0 / (2 pi) periods.
        ends: what is taken for the signal beyond its ends, a name in ``ends.ENDS``.

    Raises:
        InputError: a frequency outside (0, fs / 2), a centre frequency below ``LEAST_CENTRE_FREQUENCY``, samples that
            are not finite, or an unknown name of ends.

    Returns:
        (..., n_freq, N) in the signals' unit.

    Source: Grossmann and Morlet, SIAM J. Math. Anal. 15 (1984) 723.
    """
    _check(signals, fs, frequencies, centre_frequency)
    n_signal = signals.shape[-1]
    scales = scale_of(frequencies, fs, centre_frequency)
    reach = int(np.ceil(REACH * scales.max()))
    before, after = continued(signals, reach, ends)
    # On the circle of the transform, what precedes the record also follows its continuation; zeros are needed once.
    n = n_samples(n_signal + (reach if ends == "zero" else 2 * reach))
    whole = np.zeros((*signals.shape[:-1], n))
    whole[..., :n_signal], whole[..., n_signal : n_signal + reach], whole[..., n - reach :] = signals, after, before
    spectra = rfft(whole, workers=WORKERS).reshape(-1, n // 2 + 1)
    bands = [_band_of(scale, n, centre_frequency) for scale in scales]
    by = {length: tables(n, length) for length in {band.length for band in bands}}
    out = np.empty((len(spectra), len(bands), n_signal), dtype=complex)
    with ThreadPoolExecutor(WORKERS) as pool:
        parts = [range(i, len(spectra) * len(bands), WORKERS) for i in range(WORKERS)]
        for job in [pool.submit(_fill, out, spectra, bands, by, part) for part in parts]:
            job.result()
    return out.reshape(*signals.shape[:-1], len(bands), n_signal)


class _Band(NamedTuple):
    """The bins where one wave's spectrum is above round-off, its values there, and the transform that suits it."""

    first: int
    gains: FloatArray
    length: int


def _band_of(scale: float, n: int, centre_frequency: float) -> _Band:
    step = 2.0 * np.pi * scale / n
    first, last = np.ceil((centre_frequency - REACH) / step), np.floor((centre_frequency + REACH) / step)
    offsets = step * np.arange(first, last + 1.0) - centre_frequency
    return _Band(int(first), 2.0 / n * np.exp(-0.5 * offsets**2), transform_length(n, len(offsets)))


def _fill(out: ComplexArray, spectra: ComplexArray, bands: list[_Band], by: dict[int, Tables], rows: range) -> None:
    """The rows of ``out``, counted over channels and bands, one after the other in one workspace."""
    work = workspace(2 * (spectra.shape[1] - 1))
    for row in rows:
        channel, number = divmod(row, len(bands))
        band = bands[number]
        inverse_of_band(spectra[channel], band.gains, band.first, by[band.length], work, out[channel, number])


def _check(signals: FloatArray, fs: float, frequencies: FloatArray, centre_frequency: float) -> None:
    if not np.isfinite(signals).all():
        raise InputError(
            f"{np.count_nonzero(~np.isfinite(signals))} samples that are not finite",
            "one of them spoils every number of a transform",
            "cut the record before the first, or after the last",
        )
    outside = frequencies[~((frequencies > 0.0) & (frequencies < 0.5 * fs))]
    if frequencies.ndim != 1 or frequencies.size == 0 or outside.size:
        worst = f"{outside[0]:g} Hz" if outside.size else f"frequencies of size {frequencies.shape}"
        raise InputError(
            f"{worst} at a sampling rate of {fs:g} Hz",
            f"a wave's frequency lies between 0 and {0.5 * fs:g} Hz",
            "pass (n_freq,) frequencies within the record's band",
        )
    if not centre_frequency >= LEAST_CENTRE_FREQUENCY:
        raise InputError(
            f"a centre frequency of {centre_frequency:g}",
            f"a Morlet wave has omega_0 = {LEAST_CENTRE_FREQUENCY:g} or more",
            f"ask for {CENTRE_FREQUENCY:g}, or for more where modes lie close",
        )
