"""Does an excitation repeat, and which of its periods are steady?"""

import numpy as np
from scipy.signal import welch

from models.arrays import FloatArray
from models.band_limit import PASS_EDGE
from models.errors import InputError

TOLERANCE = 0.03
"""Largest noise-to-signal ratio of an excitation that still counts as repeating: three times a 1 % force noise."""

NOISY, FLAT = 0.2, 2.0
"""The same where what does not repeat is noise, on all frequencies alike: up to so many times as dense in the excited
band as beside it. A light structure takes little force, and its sensor's noise does not shrink with it."""

TRANSIENT_FLOOR = 1e-3
"""A period that differs from the last by less than this share of the rms counts as steady."""


def find_period(excitation: FloatArray) -> int | None:
    """Number of samples after which the excitation repeats, or None if it does not.

    The mismatch of the signal and itself shifted by T samples is computed for every T up to half the length, through
    the autocorrelation. The start may differ (a ramp, a closed loop that settles): then the second half decides.

    Args:
        excitation: (N,) measured excitation, any unit.

    Raises:
        InputError: the excitation is not one channel.

    Source: the lag-domain difference of de Cheveigne and Kawahara, JASA 111 (2002) 1917, eq. 6.
    """
    if excitation.ndim != 1:
        raise InputError(f"an excitation of size {excitation.shape}", "it is one channel, (N,)", "pass one channel")
    for part in (excitation, excitation[excitation.size // 2 :]):
        period = _shortest_match(part)
        if period is not None:
            return period
    return None


def split_periods(signals: FloatArray, period: int) -> FloatArray:
    """The whole steady periods of a record, aligned to its end.

    A period is steady if it and all later ones differ from the last by no more than 1.5 times what the last two differ
    by (their noise), or by less than ``TRANSIENT_FLOOR``. Two periods alone cannot be judged: both are kept.

    Args:
        signals: (n, N) channels, each in its unit.
        period: samples per period.

    Returns:
        (n_periods, n, period), at least two periods.

    Raises:
        InputError: there are fewer than two whole periods.
    """
    n, length = signals.shape
    count = length // period
    if count < 2:
        raise InputError(
            f"{length} samples with a period of {period}",
            "at least two whole periods are compared",
            "record longer or treat the excitation as not repeating",
        )
    periods = signals[:, length - count * period :].reshape(n, count, period).swapaxes(0, 1)
    difference = _difference_from_last(periods)
    limit = max(1.5 * difference[-1], TRANSIENT_FLOOR)
    unsteady = np.flatnonzero(difference > limit)
    return periods[unsteady[-1] + 1 if unsteady.size else 0 :]


def _difference_from_last(periods: FloatArray) -> FloatArray:
    """(n_periods - 1,) rms of each period minus the last, every channel normalised by its own rms."""
    scale = np.sqrt(np.mean(periods[-1] ** 2, axis=-1))
    alive = scale > 0.0
    error = np.sqrt(np.mean((periods[:-1] - periods[-1]) ** 2, axis=-1))
    return np.asarray(np.sqrt(np.mean((error[:, alive] / scale[alive]) ** 2, axis=1)))


def _shortest_match(signal: FloatArray) -> int | None:
    mismatch = _mismatch(signal - signal.mean())
    apart = np.flatnonzero(mismatch > 0.5)
    if apart.size == 0:
        return None
    start = int(apart[0])
    nearest = start + int(np.argmin(mismatch[start:]))
    best = float(mismatch[nearest])
    if best > NOISY or (best > TOLERANCE and not _differs_by_noise(signal, nearest)):
        return None
    # Shorter lags that match almost as well as the best are true periods; much worse ones are only similar.
    matching = start + np.flatnonzero(mismatch[start:] <= max(1.5 * best, 1e-6))
    run = matching[: np.flatnonzero(np.diff(matching, append=matching[-1] + 2) > 1)[0] + 1]
    return int(run[np.argmin(mismatch[run])])


def _differs_by_noise(signal: FloatArray, period: int) -> bool:
    """Whether a signal and itself a period later differ as much beside the excited band as in it."""
    segment = min(signal.size - period, SEGMENT)
    _, density = welch(signal, nperseg=segment)
    frequency, difference = welch(signal[period:] - signal[:-period], nperseg=segment)
    recorded = (frequency > 0.0) & (frequency < PASS_EDGE)  # where a recorder lets noise pass
    density, difference = density[recorded], difference[recorded]
    excited = density > 2.0 * difference  # a difference has twice the noise
    if not excited.any() or excited.all():
        return False
    return bool(difference[excited].mean() < FLAT * difference[~excited].mean())


SEGMENT = 1024
"""Samples of the segments whose spectra are averaged."""


def _mismatch(signal: FloatArray) -> FloatArray:
    """(N//2 + 1,) noise-to-signal ratio if the signal repeated after T = 0, 1, ... samples; 1 where unrelated."""
    n = signal.size
    lags = np.arange(n // 2 + 1)
    energy = np.concatenate(([0.0], np.cumsum(signal**2)))
    if energy[-1] == 0.0:
        return np.zeros(lags.size)
    both = energy[n - lags] + energy[-1] - energy[lags]
    spectrum = np.fft.rfft(signal, 2 * n)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2, 2 * n)[lags]
    return np.asarray(np.sqrt(np.maximum(1.0 - 2.0 * correlation / both, 0.0)))
