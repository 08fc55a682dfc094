"""The scale of a wavelet ridge for a mode whose course and noise are already known from the smoother.

A longer window lets less noise through and blurs more. Both are known beforehand, so the scale is chosen from the data
and without a training signal.
"""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from models.arrays import FloatArray

CENTRE_FREQUENCIES = 2.0 ** np.arange(2.25, 7.1, 0.25)
"""Among which the scale is chosen: omega_0 = a omega / fs from 4.8 to 128 radians."""

POINTS = 4096
"""Of the course that are blurred at least; direct sums over every sample would take most of an identification."""

REACH = 6.0
"""Standard deviations of the window on either side that the record has to hold."""


def noise_of_rate(scale: float, fs: float, noise_share: FloatArray) -> FloatArray:
    """(n,) standard deviation of a Morlet ridge's decay rate away from the ends, 1/s.

    The ridge weighs the signal with g = tau w / sum(tau^2 w); the deviation is sqrt(2 sum g^2) times noise over
    amplitude, with sums taken as integrals.

    Args:
        scale: samples.
        fs: Hz.
        noise_share: (n,) standard deviation of the noise over the amplitude.
    """
    return np.asarray(noise_share * fs * np.sqrt(0.5 / (np.sqrt(np.pi) * scale**3)))


def own_scale(fs: float, frequency: float, rate: FloatArray, noise_share: FloatArray) -> float:
    """The scale in samples that follows a known course best.

    Args:
        fs: Hz.
        frequency: of the mode, Hz.
        rate: (N,) decay rate at every sample, 1/s.
        noise_share: (N,) standard deviation of the noise over the amplitude.
    """
    scales = CENTRE_FREQUENCIES * fs / (2.0 * np.pi * frequency)
    fitting = scales[scales * 2.0 * REACH < len(rate)]
    if not len(fitting):
        return max(min(float(scales[0]), len(rate) / (2.0 * REACH)), 1.0)
    step = max(len(rate) // POINTS, 1)
    coarse = rate[::step]
    blur = [np.mean((gaussian_filter1d(coarse, scale / step, mode="nearest") - coarse) ** 2) for scale in fitting]
    noise = [np.mean(noise_of_rate(scale, fs, noise_share) ** 2) for scale in fitting]
    return float(fitting[int(np.argmin(np.add(blur, noise)))])
