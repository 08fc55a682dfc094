"""The ridge of a Morlet transform, and the skeleton on it: one mode's amplitude, frequency and damping over time."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from identification.decay.ends import ENDS, continued
from identification.decay.local_fit import fit_inside, fit_through
from identification.decay.windows import window_named
from models.arrays import ComplexArray, FloatArray, IntArray
from models.compiled import compiled
from models.errors import InputError

FITTED = "fitted"
"""Edges that need no continuation: the part of a window that lies in the record is fitted for what it is."""

EDGES = (FITTED, *ENDS)
"""How the ends of a record can be treated."""

CENTRE_FREQUENCY = 16.0
"""omega_0 of a window that nobody has optimised: 2.5 periods of the mode."""

LEAST_WINDOWS = 8.0
"""Standard deviations of that window in a record at least."""

TILT = 0.02
"""Nepers, or radians beside the carrier, within a window's width from which on the fit is made again with them."""

MOST_FITS = 4

STIFFNESS = 10.0
"""Nepers, added up over samples, that a ridge gives up for a step by one line of the scalogram."""


@dataclass(frozen=True, eq=False)
class Skeleton:
    """One mode along its ridge.

    Attributes:
        time: (N,) s.
        amplitude: (N,) in the signal's unit.
        frequency: (N,) Hz, damped.
        damping_ratio: (N,) -d ln A / (omega dt).
        window: standard deviation of the window, s.
        shape: of the window, a name in ``windows.WINDOWS``.
        edges: how the ends were treated, a name in ``EDGES``.
    """

    time: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    damping_ratio: FloatArray
    window: float
    shape: str
    edges: str

    @property
    def centre_frequency(self) -> float:
        """omega_0 of the Morlet wave whose envelope the window is, at the median frequency."""
        return float(2.0 * np.pi * np.median(self.frequency) * self.window)

    @property
    def decay_rate(self) -> FloatArray:
        """(N,) -d ln A / dt, 1/s."""
        return np.asarray(2.0 * np.pi * self.frequency * self.damping_ratio)


def follow_mode(
    signal: FloatArray,
    fs: float,
    frequency: float | FloatArray,
    scale: float | None = None,
    shape: str = "gaussian",
    edges: str = FITTED,
    breaks: tuple[float, ...] = (),
) -> Skeleton:
    """Follow one mode through a record.

    Args:
        signal: (N,).
        fs: sampling rate, Hz.
        frequency: Hz, of the mode, known to a fraction of fs / (2 pi scale); or (N,), along its ridge.
        scale: standard deviation of the window, samples; None for ``CENTRE_FREQUENCY``.
        shape: of the window, a name in ``windows.WINDOWS``.
        edges: ``fitted``, or how the signal is continued beyond its ends: a name in ``ends.ENDS``.
        breaks: s, times at which the damping jumps; each is an edge that no window reaches across.

    Raises:
        InputError: a signal that is not one whole channel, a frequency outside (0, fs / 2), a scale below a sample, a
            stretch between breaks that is shorter than two scales, or an unknown name.

    Source: the article's eqs. (17) to (24); local fits: Fan and Gijbels, Local Polynomial Modelling, 1996, section 3.2.
    """
    _check(signal, fs, np.atleast_1d(np.asarray(frequency, dtype=float)), edges)
    steps = 2.0 * np.pi * np.asarray(frequency, dtype=float) / fs
    if scale is None:
        scale = min(CENTRE_FREQUENCY / float(np.median(steps)), len(signal) / LEAST_WINDOWS)
    cuts = _cuts(breaks, fs, len(signal), scale)
    taps = window_named(shape).taps(scale)
    parts = [
        _stretch(signal[i:j], float(steps) if steps.ndim == 0 else steps[i:j], scale, taps, edges)
        for i, j in pairwise(cuts)
    ]
    amplitude, turning, slope = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Skeleton(
        time=np.arange(len(signal)) / fs,
        amplitude=amplitude,
        frequency=turning * fs / (2.0 * np.pi),
        damping_ratio=-slope / turning,
        window=scale / fs,
        shape=shape,
        edges=edges,
    )


def find_ridge(scalogram: ComplexArray, frequencies: FloatArray, stiffness: float = STIFFNESS) -> FloatArray:
    """The strongest path through a scalogram that does not jump.

    The path maximises the sum of ln |W| less ``stiffness`` times the squares of its steps in lines. From there the
    ridge goes uphill to the next crest, and between lines to that of a parabola through ln |W|.

    Args:
        scalogram: (n_freq, N) Morlet transform.
        frequencies: (n_freq,) Hz, evenly spaced or in a geometric series, growing or falling.
        stiffness: of the path, in nepers; 0 takes the largest |W| at every sample.

    Raises:
        InputError: sizes that do not fit, fewer than three lines, or a stiffness below 0.

    Returns:
        (N,) Hz.

    Source: Carmona, Hwang and Torresani, IEEE Trans. Signal Process. 45 (1997) 2586, by dynamic programming.
    """
    if scalogram.ndim != 2 or len(scalogram) != len(frequencies) or len(frequencies) < 3:
        raise InputError(
            f"a scalogram of size {scalogram.shape} and {len(frequencies)} frequencies",
            "a ridge is looked for in (n_freq, N) with three lines or more",
            "pass one channel's transform with its frequencies",
        )
    if not stiffness >= 0.0:
        raise InputError(f"a stiffness of {stiffness:g}", "it is 0 or more", f"ask for {STIFFNESS:g}")
    level = np.log(np.maximum(np.abs(scalogram), np.finfo(float).tiny))
    path, n = smoothest_path(level, stiffness), np.arange(level.shape[1])
    inner = np.clip(path, 1, len(frequencies) - 2)
    low, middle, high = (level[inner + side, n] for side in (-1, 0, 1))
    bend = np.minimum(low - 2.0 * middle + high, -np.finfo(float).tiny)
    place = inner + np.clip(0.5 * (low - high) / bend, -1.0, 1.0)
    return np.exp(np.interp(place, np.arange(len(frequencies)), np.log(frequencies)))


@compiled
def smoothest_path(level: FloatArray, stiffness: float) -> IntArray:
    """(N,) lines of the crest next to the path through ``level`` (n_freq, N) that ``find_ridge`` describes."""
    n_lines, n = level.shape
    came, path = np.zeros((n, n_lines), dtype=np.int32), np.empty(n, dtype=np.int64)
    best, new = level[:, 0].copy(), np.empty(n_lines)
    for t in range(1, n):
        leader = best.max()
        for i in range(n_lines):
            top, origin = best[i], i
            for step in range(1, n_lines):
                price = stiffness * step * step
                if leader - price <= top:  # no line so far away, or farther, is worth it
                    break
                for j in (i - step, i + step):
                    if 0 <= j < n_lines and best[j] - price > top:
                        top, origin = best[j] - price, j
            new[i], came[t, i] = top + level[i, t], origin
        best, new = new, best
    path[n - 1] = np.argmax(best)
    for t in range(n - 1, 0, -1):
        path[t - 1] = came[t, path[t]]
    for t in range(n):
        i = path[t]
        way = 1 if i + 1 < n_lines and level[i + 1, t] > level[i, t] else -1
        while 0 <= i + way < n_lines and level[i + way, t] > level[i, t]:
            i += way
        path[t] = i
    return path


def _stretch(
    signal: FloatArray, step: float | FloatArray, scale: float, taps: FloatArray, edges: str
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(N,) amplitude, phase per sample and logarithmic slope of the amplitude per sample."""
    if edges == FITTED:
        rate = 0.0
        z0, slope = fit_inside(signal, step, taps)
        for _ in range(MOST_FITS - 1):
            beside = complex(np.average(slope + rate, weights=np.abs(z0) ** 2))
            if abs(beside) * scale < TILT:
                break
            rate, step = rate - beside.real, step + beside.imag
            z0, slope = fit_inside(signal, step, taps, rate)
    else:
        z0, slope = fit_through(signal, *continued(signal, len(taps) // 2, edges), step, taps)
    return np.abs(z0), step + slope.imag, slope.real


def _cuts(breaks: tuple[float, ...], fs: float, n: int, scale: float) -> list[int]:
    """First samples of the stretches between breaks, and the record's length."""
    if not scale >= 1.0:
        raise InputError(f"a scale of {scale:g} samples", "a window holds several samples", "ask for 1 or more")
    cuts = [0, *(int(np.ceil(fs * time)) for time in breaks), n]
    for start, stop in pairwise(cuts):
        if stop - start < 2.0 * scale:
            raise InputError(
                f"{(stop - start) / fs:g} s from {start / fs:g} s on, and a window of {scale / fs:g} s",
                "each stretch holds the window's standard deviation twice",
                "take a smaller scale, or a longer record with fewer breaks",
            )
    return cuts


def _check(signal: FloatArray, fs: float, frequency: FloatArray, edges: str) -> None:
    if signal.ndim != 1 or not np.isfinite(signal).all():
        raise InputError(
            f"a signal of size {signal.shape}, {np.count_nonzero(~np.isfinite(signal))} samples not finite",
            "a mode is followed in one channel without gaps",
            "pass one channel, cut to where it is whole",
        )
    if frequency.size not in {1, len(signal)} or not np.all((frequency > 0.0) & (frequency < 0.5 * fs)):
        raise InputError(
            f"{frequency.size} frequencies from {frequency.min():g} to {frequency.max():g} Hz",
            f"a ridge is one frequency, or one for each sample, between 0 and {0.5 * fs:g} Hz",
            "pass the mode's frequency, or what find_ridge returns",
        )
    if edges not in EDGES:
        raise InputError(f"edges = {edges!r}", f"the ends of a record are {', '.join(EDGES)}", "choose one of them")
