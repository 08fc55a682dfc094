"""Where, in frequency and in time, a model misses a record."""

import numpy as np
from scipy import fft

from identification.evaluate import scored_spectrum
from identification.result import ErrorMap, RecordScore
from models.arrays import AnyArray, FloatArray, IntArray

BANDS = 24
"""Bands of equal ratio, about third octaves where the excitation spans three decades."""

WINDOWS = 40
"""Windows of equal length."""

QUIET_SHARE = 1e-3
"""Share of the power below which the first band holds everything: the excitation has not begun there."""


def error_map(score: RecordScore) -> ErrorMap:
    """Map one record's error over sensors and frequency bands, and over sensors and time windows.

    The squares of a channel's bands sum to the square of its nrmse; so do the mean squares of its windows.

    Args:
        score: the record, what the model says, and the noise.

    Source: Parseval's theorem; third-octave bands as in IEC 61260-1:2014 where the range allows.
    """
    record, n = score.record, score.record.n_samples
    measured = scored_spectrum(record.responses)
    error = scored_spectrum(score.predicted) - measured
    rms = np.sqrt(np.sum(_power(measured), axis=1, keepdims=True))
    drive = _power(measured).sum(axis=0) if record.excitation is None else _drive_power(record.excitation)
    edges = band_edges(drive)
    missed = np.asarray(fft.irfft(error, n, axis=1))
    windows = np.array_split(np.arange(n), min(WINDOWS, n))
    size = np.sqrt(np.sum(_power(measured), axis=1) / n**2)
    return ErrorMap(
        record=record.name,
        level=0.0 if record.excitation is None else float(np.sqrt(np.mean(record.excitation**2))),
        frequency=np.sqrt(edges[:-1] * edges[1:]) * record.fs / n,
        by_frequency=np.sqrt(_in_bands(_power(error), edges)) / rms,
        time=np.array([window.mean() for window in windows]) / record.fs,
        by_time=np.stack([np.sqrt(np.mean(missed[:, w] ** 2, axis=1)) for w in windows], axis=1) / size[:, None],
        noise_by_frequency=_noise_in_bands(score, drive, edges, rms),
    )


def band_edges(power: FloatArray) -> IntArray:
    """(n_bands + 1,) first lines of bands of equal ratio over the excited range, and the line after the last.

    Args:
        power: (lines,) of the excitation, or of the response where there is none, up to the highest line judged.
    """
    share = np.cumsum(power) / max(float(power.sum()), np.finfo(float).tiny)
    first = max(1, int(np.searchsorted(share, QUIET_SHARE)))
    return np.unique(np.round(np.geomspace(first, len(power), BANDS + 1)).astype(np.int64))


def _power(spectrum: AnyArray) -> FloatArray:
    """Squares of a one-sided spectrum, counted for both sides."""
    power = 2.0 * np.abs(spectrum) ** 2
    power[..., 0] *= 0.5
    return np.asarray(power)


def _drive_power(excitation: FloatArray) -> FloatArray:
    return np.asarray(_power(scored_spectrum((excitation - excitation.mean())[None]))[0])


def _in_bands(power: FloatArray, edges: IntArray) -> FloatArray:
    """Sums over the bands; what lies below the first belongs to it."""
    return np.asarray(np.add.reduceat(power, np.concatenate([[0], edges[1:-1]]), axis=-1))


def _noise_in_bands(score: RecordScore, drive: FloatArray, edges: IntArray, rms: FloatArray) -> FloatArray:
    """The sensors' noise is white; what the model carries from the excitation's follows the model's gain."""
    n, lines = score.record.n_samples, np.diff(np.concatenate([[0], edges[1:]]))
    white = 2.0 * n * score.noise.sensors[:, None] ** 2 * lines / rms**2
    carried = np.maximum(score.channel_noise_nrmse**2 - white.sum(axis=1), 0.0)[:, None]
    reached = np.maximum(_in_bands(drive, edges), np.finfo(float).tiny)
    gain = _in_bands(_power(scored_spectrum(score.predicted)), edges) / reached * lines
    total = np.maximum(gain.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    return np.asarray(np.sqrt(white + carried * gain / total))
