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

UNLIKELY = 5.0
"""Three deviations of the logarithm of a median of so many exponential numbers, times the root of their number."""

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


def ringing_colour(residual: FloatArray, fs: float, poles: ComplexArray) -> FloatArray:
    """(n_modes,) density of what is left about each mode while it rings, over that of white noise of equal variance.

    What modes that are missing or an impact leave ends with the decay; over a long record its variance is small, and
    its weight on a pole is not. So the residual is weighed as the pole's error weighs it. 1 where this differs from the
    noise of the whole record by no more than chance.

    Args:
        residual: (n_channels, N).
        fs: Hz.
        poles: (n_modes,) 1/s.

    Source: the middle of the sandwich of White, Econometrica 50 (1982) 1, smoothed over neighbouring frequencies.
    """
    n = residual.shape[1]
    time, lines = np.arange(n) / fs, np.fft.rfftfreq(n, 1.0 / fs)
    variance = np.maximum(np.mean(residual**2, axis=1, keepdims=True), np.finfo(float).tiny)
    freqs, colours = np.abs(poles) / (2.0 * np.pi), np.ones(len(poles))
    for mode, pole in enumerate(poles):
        envelope = np.exp(np.minimum(pole.real, 0.0) * time)
        weights = envelope * (time - float(np.average(time, weights=envelope**2)))
        away = max(MODEST, -pole.real / abs(pole))
        distance = np.abs(lines / freqs[mode] - 1.0)
        around = (distance > away) & (lines > freqs[mode] / AROUND[0]) & (lines < freqs[mode] * AROUND[0])
        width = max(2.0 * away * freqs[mode], fs / n)
        told = len(residual) * max(np.count_nonzero(around) * fs / n / width, 1.0)
        if not around.any():
            continue
        power = np.abs(np.fft.rfft(residual * weights, axis=1)[:, around]) ** 2
        density = float(np.median(power / variance)) / (LN_2 * float(np.sum(weights**2)))
        if np.log(max(density, 1.0)) > UNLIKELY / np.sqrt(told):
            colours[mode] = density
    return colours
