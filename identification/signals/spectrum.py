"""The spectrum of a free decay summed over its channels, each over its own noise floor, and the level chance reaches.

The record is weighed by the falling half of a Hann window: it begins where the decay begins, so that strongly damped
modes count in full, and it ends smoothly, so that a decay cut off at the record's end has no sidelobes. Without a mode
the sum over channels is Gamma distributed; its shape, that is, how many channels have noise of their own, comes from
the spread of the lines, for channels share noise.

Source: S. M. Kay, Fundamentals of Statistical Signal Processing II: Detection Theory (1998), ch. 7; F. J. Harris, Proc.
IEEE 66 (1978) 51, for the window.
"""

from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len, rfft
from scipy.optimize import brentq
from scipy.signal import detrend
from scipy.special import gammaincc, gammaincinv

from models.arrays import FloatArray

PADDING = 2
"""Lines per line of the record's length, so that a peak between two lines keeps its height."""

FLOOR_WIDTH = 2.0
"""Highest over lowest frequency of the window whose median is the floor: what is broader is no mode."""

FLOOR_LINES = 64
"""Lines to each side in that window at least: with them one channel of noise keeps to its false-alarm rate."""

LOWEST_LINE = 4
"""The lines below it hold what is left of the mean and the drift."""

FLOORS_PER_OCTAVE = 8

SPREAD = (0.25, 0.75)
"""Quantiles of the summed power whose ratio tells the shape of its distribution."""

LEAST_SHAPE = 0.3

ROUNDING = 1e-30
"""Share of the highest power that rounding leaves."""


@dataclass(frozen=True, eq=False)
class SummedSpectrum:
    """Power of a record's channels, each over its own floor, averaged over the channels.

    Attributes:
        frequency: (n_lines,) Hz.
        power: (n_lines,) 1, multiples of the floor.
        floor: (n_channels, n_lines) the channels' floors, in their unit squared per Hz.
        threshold: 1, the power that noise alone exceeds on some line with the false-alarm probability asked for.
        shape: 1, how many channels with noise of their own the lines' spread tells.
        resolution: Hz, one over the length of the record.
    """

    frequency: FloatArray
    power: FloatArray
    floor: FloatArray
    threshold: float
    shape: float
    resolution: float

    @property
    def step(self) -> float:
        """Hz between lines."""
        return self.resolution / PADDING

    def false_alarm(self, power: float) -> float:
        """Chance that noise alone exceeds this power on some line."""
        return min(self.frequency.size * float(gammaincc(self.shape, self.shape * power)), 1.0)


def summed_spectrum(signals: FloatArray, fs: float, band: tuple[float, float], false_alarm: float) -> SummedSpectrum:
    """Sum the channels' spectra, each over its own noise floor.

    Args:
        signals: (n_channels, N) no channel constant; means and straight drifts are taken out.
        fs: sampling rate, Hz.
        band: Hz, its lowest and highest line.
        false_alarm: probability that noise alone exceeds the threshold on some line.

    Source: Kay (1998), ch. 7, the summed periodogram.
    """
    n = signals.shape[1]
    size = PADDING * next_fast_len(n, real=True)
    window = np.cos(0.5 * np.pi * np.arange(n) / n) ** 2
    level = detrend(signals, axis=1)
    level -= (level @ window / window.sum())[:, None]
    power = np.abs(rfft(level * window, size)) ** 2 * (2.0 / (fs * np.sum(window**2)))
    frequency = np.arange(size // 2 + 1) * fs / size
    around = slice(LOWEST_LINE, int(np.searchsorted(frequency, FLOOR_WIDTH * band[1])))
    frequency, power = frequency[around], power[:, around]
    power = np.maximum(power, ROUNDING * power.max(axis=1, keepdims=True))
    inside = (frequency >= band[0]) & (frequency <= band[1])
    floor = np.stack([_floor(frequency, row) for row in power])[:, inside]
    frequency, power = frequency[inside], power[:, inside]
    mean = np.mean(power / floor, axis=0)
    shape = _shape(mean, len(signals))
    scale = float(np.median(mean) * shape / gammaincinv(shape, 0.5))  # from medians to means of the noise
    threshold = float(gammaincinv(shape, 1.0 - false_alarm / frequency.size)) / shape
    return SummedSpectrum(frequency, mean / scale, floor * scale, threshold, shape, PADDING * fs / size)


def _floor(frequency: FloatArray, power: FloatArray) -> FloatArray:
    """Running median of the logarithm over an octave, its slope from the medians of the octave's two halves."""
    x, y = np.log(frequency), np.log(power)
    n = x.size
    steps = max(round(FLOORS_PER_OCTAVE * np.log2(frequency[-1] / frequency[0])), 1)
    step = (frequency[-1] - frequency[0]) / (n - 1)
    centres = np.round((np.geomspace(frequency[0], frequency[-1], steps + 1) - frequency[0]) / step).astype(int)
    centres = np.unique(np.clip(centres, 0, n - 1))
    half = 0.5 * frequency[centres] / step * (FLOOR_WIDTH**0.5 - FLOOR_WIDTH**-0.5)
    half = np.maximum(half, FLOOR_LINES).astype(int)
    first = np.clip(centres - half, 0, max(n - 2 * FLOOR_LINES, 0))
    last = np.clip(centres + half, min(2 * FLOOR_LINES, n), n)
    values = [_at(c, x[i:j], y[i:j]) for c, i, j in zip(x[centres], first, last, strict=True)]
    return np.asarray(np.exp(np.interp(x, x[centres], values)))


def _at(centre: float, x: FloatArray, y: FloatArray) -> float:
    """The value at the centre of the line through the medians of the window's lower and upper half."""
    middle = x.size // 2
    low, high = float(np.mean(x[:middle])), float(np.mean(x[middle:]))
    below, above = float(np.median(y[:middle])), float(np.median(y[middle:]))
    return below + (above - below) * (centre - low) / (high - low)


def _shape(mean: FloatArray, n_channels: int) -> float:
    """The shape of the Gamma distribution with the lines' spread, the number of channels at most."""
    low, high = np.quantile(mean, SPREAD)

    def excess(shape: float) -> float:
        return float(np.log(gammaincinv(shape, SPREAD[1]) / gammaincinv(shape, SPREAD[0])) - np.log(high / low))

    if excess(n_channels) >= 0.0:
        return float(n_channels)
    return float(brentq(excess, LEAST_SHAPE, n_channels)) if excess(LEAST_SHAPE) > 0.0 else LEAST_SHAPE
