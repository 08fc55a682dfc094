"""Frequency response functions from a record: H1, H2 and coherence, by Welch's method or over whole periods."""

from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len
from scipy.signal import get_window

from identification.period import find_period, split_periods
from models.arrays import AnyArray, ComplexArray, FloatArray
from models.errors import InputError

__all__ = ["FrfEstimate", "estimate_frf", "estimate_frf_per_level", "find_period", "split_periods"]

EXCITED_FLOOR = 1e-8
"""Lines whose excitation power is below this share of the strongest line's (80 dB) carry no FRF."""

EXCITED_ABOVE_NOISE = 20.0
"""Over repeated periods, a line's mean power must exceed its noise by this factor: chance reaches e^-20 = 2e-9."""

LEVEL_WIDTH_DB = 6.0
"""Segments whose excitation differs by less than a factor of two in rms belong to one level."""

LEVEL_RANGE_DB = 40.0
"""Segments this far below the strongest hold a pause and a force sensor's 1 % noise rather than a level."""


@dataclass(frozen=True, eq=False)
class FrfEstimate:
    """Frequency response functions of one excitation level.

    Attributes:
        frequency: (n_freq,) Hz, the lines that the excitation reached; 0 Hz is left out with the means.
        h1: (n, n_freq) Syx / Sxx in response unit per excitation unit; biased low by noise on the excitation.
        h2: (n, n_freq) Syy / Sxy; biased high by noise on the response.
        coherence: (n, n_freq) h1 / h2, from 0 to 1; over periods it sees noise and not a nonlinearity that repeats.
        level: rms of the excitation over the segments used, in its unit.
        n_averages: segments or periods averaged.
        period: samples per period where the excitation repeats, None where it does not.
    """

    frequency: FloatArray
    h1: ComplexArray
    h2: ComplexArray
    coherence: FloatArray
    level: float
    n_averages: int
    period: int | None


def estimate_frf(
    excitation: FloatArray,
    responses: FloatArray,
    fs: float,
    *,
    resolution: float,
    besides: FloatArray | None = None,
) -> FrfEstimate:
    """Estimate the FRFs of one record, all of its segments taken together.

    An excitation that repeats is averaged over its steady whole periods without a window, so its line spacing is that
    of the period; any other by Welch's method with Hann windows that overlap by half.

    Args:
        excitation: (N,) measured excitation.
        responses: (n, N) channels.
        fs: sampling rate, Hz.
        resolution: wanted spacing of the lines, Hz, where the excitation does not repeat.
        besides: (m, N) what a model makes of the same excitation, estimated from the periods in which the record is
            steady; its rows follow those of the channels.

    Raises:
        InputError: sizes that do not fit, a silent channel, or fewer than two segments to average.

    Source: Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70; Bendat and Piersol, Random Data, 2010, ch. 6.
    """
    channels = responses if besides is None else np.vstack((responses, besides))
    _check(excitation, channels)
    period = find_period(excitation)
    if period is not None:
        steady = len(split_periods(np.vstack((excitation, responses)), period))
        last = np.vstack((excitation, channels))[:, -steady * period :]
        return _over_periods(last.reshape(len(last), steady, period).swapaxes(0, 1), fs)
    x, y = _segments(excitation, channels, fs, resolution)
    return _welch(x, y, fs)


def estimate_frf_per_level(
    excitation: FloatArray, responses: FloatArray, fs: float, *, resolution: float
) -> tuple[FrfEstimate, ...]:
    """Estimate the FRFs of one record for each of its excitation levels, so that a nonlinearity shows.

    Segments are sorted by the rms of their excitation into steps of ``LEVEL_WIDTH_DB`` down from the strongest, as far
    as ``LEVEL_RANGE_DB``; a level with a single segment is left out. An excitation that repeats has one level.

    Args:
        excitation: (N,) measured excitation.
        responses: (n, N) channels.
        fs: sampling rate, Hz.
        resolution: wanted spacing of the lines, Hz, where the excitation does not repeat.

    Returns:
        One estimate per level, the strongest first.

    Raises:
        InputError: as ``estimate_frf``.
    """
    _check(excitation, responses)
    if find_period(excitation) is not None:
        return (estimate_frf(excitation, responses, fs, resolution=resolution),)
    x, y = _segments(excitation, responses, fs, resolution)
    rms = _rms(x, axis=-1)
    steps = np.arange(0.0, LEVEL_RANGE_DB, LEVEL_WIDTH_DB)
    upper, lower = (rms.max() * 10.0 ** (-(steps + width) / 20.0) for width in (0.0, LEVEL_WIDTH_DB))
    members = [np.flatnonzero((rms <= high) & (rms > low)) for high, low in zip(upper, lower, strict=True)]
    return tuple(_welch(x[chosen], y[:, chosen], fs) for chosen in members if chosen.size > 1)


def _check(excitation: FloatArray, responses: FloatArray) -> None:
    if excitation.ndim != 1 or responses.ndim != 2 or responses.shape[1] != excitation.size:
        raise InputError(
            f"an excitation of size {excitation.shape} and responses of size {responses.shape}",
            "they are (N,) and (n, N) on one time base",
            "pass one excitation and one row per channel",
        )
    for name, signal in (("excitation", excitation), *((f"responses[{i}]", row) for i, row in enumerate(responses))):
        if np.ptp(signal) == 0.0:
            raise InputError(f"{name} is {signal[0]:g} throughout", "an FRF needs motion", "leave the dead channel out")


def _segments(
    excitation: FloatArray, responses: FloatArray, fs: float, resolution: float
) -> tuple[FloatArray, FloatArray]:
    """(n_segments, length) and (n, n_segments, length) views that overlap by half."""
    length = next_fast_len(max(round(fs / resolution), 4), real=True)
    if 2 * excitation.size < 3 * length:
        raise InputError(
            f"a resolution of {resolution:g} Hz for a record of {excitation.size / fs:g} s",
            f"two half-overlapping segments of {length / fs:g} s or more are averaged",
            f"ask for {2.0 * fs / excitation.size:.3g} Hz or coarser",
        )
    windows = np.lib.stride_tricks.sliding_window_view
    hop = length // 2
    return windows(excitation, length)[::hop], windows(responses, length, axis=1)[:, ::hop]


def _welch(x: FloatArray, y: FloatArray, fs: float) -> FrfEstimate:
    window = get_window("hann", x.shape[-1])
    spectrum = _spectra(x, window)
    power = np.mean(np.abs(spectrum) ** 2, axis=0)
    excited = power > EXCITED_FLOOR * power.max()
    return _average(x, y, fs, window, excited, period=None)


def _over_periods(periods: FloatArray, fs: float) -> FrfEstimate:
    x, y = periods[:, 0], periods[:, 1:].swapaxes(0, 1)
    window = np.ones(x.shape[-1])
    spectrum = _spectra(x, window)
    power = np.abs(spectrum.mean(axis=0)) ** 2
    noise = np.median(np.var(spectrum, axis=0, ddof=1)) / len(spectrum)
    excited = power > max(EXCITED_FLOOR * power.max(), EXCITED_ABOVE_NOISE * noise)
    return _average(x, y, fs, window, excited, period=x.shape[-1])


def _spectra(segments: FloatArray, window: FloatArray) -> ComplexArray:
    """Spectra of the segments without their means and without the line at 0 Hz."""
    centred = segments - segments.mean(axis=-1, keepdims=True)
    return np.fft.rfft(window * centred)[..., 1:]


def _average(
    x: FloatArray, y: FloatArray, fs: float, window: FloatArray, excited: AnyArray, *, period: int | None
) -> FrfEstimate:
    inputs = _spectra(x, window)[:, excited]
    sxx = np.mean(np.abs(inputs) ** 2, axis=0)
    h1 = np.empty((len(y), sxx.size), dtype=complex)
    h2 = np.empty_like(h1)
    for i, channel in enumerate(y):  # one channel at a time: the overlapping spectra of all would not fit in memory
        outputs = _spectra(channel, window)[:, excited]
        syx = np.mean(outputs * inputs.conj(), axis=0)
        h1[i] = syx / sxx
        h2[i] = np.mean(np.abs(outputs) ** 2, axis=0) / syx.conj()
    return FrfEstimate(
        frequency=(1.0 + np.flatnonzero(excited)) * fs / x.shape[-1],
        h1=h1,
        h2=h2,
        coherence=np.minimum(np.abs(h1) / np.abs(h2), 1.0),
        level=float(_rms(x)),
        n_averages=len(x),
        period=period,
    )


def _rms(signal: FloatArray, axis: int | None = None) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(signal**2, axis=axis)))
