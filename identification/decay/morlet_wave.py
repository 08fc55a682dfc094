"""Damping from two Morlet waves of finite length that end with the record: the other way to treat its edges.

A wave of k periods, T = 2 pi k / omega long, and of time spread n has the envelope exp(-t^2 / (2 s^2)) about its middle
with s = sqrt(2) T / n. Weighed with it, exp(-xi omega t) has the mean exp((xi omega)^2 v / 2) to the third order in xi,
v being the envelope's variance. So two spreads n_1 < n_2 give the damping ratio in closed form,

    xi = sqrt(2 ln(|I_1| / |I_2|) / (v_1 - v_2)) / omega.

For waves without ends v = s^2, and this is the published n_1 n_2 / (2 pi k) sqrt(ln(...) / (n_2^2 - n_1^2)); here v is
the variance of the wave as it is cut. The logarithm is of second order in xi: a light damping drowns unless k is large.
"""

import numpy as np
from scipy.signal import oaconvolve

from models.arrays import FloatArray
from models.errors import InputError

SPREADS = (10.0, 20.0)
"""n_1 and n_2."""


def morlet_wave_damping(
    signal: FloatArray, fs: float, frequency: float, periods: int, spreads: tuple[float, float] = SPREADS
) -> FloatArray:
    """Damping ratio over time, held from where a wave reaches an end of the record.

    Args:
        signal: (N,) of one mode.
        fs: sampling rate, Hz.
        frequency: of the mode, Hz.
        periods: k, length of the waves.
        spreads: n_1 < n_2.

    Raises:
        InputError: waves longer than the record.

    Returns:
        (N,), 0 where noise makes the longer wave's mean the smaller one.

    Source: Slavic and Boltezar, Mech. Syst. Signal Process. 25 (2011) 1632.
    """
    half = round(0.5 * periods * fs / frequency)
    if 2 * half + 1 > len(signal):
        raise InputError(
            f"waves of {periods} periods, {periods / frequency:g} s, in a record of {len(signal) / fs:g} s",
            "a wave lies within the record",
            f"ask for {int(len(signal) * frequency / fs) - 1} periods or fewer",
        )
    t = np.arange(-half, half + 1) / fs
    omega = 2.0 * np.pi * frequency
    means, variances = [], []
    for spread in spreads:
        weight = np.exp(-0.5 * (t * frequency * spread / (np.sqrt(2.0) * periods)) ** 2)
        weight /= weight.sum()
        means.append(np.abs(oaconvolve(signal, weight * np.exp(1j * omega * t), mode="valid")))
        variances.append(float(weight @ t**2))
    excess = np.maximum(np.log(means[0] / means[1]), 0.0)
    return np.pad(np.sqrt(2.0 * excess / (variances[0] - variances[1])) / omega, half, mode="edge")
