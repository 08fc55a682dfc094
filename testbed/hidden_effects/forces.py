"""What drives the rigs: multisines with random or Schroeder's phases, and a hammer."""

from math import pi

import numpy as np

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.excitations import Lines, half_sine_hammer, random_phase_multisine
from testbed.hidden_effects.sets import Wave

LOW = 5.0
"""Hz, lower end of the excited band."""

BLOW_AT = 0.1
"""s from the record's start."""

DECAY_SECONDS = 8.0


def draw_multisine(wave: Wave, fs: float, top: float, rng: np.random.Generator) -> FloatArray:
    """(N,) a multisine of rms 1.

    Args:
        wave: what it is.
        fs: Hz.
        top: upper end of the band, Hz.
        rng: draws phases.
    """
    n_periods = round(wave.duration / wave.period)
    period = round(wave.period * fs)
    if wave.phases == "random":
        return random_phase_multisine(rng, fs, period * n_periods, n_periods, LOW, top, 1.0, wave.lines)
    return np.tile(schroeder_multisine(fs, period, LOW, top, wave.lines, rng), n_periods)


def schroeder_multisine(
    fs: float, period: int, low: float, high: float, lines: Lines, rng: np.random.Generator
) -> FloatArray:
    """(period,) a sum of equal sines whose phases -pi k (k - 1) / K keep its crest low, of rms 1.

    It runs up or down the band, and begins where it passes 0 straight.

    Args:
        fs: Hz.
        period: samples.
        low: lower end of the band, Hz.
        high: upper end, Hz.
        lines: all of the spectrum, or the odd ones only.
        rng: draws the direction.

    Source: M. R. Schroeder, IEEE Trans. Inf. Theory 16 (1970) 85, eq. (11).
    """
    freq = np.arange(period // 2 + 1) * fs / period
    excited = np.flatnonzero((freq >= low) & (freq <= high))
    if lines != "full":
        excited = excited[excited % 2 == 1]
    k = np.arange(1, len(excited) + 1)
    phases = -pi * k * (k - 1) / len(k) * (1.0 if rng.random() < 0.5 else -1.0)
    spectrum = np.zeros(len(freq), complex)
    spectrum[excited] = np.exp(1j * phases)
    wave = np.fft.irfft(spectrum, period)
    bend = np.roll(wave, 1) - 2.0 * wave + np.roll(wave, -1)
    wave = np.roll(wave, -int(np.argmin(wave**2 + bend**2)))
    return np.asarray(wave / np.sqrt(np.mean(wave**2)))


def draw_blow(fs: float, width: float) -> FloatArray:
    """(N,) one blow of a hammer with a peak of about 1, and what follows; band-limited like any true force.

    Args:
        fs: Hz.
        width: of the blow, s.
    """
    blow = half_sine_hammer(fs, round(DECAY_SECONDS * fs), BLOW_AT, width, 1.0)
    return np.asarray(record_channels(blow[None], 1, len(blow), fs)[0])
