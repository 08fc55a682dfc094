"""How noisy the channels are, estimated from the records themselves.

Three ways, the first that applies: the part of a channel that does not repeat when the excitation does; the recorder's
stopped band, where nothing but noise added after its filter can be; and, among several sensors, the part of each that
no few common sources explain (factor analysis of the cross-spectra: a beam driven by a force and held by two sleeves
has three sources). What is left is the quietest band. All give the density of white noise, so the noise in any band
follows.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import get_window

from identification.period import find_period
from models.arrays import AnyArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.record import Record

SEGMENT = 256
"""Samples of the segments whose cross-spectra are averaged."""

ROOM = (0.2, SCORE_EDGE)
"""Band, as fractions of fs, in which the common sources are weakest and the noise shows."""

STOPPED = (0.45, 0.495)
"""Band in which a recorded signal holds nothing but noise added after the filter."""

FLOOR_RATIO = 0.01
"""A quietest band with more than this share of the mean density is signal, not noise."""


@dataclass(frozen=True, eq=False)
class Noise:
    """White noise of one record's channels.

    Attributes:
        sensors: (n_sensors,) standard deviation of the white noise of each channel over the whole band to fs/2, SI.
        excitation: the same for the excitation channel; 0 where it cannot be told from the signal.
        method: how the sensors' noise was found, in words.
        excitation_method: how the excitation's was found, in words.
    """

    sensors: FloatArray
    excitation: float
    method: str
    excitation_method: str


def estimate_noise(record: Record) -> Noise:
    """Noise of every channel of a record; see the module's text for how.

    Args:
        record: at least a few hundred samples.
    """
    excitation, excitation_method = _excitation_noise(record)
    floor = np.array([quiet_floor(channel) for channel in record.responses])
    method = "the quietest band of each channel"
    period = find_period(record.excitation) if record.excitation is not None else None
    if period is not None and record.n_samples >= 3 * period:
        repeated = np.minimum(_between_periods(record.responses, period), floor)
        return Noise(np.sqrt(repeated), excitation, "what does not repeat from period to period", excitation_method)
    if len(record.sensors) >= MIN_SENSORS and record.n_samples >= 16 * SEGMENT:
        floor = np.minimum(unshared_density(record.responses), floor)
        method = "what each sensor does not share with the others"
    stopped = np.array([band_density(channel, *STOPPED) for channel in record.responses])
    if np.median(stopped / floor) > STOPPED_SHARE:
        floor, method = stopped, "the recorder's stopped band"
    return Noise(np.sqrt(floor), excitation, method, excitation_method)


MIN_SENSORS = 5

STOPPED_SHARE = 0.3
"""The stopped band is believed where it holds at least this share of the noise found in the band."""

SOURCES = 3
"""Common sources of a beam's channels: the excitation and two sleeves."""


def _excitation_noise(record: Record) -> tuple[float, str]:
    if record.excitation is None:
        return 0.0, "no excitation channel"
    floor, mean = quiet_floor(record.excitation), float(np.mean(record.excitation**2))
    if floor > FLOOR_RATIO * mean:
        return 0.0, "not told apart: the excitation fills the whole band, so its noise is taken as 0"
    return float(np.sqrt(floor)), "the quietest band of the excitation channel"


def quiet_floor(channel: FloatArray) -> float:
    """Density of the quietest tenth of the band below 0.35 fs, as the variance of white noise of that density."""
    density = _periodogram(channel)
    n = len(density)
    first, last, width = max(2, int(0.02 * n)), int(2 * SCORE_EDGE * n), max(8, n // 20)
    medians = [
        np.median(density[i : i + width]) for i in range(first, max(first + 1, last - width), max(1, width // 2))
    ]
    return float(min(medians)) / MEDIAN_OF_CHI2


MEDIAN_OF_CHI2 = float(np.log(2.0))
"""Median over mean of a periodogram ordinate (chi-square with two degrees of freedom)."""


def band_density(channel: FloatArray, low: float, high: float) -> float:
    """Median density between two fractions of fs, as the variance of white noise of that density."""
    density = _periodogram(channel)
    n = 2 * len(density)
    return float(np.median(density[int(low * n) : int(high * n)])) / MEDIAN_OF_CHI2


def _periodogram(channel: FloatArray) -> FloatArray:
    """One-sided periodogram under a Blackman-Harris window, normalised so that white noise reads its variance."""
    window = get_window("blackmanharris", len(channel))
    spectrum = np.fft.rfft((channel - channel.mean()) * window)
    return np.asarray(np.abs(spectrum[:-1]) ** 2 / np.sum(window**2))


def _between_periods(responses: FloatArray, period: int) -> FloatArray:
    """(n,) white-noise variance from differences of successive periods; the median passes over transients."""
    n_periods = responses.shape[1] // period
    blocks = responses[:, : n_periods * period].reshape(len(responses), n_periods, period)
    spectra = np.abs(np.fft.rfft(np.diff(blocks[:, 1:], axis=1), axis=2)) ** 2 / (2.0 * period)
    lines = spectra.shape[2]
    band = spectra[:, :, max(2, lines // 50) : int(2 * SCORE_EDGE * lines)]
    return np.asarray(np.median(band, axis=(1, 2)) / MEDIAN_OF_CHI2)


def unshared_density(responses: FloatArray, sources: int = SOURCES) -> FloatArray:
    """(n,) white-noise variance of each channel that ``sources`` common sources do not explain.

    Args:
        responses: (n, N).
        sources: rank of what the channels share at each frequency.

    Source: principal factor analysis, H. H. Harman, Modern Factor Analysis (1976), chapter 9.
    """
    scale = responses.std(axis=1, keepdims=True) + np.finfo(float).tiny
    spectra = _segments(responses / scale)
    lines = spectra.shape[2]
    band = spectra[:, :, int(2 * ROOM[0] * lines) : int(2 * ROOM[1] * lines)]
    n_segments = band.shape[1]
    cross = np.einsum("isf,jsf->fij", band, band.conj()) / n_segments
    inverse = np.linalg.inv(cross + 1e-14 * np.trace(cross, axis1=1, axis2=2)[:, None, None] * np.eye(len(scale)))
    unique = 1.0 / np.real(np.einsum("fii->fi", inverse))
    for _ in range(FACTOR_ITERATIONS):
        pooled = np.median(unique, axis=0)
        root = np.sqrt(pooled)
        value, vector = np.linalg.eigh(cross / (root[:, None] * root[None, :]))
        shared = vector[:, :, -sources:] * np.sqrt(np.maximum(value[:, -sources:] - 1.0, 0.0))[:, None, :]
        fitted = np.sum(np.abs(shared) ** 2, axis=2) * pooled
        unique = np.maximum(np.real(np.einsum("fii->fi", cross)) - fitted, 1e-3 * pooled)
    freedom = 1.0 - sources / max(n_segments, sources + 1)
    return np.asarray(np.median(unique, axis=0) / freedom * scale[:, 0] ** 2)


FACTOR_ITERATIONS = 20


def _segments(signals: AnyArray) -> AnyArray:
    """(n, n_segments, lines) spectra of half-overlapping Hann segments; white noise of variance 1 reads power 1."""
    window = get_window("hann", SEGMENT)
    view = np.lib.stride_tricks.sliding_window_view(signals, SEGMENT, axis=1)[:, :: SEGMENT // 2]
    return np.asarray(np.fft.rfft(view * window, axis=2) / np.sqrt(np.sum(window**2)))
