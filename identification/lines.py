"""Single lines that a model leaves in the records: a hum, a floor that shakes at one frequency."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter

from identification.evaluate import Evaluator, TimeTarget
from identification.hypothesis import Hypothesis
from identification.period import find_period
from models.arrays import BoolArray, FloatArray
from models.band_limit import SCORE_EDGE

PADDED = 4
"""How much finer than a record's own lines frequencies are read."""

NEIGHBOURS = 40
"""Lines of the padded spectrum among which a single one is to stand out."""

NEIGHBOURS_DRIVEN = 17
"""Lines of the excitation among which one is to stand out to be more than that."""

STANDS_OUT = 25.0
"""Power over the neighbours' median; in noise of two channels one line in ten thousand does."""

MOST = 4


@dataclass(frozen=True)
class Lines:
    """Frequencies, Hz, of single lines, the one that stands out most first.

    Attributes:
        free: that the excitation does not hold.
        driven: on lines of an excitation that repeats: a model with wrong numbers leaves them all.
    """

    free: tuple[float, ...] = ()
    driven: tuple[float, ...] = ()


def lines_left(evaluator: Evaluator, hypothesis: Hypothesis) -> Lines:
    """The lines that stand out most in what a model leaves of the longest record.

    Args:
        evaluator: with the records.
        hypothesis: the model.
    """
    if not evaluator.timed:
        return Lines()
    target = max(evaluator.timed, key=lambda each: each.record.duration)
    (response,) = evaluator.with_targets([target]).responses(hypothesis)
    power, spacing = _power(target, response.channels[:, : target.record.n_samples] - target.record.responses)
    excess = power / np.maximum(median_filter(power, NEIGHBOURS), np.finfo(float).tiny)
    peaks = 1 + np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]) & (excess[1:-1] > STANDS_OUT))
    frequencies = spacing * np.array([_between(power, k) for k in peaks.tolist()])
    frequencies = frequencies[np.argsort(-excess[peaks])]
    driven = _is_driven(target, frequencies, power)
    free, held = (tuple(part[:MOST].tolist()) for part in (frequencies[~driven], frequencies[driven]))
    return Lines(free, held)


def _power(target: TimeTarget, residual: FloatArray) -> tuple[FloatArray, float]:
    """Power of the residual over all channels in units of their noise, and the distance of its lines, Hz."""
    n, fs = target.record.n_samples, target.record.fs
    window = np.hanning(n)
    sigma = np.maximum(target.noise.sensors, np.finfo(float).tiny)[:, None]
    spectrum = np.fft.rfft((residual - residual.mean(axis=1, keepdims=True)) / sigma * window, PADDED * n)
    power = np.sum(np.abs(spectrum) ** 2, axis=0)
    return np.asarray(power[: int(SCORE_EDGE * PADDED * n)]), fs / (PADDED * n)


def _between(power: FloatArray, k: int) -> float:
    """Where a parabola through the logarithms about line k is highest."""
    low, mid, high = np.log(power[k - 1 : k + 2])
    return float(k + 0.5 * (low - high) / (low - 2.0 * mid + high))


def _is_driven(target: TimeTarget, frequencies: FloatArray, power: FloatArray) -> BoolArray:
    """Whether a frequency lies on a line of an excitation that repeats, and is no more than such lines are there."""
    excitation = target.record.excitation
    period = None if excitation is None else find_period(excitation)
    if period is None:
        return np.zeros(len(frequencies), bool)
    step = PADDED * target.record.n_samples / period
    at = np.round(np.arange(int(len(power) / step)) * step).astype(int)
    held = maximum_filter1d(power, PADDED + 1)[at]
    usual = median_filter(held, NEIGHBOURS_DRIVEN)
    lines = frequencies * period / target.record.fs
    nearest = np.minimum(np.round(lines).astype(int), len(at) - 1)
    away = np.abs(lines - nearest) * target.record.n_samples / period
    return np.asarray((away < 0.5) & (held[nearest] < STANDS_OUT * usual[nearest]))
