"""Modes separated at cut frequencies between them, constant or changing in time: analytical mode decomposition.

With theta the phase of the cut, H the Hilbert transform and s1 what lies below the cut, Bedrosian's theorem on products
gives s1 = sin(theta) H[x cos(theta)] - cos(theta) H[x sin(theta)]. Written on the analytic signal z = x + j H[x] it
reads s1 = Re(e^(j theta) [z e^(-j theta)]-), where [.]- keeps the negative frequencies: turned back by theta, what lies
below the cut is what turns backwards. In this form nothing folds at fs / 2, however high the cut.

Both transforms take the record for periodic, so the record is first continued beyond its ends (``extend``).
tests/identification/signals/test_separate.py states how much that lowers the errors near the ends.

Source: G. Chen, Z. Wang, Mech. Syst. Signal Process. 28 (2012) 275, for constant cuts; a cut that changes in time
enters by its phase.
"""

import numpy as np
from scipy.fft import fft, ifft, next_fast_len

from identification.signals.extend import extend
from models.arrays import ComplexArray, FloatArray
from models.errors import InputError

EXTENSION_CYCLES = 160.0
"""Periods of the lowest cut put before and after the record: two modes 5 % apart beat eight times in them."""

WORKERS = 2


def separate(signals: FloatArray, fs: float, cuts: FloatArray) -> FloatArray:
    """Separate the channels of one record at the cuts into parts whose sum is the signal.

    Args:
        signals: (..., N) channels of one record, which share their modes.
        fs: sampling rate, Hz.
        cuts: (n_modes - 1,) or (n_modes - 1, N) Hz, increasing from part to part at every time.

    Returns:
        (n_modes, ..., N) the parts from the lowest to the highest; a mean belongs to the lowest, noise to all.

    Raises:
        InputError: signals that are not finite, or cuts that do not fit, do not increase or leave the band.

    Source: Chen and Wang (2012), the theorem.
    """
    n = signals.shape[-1]
    every = _checked(signals, fs, cuts)
    if len(every) == 0:
        return signals[np.newaxis].copy()
    whole = extend(signals, min(round(EXTENSION_CYCLES * fs / float(every.min())), n))
    held = np.pad(every, ((0, 0), (whole.before, whole.after)), mode="edge")
    parts = split(whole.signals, fs, held)[..., whole.before : whole.before + n]
    parts[-1] = signals - parts[:-1].sum(axis=0)
    return parts


def split(signals: FloatArray, fs: float, cuts: FloatArray) -> FloatArray:
    """Split signals that begin and end at rest; an end that moves leaks into the neighbouring part.

    Args:
        signals: (..., N) channels.
        fs: sampling rate, Hz.
        cuts: (n_modes - 1, N) Hz, increasing from part to part.

    Returns:
        (n_modes, ..., N) the parts.

    Source: as ``separate``.
    """
    n = signals.shape[-1]
    size = next_fast_len(n)
    analytic = _analytic(signals, size)
    parts = np.empty((len(cuts) + 1, *signals.shape))
    below: FloatArray | float = 0.0
    for part, cut in zip(parts[:-1], cuts, strict=True):
        phase = 2.0 * np.pi / fs * np.concatenate(([0.0], np.cumsum(0.5 * (cut[1:] + cut[:-1]))))
        turn = np.exp(1j * phase)
        spectrum = fft(analytic * turn.conj(), size, workers=WORKERS)
        spectrum[..., : (size + 1) // 2] = 0.0
        low = (ifft(spectrum, workers=WORKERS)[..., :n] * turn).real
        part[:] = low - below
        below = low
    parts[-1] = signals - below
    return parts


def _analytic(signals: FloatArray, size: int) -> ComplexArray:
    spectrum = fft(signals, size, workers=WORKERS)
    spectrum[..., 1 : (size + 1) // 2] *= 2.0
    spectrum[..., size // 2 + 1 :] = 0.0
    return np.asarray(ifft(spectrum, workers=WORKERS)[..., : signals.shape[-1]])


def _checked(signals: FloatArray, fs: float, cuts: FloatArray) -> FloatArray:
    """(n_modes - 1, N) the cuts at every time."""
    n = signals.shape[-1]
    if not np.all(np.isfinite(signals)):
        raise InputError("signals with NaN or infinite samples", "samples are finite", "cut the gap out of the record")
    if cuts.ndim > 2 or (cuts.ndim == 2 and cuts.shape[1] != n) or cuts.ndim == 0:
        raise InputError(
            f"cuts of size {cuts.shape} for signals of size {signals.shape}",
            f"cuts are (n_modes - 1,) or (n_modes - 1, {n})",
            "pass one frequency, or one row over time, per pair of neighbouring modes",
        )
    every = np.broadcast_to(cuts if cuts.ndim == 2 else cuts[:, None], (len(cuts), n))
    if every.size and not (every.min() > 0.0 and every.max() < 0.5 * fs):
        raise InputError(
            f"cuts from {every.min():g} to {every.max():g} Hz",
            f"a cut lies between 0 and half the sampling rate, {0.5 * fs:g} Hz",
            "cut between two modes that the record holds",
        )
    if not np.all(np.diff(every, axis=0) > 0.0):
        raise InputError(
            "cuts that meet or change order",
            "each cut is higher than the one before it at every time",
            "sort the cuts, and leave one out where two meet",
        )
    return every
