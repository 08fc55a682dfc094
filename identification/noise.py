"""How noisy the channels are, estimated from the records themselves.

Three ways, the first that applies: the part of a channel that does not repeat when the excitation does; the recorder's
stopped band, where nothing but noise added after its filter can be; and, among several sensors, the part of each that
no few common sources explain (factor analysis of the cross-spectra: a beam driven by a force and held by two sleeves
has three sources). What is left are the quietest bands. All give the density of white noise, so the noise in any band
follows. Each can hold signal too and then reads too much: what a fitted model leaves corrects that, in ``noise_left``.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import get_window

from identification.floor import Floor, common_floor, median_over_mean, scatter_of_medians, spectral_floor
from identification.period import find_period
from models.arrays import AnyArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.record import Record

LEAST_BLOCK = 128
"""Samples of whole periods that are compared with the next ones at least: fewer have too few lines to tell noise."""

SEGMENT = 256
"""Samples of the segments whose cross-spectra are averaged."""

ROOM = (0.2, SCORE_EDGE)
"""Band, as fractions of fs, in which the common sources are weakest and the noise shows."""

STOPPED = (0.45, 0.495)
"""Band in which a recorded signal holds nothing but noise added after the filter."""

MOST_BELIEVED = 0.05
"""Noise of a force sensor, as a share of its signal's rms, above which a quietest band is taken for signal; a quietest
moment as a share of the loudest one's."""


@dataclass(frozen=True, eq=False)
class Noise:
    """White noise of one record's channels.

    Attributes:
        sensors: (n_sensors,) standard deviation of the white noise of each channel over the whole band to fs/2, SI.
        excitation: the same for the excitation channel; 0 where it cannot be told from the signal.
        method: how the sensors' noise was found, in words.
        excitation_method: how the excitation's was found, in words.
        hidden: the excitation fills the whole band and hides its own noise.
    """

    sensors: FloatArray
    excitation: float
    method: str
    excitation_method: str
    hidden: bool = False

    @property
    def at_most(self) -> bool:
        """Whether the sensors' noise is what even their quietest bands hold, which may be motion."""
        return self.method == QUIETEST


def estimate_noise(record: Record) -> Noise:
    """Noise of every channel of a record; see the module's text for how.

    Args:
        record: at least a few hundred samples.
    """
    period = find_period(record.excitation) if record.excitation is not None else None
    block = 0 if period is None else period * -(-LEAST_BLOCK // period)
    repeats = block if block and record.n_samples >= 3 * block else None
    density, method = _sensors_density(record, repeats)
    excitation, excitation_method = _excitation_noise(record, repeats)
    return Noise(np.sqrt(density), excitation or 0.0, method, excitation_method, hidden=excitation is None)


def _sensors_density(record: Record, period: int | None) -> tuple[FloatArray, str]:
    floors = [quiet_floor(channel) for channel in record.responses]
    floor, lines = np.array([f.density for f in floors]), np.array([f.lines for f in floors])
    if period is not None:
        repeated = _between_periods(record.responses, period)
        return _lower(repeated, floor, lines), "what does not repeat from period to period"
    method = QUIETEST
    if len(record.sensors) >= MIN_SENSORS and record.n_samples >= MIN_SAMPLES:
        floor = _lower(floor, unshared_density(record.responses), np.array(UNSHARED_LINES))
        method = "what each sensor does not share with the others"
    stopped = [band_floor(channel, *STOPPED) for channel in record.responses]
    density, lines = np.array([f.density for f in stopped]), np.array([f.lines for f in stopped])
    if np.median(density / floor) > STOPPED_SHARE:
        return _lower(floor, density, lines), "the recorder's stopped band"
    return floor, method


def _lower(first: FloatArray, other: FloatArray, lines: FloatArray) -> FloatArray:
    """The first, but where the other is clearly lower that: the least of two that scatter would lie below both.

    Args:
        first: densities.
        other: densities of the same channels, found another way.
        lines: free ordinates in whose median each of the others rests.
    """
    by_chance = CLEARLY * np.array([scatter_of_medians(n) for n in np.broadcast_to(lines, first.shape).tolist()])
    return np.where(other < (1.0 - by_chance) * first, other, first)


CLEARLY = 2.5
"""Standard deviations by which an estimate must lie below another to be believed instead."""

UNSHARED_LINES = 150.0
"""Free lines to whose median the factor analysis of 4096 samples compares: it is good to some 12 % of a variance."""

MIN_SENSORS, MIN_SAMPLES = 5, 16 * SEGMENT
"""Of a record, from which on it is told what its channels do not share."""

QUIETEST = "the quietest bands of each channel"

STOPPED_SHARE = 0.3
"""The stopped band is believed where it holds at least this share of the noise found in the band."""

SOURCES = 3
"""Common sources of a beam's channels: the excitation and two sleeves."""


def _excitation_noise(record: Record, period: int | None) -> tuple[float | None, str]:
    """Standard deviation, None where the excitation hides it, and how it was found."""
    if record.excitation is None:
        return 0.0, "no excitation channel"
    force, believed = record.excitation, {}
    bands, moments = quiet_floor(force).density, silent_floor(force).density
    if bands <= MOST_BELIEVED**2 * np.mean(force**2):
        believed["the quietest bands of the excitation channel"] = bands
    if moments <= MOST_BELIEVED**2 * _loudest(force):
        believed["the quietest moments of the excitation channel"] = moments
    if believed:
        method = min(believed, key=believed.__getitem__)
        return float(np.sqrt(believed[method])), method
    if period is not None:
        (density,) = _between_periods(record.excitation[None], period)
        return float(np.sqrt(density)), "what does not repeat in the excitation channel"
    return None, "not told apart: the excitation fills the whole band, so its noise is first taken as 0"


def quiet_floor(channel: FloatArray) -> Floor:
    """Floor of the quietest bands below 0.35 fs, its density as the variance of white noise.

    Args:
        channel: (N,).
    """
    density = _periodogram(channel)
    n = len(density)
    first, last = max(2, int(0.02 * n)), int(2 * SCORE_EDGE * n)
    return spectral_floor(density[first:last], max(LEAST_WIDTH, n // BANDS), LINES_PER_FREE_ONE)


def silent_floor(channel: FloatArray) -> Floor:
    """Floor of the quietest moments, as between the blows of a hammer, its density as the variance of white noise.

    Args:
        channel: (N,).
    """
    if len(channel) < MIN_MOMENTS * SEGMENT:
        return Floor(np.inf, 0, 0.0)
    power = np.abs(_segments(channel)) ** 2
    lines = power.shape[1]
    band = power[:, max(2, int(0.02 * lines)) : int(2 * SCORE_EDGE * lines)]
    free = band.shape[1] / LINES_PER_FREE_ONE_OF_HANN
    return common_floor(np.median(band, axis=1) / median_over_mean(free), free)


def _loudest(channel: FloatArray) -> float:
    """Mean square of the loudest moment: beside a blow the quiet ones are plain, however seldom there is one."""
    moments = channel[: len(channel) // SEGMENT * SEGMENT].reshape(-1, SEGMENT)
    return float(np.max(np.mean(moments**2, axis=1), initial=0.0))


MIN_MOMENTS = 4
"""Segments that a channel must hold for its quiet moments to be told from loud ones."""

LINES_PER_FREE_ONE_OF_HANN = 35.0 / 18.0
"""Lines of a Hann window that scatter like one free one: N sum(w^4) / sum(w^2)^2."""

BANDS = 20
"""Bands that the spectrum to fs/2 is cut into, where it has lines enough."""

LEAST_WIDTH = 8
"""Lines of a band at least."""

LINES_PER_FREE_ONE = 2.76
"""Lines of a Blackman-Harris window that scatter like one free one: N sum(w^4) / sum(w^2)^2."""


def band_floor(channel: FloatArray, low: float, high: float) -> Floor:
    """The same of one band, between two fractions of fs.

    Args:
        channel: (N,).
        low: its lower edge.
        high: its upper edge.
    """
    density = _periodogram(channel)
    n = 2 * len(density)
    band = density[int(low * n) : int(high * n)]
    return spectral_floor(band, len(band), LINES_PER_FREE_ONE)


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
    return np.asarray(np.median(band, axis=(1, 2)) / median_over_mean(band[0].size))


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
    """(..., n_segments, lines) spectra of half-overlapping Hann segments; white noise of variance 1 reads power 1."""
    window = get_window("hann", SEGMENT)
    view = np.lib.stride_tricks.sliding_window_view(signals, SEGMENT, axis=-1)[..., :: SEGMENT // 2, :]
    return np.asarray(np.fft.rfft(view * window, axis=-1) / np.sqrt(np.sum(window**2)))
