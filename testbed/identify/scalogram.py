"""The Morlet transform of one mode as it is drawn, with its crest as far as that stands out of the noise."""

import numpy as np

from identification.decay.identify import ModeInDecay
from identification.decay.ridge import find_ridge
from identification.decay.wavelet import morlet_transform, noise_of_amplitude, scale_of
from models.arrays import ComplexArray, FloatArray
from testbed.figures.identify import LOWEST_LEVEL, Scalogram

SHOWN_FREQUENCIES, SHOWN_TIMES = 96, 600
"""Lines and columns of a scalogram that is drawn."""

SHOWN_BAND = 0.35
"""Half-width of a scalogram about its mode, as a share of its frequency."""

HIGHEST_SHOWN = 0.49
"""Share of the sampling rate."""

STANDS_OUT = 3.0
"""Times the noise's rms in the map, which noise alone exceeds once in 8,000."""


def scalogram_of(mode: ModeInDecay, fs: float) -> Scalogram:
    """The transform of one mode's signal about its frequency, in as many columns as are drawn.

    Args:
        mode: in one decay.
        fs: Hz.
    """
    around = mode.natural_freq * np.linspace(1.0 - SHOWN_BAND, 1.0 + SHOWN_BAND, SHOWN_FREQUENCIES)
    frequencies = around[around < HIGHEST_SHOWN * fs]
    step = max(len(mode.signal) // SHOWN_TIMES, 1)
    shown = morlet_transform(mode.signal, fs, frequencies)[:, ::step]
    noise = noise_of_amplitude(scale_of(frequencies, fs), noise_beside(mode, fs))
    return Scalogram(mode.skeleton.time[::step], frequencies, shown, crest_of(shown, frequencies, noise))


def noise_beside(mode: ModeInDecay, fs: float) -> float:
    """Standard deviation of a sample of the noise beside a mode, in the unit of its signal.

    Args:
        mode: in one decay.
        fs: Hz.
    """
    blocks = mode.smoothed.blocks
    shares = np.sqrt(0.5 * blocks.variances * np.diff(blocks.edges) * fs)
    return float(np.median((np.exp(mode.watched_decay.log_amplitude) * shares)[blocks.clear]))


def crest_of(scalogram: ComplexArray, frequencies: FloatArray, noise: FloatArray) -> FloatArray:
    """(n,) Hz, the strongest path through a map until it first sinks into the noise or to the darkest shade, then nan.

    Args:
        scalogram: (n_freq, n) complex amplitudes.
        frequencies: (n_freq,) Hz.
        noise: (n_freq,) rms of what noise adds to an amplitude.
    """
    crest = find_ridge(scalogram, frequencies)
    lines = np.abs(frequencies[:, None] - crest).argmin(axis=0)
    level = np.abs(scalogram)
    least = np.maximum(STANDS_OUT * noise[lines], 10.0 ** (LOWEST_LEVEL / 20.0) * level.max())
    sunk = level[lines, np.arange(len(crest))] < least
    return np.where(np.logical_or.accumulate(sunk), np.nan, crest)
