"""The recorder's band block by block: kernels that end, so that nothing waits for the end of a record.

``models.band_limit`` interpolates the force and filters the channels of a whole record at once. Both look ahead; here
they look ahead by a fixed number of samples, and what lies beyond is cut off.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numba import njit
from scipy import fft
from scipy.signal.windows import tukey

from models.arrays import ComplexArray, FloatArray
from models.band_limit import PAD, STOP_EDGE, recorder_gain
from models.compiled import noticing
from models.step_options import OPTIONS

FORCE_REACH = 32
"""Samples on either side of an instant from which the force there is formed."""

KAISER = 14.0
"""Of the window on them: 136 dB, for which a force below 0.43 fs, with images above 0.57 fs, asks for 32 samples."""

CHANNEL_REACH = 64
"""Samples on either side of one from which a channel is formed, unless told otherwise."""

FADE = 0.2
"""Share of a recorder's kernel over which it fades: an edge lets a slow velocity leak into the acceleration."""

KERNEL_PERIOD = 2**14
"""Samples after which a kernel that is formed from its spectrum comes back: 1 / t^3 has fallen to 5e-12 there."""


@lru_cache(maxsize=8)
def force_kernels(factor: int) -> FloatArray:
    """(factor, 2 FORCE_REACH + 1) weights of the samples around one, for the force at and after it by 1 / factor.

    A force without content above 0.43 fs is interpolated to 3e-7, with the loss of a stepper that holds its input
    linear between fine samples made up for, as by ``raise_rate(..., for_linear_hold=True)``.

    Args:
        factor: steps per sample.

    Source: J. F. Kaiser, Proc. IEEE Int. Symp. Circuits Syst. (1974) 20, for the window.
    """
    half = 2 * FORCE_REACH * factor  # at twice the steps' rate, so that one step a sample is no special case
    time = np.arange(-half, half + 1) / (2 * factor)
    plain = np.sinc(time) * np.kaiser(len(time), KAISER)
    n = fft.next_fast_len(4 * len(time), real=True)
    freq = np.minimum(np.arange(n // 2 + 1) * (2 * factor / n), 1.0 - STOP_EDGE)
    kernel = fft.irfft(fft.rfft(plain, n) / np.sinc(freq / factor) ** 2, n)[: len(time) : 2]
    padded = np.append(kernel, np.zeros(factor - 1)).reshape(-1, factor)
    return np.ascontiguousarray(padded[::-1].T)


@noticing("step_options.py")
@njit(**OPTIONS)
def raise_block(force: FloatArray, kernels: FloatArray) -> FloatArray:
    """(1, n factor + 1) the force from sample FORCE_REACH on, for n + 1 + 2 FORCE_REACH samples.

    Each value is one sum in one order, so that it does not depend on where a block begins.
    """
    factor, width = kernels.shape
    fine = np.empty((1, (force.shape[0] - width) * factor + 1))
    for i in range(fine.shape[1]):
        total = 0.0
        for k in range(width):
            total += kernels[i % factor, k] * force[i // factor + k]
        fine[0, i] = total
    return fine


def continue_before(signal: FloatArray, start: int) -> None:
    """Fill the FORCE_REACH samples before number ``start`` as ``models.band_limit.continued`` does, in place."""
    lag = np.arange(1, FORCE_REACH + 1)
    taper = 0.5 * (1.0 + np.cos(np.pi * lag / (PAD + 1)))
    signal[start - lag] = (2.0 * signal[start] - signal[start + lag]) * taper


@dataclass(frozen=True)
class LiveRecorder:
    """``record_channels`` with its kernel cut off ``reach`` samples from the middle.

    The kernel falls as 22 / t^3, and to nothing over the last fifth of its reach. So the gain is off by 6 / reach^2 at
    most, in the corners at 0.37 and 0.43 fs (0.15 % for 64 samples), and by 106 / reach^3 of itself below 0.35 fs
    (0.04 %). Zero-phase, later by the reach.

    Attributes:
        reach: samples.
        factor: fine samples per recorded sample.
        fs: rate of the record, Hz.
        orders: how often each channel is differentiated in time on the way.
    """

    reach: int
    factor: int
    fs: float
    orders: tuple[int, ...]

    @property
    def n_kept(self) -> int:
        """Fine samples before a block that its channels need."""
        return 2 * self.reach * self.factor

    @cached_property
    def kernels(self) -> FloatArray:
        """(n, n_kept + 1) one a channel."""
        n = KERNEL_PERIOD * self.factor
        freq = np.asarray(np.arange(n // 2 + 1) * (self.factor * self.fs / n), np.float64)
        gain, half = recorder_gain(freq, self.fs), self.n_kept // 2
        of_order = {k: fft.irfft(gain * (2j * np.pi * freq) ** k, n) for k in set(self.orders)}
        rows = [np.append(of_order[k][n - half :], of_order[k][: half + 1]) for k in self.orders]
        return np.stack(rows) * tukey(2 * half + 1, FADE)

    def record(self, fine: FloatArray) -> FloatArray:
        """(n, n_samples) of a block, each ``reach`` samples earlier than the fine samples that it came with.

        Args:
            fine: (n, n_kept + n_samples factor) motion, the block's own last.
        """
        n = fft.next_fast_len(fine.shape[1], real=True)
        filtered = fft.irfft(fft.rfft(fine, n) * _spectra(self, n), n)
        first = self.n_kept + self.factor - 1
        return np.ascontiguousarray(filtered[:, first : fine.shape[1] : self.factor])


@lru_cache(maxsize=8)
def _spectra(recorder: LiveRecorder, n: int) -> ComplexArray:
    return np.asarray(fft.rfft(recorder.kernels, n))
