"""Frequency and damping of modes while the record is being made: damped sinusoids in a window that slides.

The window reaches back to the last blow at most, so that nothing but the modes moves the channels in it. Memory is one
window. An estimate of a damping that changes speaks for a time within its window: see ``speaks_for``.
"""

from dataclasses import dataclass, field
from math import ceil

import numpy as np

from identification.decay.blows import ChannelWatch, ForceWatch, Forecast
from identification.decay.free import SETTLING
from identification.decay.window_fit import fit_window
from models.arrays import ComplexArray, FloatArray, IntArray
from models.errors import InputError

LEAST_OF_LOWEST = 1.0
"""Periods of the lowest mode in the shortest window; in a shorter one it is a trend that others take up."""

PIECES = 8
"""Of a hop in which blows are told where there is no force."""


@dataclass(frozen=True)
class StreamSettings:
    """How a stream is watched.

    Attributes:
        fs: sampling rate, Hz.
        window: longest, s.
        hop: between two estimates, s.
        first_time: of the first sample, s.
        least_periods: that a mode moves through in a window, to be reported.
    """

    fs: float
    window: float
    hop: float
    first_time: float = 0.0
    least_periods: float = 3.0


@dataclass(frozen=True, eq=False)
class StreamEstimate:
    """What one window says.

    Attributes:
        start, end: of the window, s.
        modes: (m,) numbers of the modes that stand out in it, among those that are followed.
        times: (m,) s, for which each mode's damping speaks.
        natural_freqs, natural_freq_stds: (m,) Hz.
        damping_ratios, damping_ratio_stds: (m,).
    """

    start: float
    end: float
    modes: IntArray
    times: FloatArray
    natural_freqs: FloatArray
    natural_freq_stds: FloatArray
    damping_ratios: FloatArray
    damping_ratio_stds: FloatArray


def speaks_for(decay_rates: FloatArray, duration: float, fs: float) -> FloatArray:
    """(m,) s after a window's begin, the mean time for which the fitted damping of a mode speaks, to first order.

    A fitted rate is the slope of the log-amplitude through samples weighted by the energy e(t) = exp(-2 sigma t), so a
    rate at the time s enters with the weight w(s) = int_s^T e(t) (t - t0) dt / m2, t0 being the centre of the energy.
    Its mean is t0 + m3 / (2 m2), with the central moments m2 and m3 of the energy: the middle of a window in which
    nothing decays, and 1 / sigma after the begin of a long one.

    Args:
        decay_rates: (m,) sigma, 1/s.
        duration: T of the window, s.
        fs: sampling rate, Hz.
    """
    time = np.arange(max(round(duration * fs), 3)) / fs
    energy = np.exp(-2.0 * np.asarray(decay_rates)[:, None] * time)
    energy /= energy.sum(axis=1, keepdims=True)
    centre = energy @ time
    second, third = (np.sum(energy * (time - centre[:, None]) ** order, axis=1) for order in (2, 3))
    return np.asarray(centre + third / (2.0 * second))


@dataclass(eq=False)
class DecayStream:
    """Follows modes from block to block in bounded memory.

    Estimates come every hop, whatever the blocks: an estimate over the window [s, e] is ready ``SETTLING`` samples
    after e, since a blow that comes then is heard by the recorder before it acts. It speaks for ``speaks_for`` after s,
    which together make the lag. The modes are those of ``start``; one that has drowned in the noise is left out until
    the next blow.

    Attributes:
        settings: of the stream.
        start: (n_modes,) poles to begin from, 1/s, as the rig's model or ``find_modes`` gives them; they bound how far
            a frequency may wander.
        n_channels: of each block.
    """

    settings: StreamSettings
    start: ComplexArray
    n_channels: int
    _buffer: FloatArray = field(init=False)
    _pending: FloatArray = field(init=False)
    _poles: ComplexArray = field(init=False)
    _by_force: ForceWatch = field(default_factory=ForceWatch)
    _by_channels: ChannelWatch = field(init=False)
    _forecast: Forecast | None = None
    _count: int = 0
    _free: int = 0

    def __post_init__(self) -> None:
        about, start = self.settings, np.asarray(self.start, complex)
        lowest = np.abs(start).min(initial=np.inf) / (2.0 * np.pi)
        if not start.size or (start.imag <= 0.0).any() or about.window * lowest < LEAST_OF_LOWEST or about.hop <= 0.0:
            raise InputError(
                f"a window of {about.window:g} s and a hop of {about.hop:g} s for modes from {lowest:.4g} Hz on",
                f"modes oscillate, a window holds {LEAST_OF_LOWEST:g} period of the lowest, and a hop is more than 0",
                f"take a window of {LEAST_OF_LOWEST / lowest:.3g} s or more, and name modes that oscillate",
            )
        self.start = start[np.argsort(np.abs(start))]
        self._poles = self.start.copy()
        self._buffer = np.zeros((self.n_channels, round(about.window * about.fs) + SETTLING))
        self._pending = np.empty((self.n_channels + 1, 0))
        self._by_channels = ChannelWatch(max(self._hop // PIECES, 1))

    @property
    def _hop(self) -> int:
        return PIECES * max(ceil(self.settings.hop * self.settings.fs / PIECES), 1)

    def push(self, block: FloatArray, force: FloatArray | None = None) -> tuple[StreamEstimate, ...]:
        """Take the next samples, and give the estimates that they complete.

        Args:
            block: (n_channels, n) that follow the last block's.
            force: (n,) measured at the same times, N; None where there is none: either with all blocks or with none.

        Raises:
            InputError: sizes that do not fit, or samples that are not finite.
        """
        block = np.asarray(block, float)
        known = np.full(block.shape[-1:], np.nan) if force is None else np.asarray(force, float)
        fits = block.ndim == 2 and block.shape[0] == self.n_channels and known.shape == block.shape[1:]
        if not fits or not np.isfinite(block).all() or (force is not None and not np.isfinite(known).all()):
            raise InputError(
                f"a block of size {block.shape} with a force of size {known.shape}",
                f"they are ({self.n_channels}, n) and (n,) finite numbers",
                "pass what follows the last block",
            )
        self._pending = np.hstack([self._pending, np.vstack([block, known])])
        found = []
        while self._pending.shape[1] >= self._hop:
            piece, self._pending = self._pending[:, : self._hop], self._pending[:, self._hop :]
            found += self._take(piece[:-1], None if force is None else piece[-1])
        self._pending = self._pending.copy()
        return tuple(found)

    def _struck(self, channels: FloatArray, force: FloatArray | None) -> int | None:
        """Where in a hop a blow acts last, or None."""
        if force is not None:
            return self._by_force.see(force)
        onset = self._by_channels.see(channels)
        return onset if self._forecast is None else self._forecast.surprise(channels, self._count, self._hop // PIECES)

    def _take(self, channels: FloatArray, force: FloatArray | None) -> list[StreamEstimate]:
        n, last = channels.shape[1], self._struck(channels, force)
        if n < self._buffer.shape[1]:
            self._buffer = np.hstack([self._buffer[:, n:], channels])
        else:
            self._buffer = channels[:, -self._buffer.shape[1] :].copy()
        if last is not None:
            self._free, self._forecast = self._count + last + 1 + SETTLING, None
        self._count += n
        end = self._count - SETTLING
        start = max(self._free, self._count - self._buffer.shape[1])
        lowest = float(np.abs(self.start[0])) / (2.0 * np.pi)
        if end - start < LEAST_OF_LOWEST * self.settings.fs / lowest:
            return []
        return self._estimates(self._buffer[:, start - self._count : -SETTLING], start, end)

    def _estimates(self, window: FloatArray, start: int, end: int) -> list[StreamEstimate]:
        """The estimate of a window between two samples, if a mode has moved through enough periods in it."""
        fs, first = self.settings.fs, self.settings.first_time
        found = fit_window(window, fs, self._poles, self.start)
        if found is None:
            self._poles, self._forecast = self.start.copy(), None
            return []
        poles, modes = found
        self._forecast = Forecast(poles, start, fs)
        self._poles[modes] = poles.values
        seen = poles.natural_freqs * (end - start) >= self.settings.least_periods * fs
        if not seen.any():
            return []
        duration, begin = (end - start) / fs, first + start / fs
        estimate = StreamEstimate(
            start=begin,
            end=first + end / fs,
            modes=modes[seen],
            times=begin + speaks_for(-poles.values[seen].real, duration, fs),
            natural_freqs=poles.natural_freqs[seen],
            natural_freq_stds=poles.natural_freq_stds[seen],
            damping_ratios=poles.damping_ratios[seen],
            damping_ratio_stds=poles.damping_ratio_stds[seen],
        )
        return [estimate]
