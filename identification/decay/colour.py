"""How dense a decay's noise is about a mode, against noise that is white up to half the sampling rate.

A recorder's low-pass leaves nothing above its edge, so below it the density is higher than the noise's variance says.
"""

import numpy as np

from models.arrays import ComplexArray, FloatArray

AROUND = (1.6, 3.0, 9.0)
"""Lines within the first of these factors of a mode's frequency that holds enough of them are looked at."""

LEAST_LINES = 100
MODEST = 0.05
"""Lines this close to a mode, as a share of its frequency, may hold what its fit left, and are not looked at."""

LN_2 = float(np.log(2.0))


def left_over(signals: FloatArray, waves: ComplexArray) -> FloatArray:
    """(n_channels, N) what is left of signals beside modes of known paths and free complex amplitudes.

    Args:
        signals: (n_channels, N).
        waves: (n_modes, N) complex.
    """
    basis = np.concatenate([waves.real, -waves.imag])
    numbers = np.linalg.lstsq(basis @ basis.T, basis @ signals.T, rcond=None)[0]
    return np.asarray(signals - numbers.T @ basis)


def noise_colour(residual: FloatArray, fs: float, freqs: FloatArray) -> FloatArray:
    """(n_modes,) density of the noise about each mode over that of white noise of the same variance.

    The median of the periodogram's lines over ln 2 is their mean for noise, whatever a few lines hold.

    Args:
        residual: (n_channels, N).
        fs: Hz.
        freqs: (n_modes,) Hz.
    """
    n = residual.shape[1]
    power = np.abs(np.fft.rfft(residual, axis=1)) ** 2 / n
    lines = np.fft.rfftfreq(n, 1.0 / fs)
    density = power / np.maximum(np.mean(residual**2, axis=1, keepdims=True), np.finfo(float).tiny)
    near = (np.abs(lines[:, None] / freqs - 1.0) < MODEST).any(axis=1)
    colours = np.ones(len(freqs))
    for mode, freq in enumerate(freqs):
        for factor in AROUND:
            around = np.flatnonzero((lines > freq / factor) & (lines < freq * factor) & ~near)
            if len(around) * len(residual) >= LEAST_LINES:
                colours[mode] = np.median(density[:, around]) / LN_2
                break
    return colours
