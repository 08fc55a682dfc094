"""Where a record decays freely: after its force has ended, or after each blow that the channels show."""

import numpy as np

from models.arrays import BoolArray, FloatArray

ABOVE_QUIET, OF_PEAK = 6.0, 1e-3
"""A force acts where it exceeds this many times its quiet level, or this share of its peak."""

QUIET_SHARE, PIECES = 20, 200
"""Percentile of the rms values of so many pieces of a record that counts as quiet."""

NEVER_QUIET = 0.1
"""A force whose quiet level is above this share of its loudest acts throughout."""

SETTLING = 24
"""Samples after a force's end in which the recorder's low-pass still rings, and before its begin: it looks ahead."""

RINGS = 0.03
"""A stretch whose loudest is below this share of the loudest stretch's is rest, and not a decay."""

ONSET, LOUD, LOOK_BACK = 10.0, 0.05, 6
"""A blow raises the power of a piece so many times above the pieces before it, to this share of the loudest."""


def free_stretches(
    excitation: FloatArray | None, responses: FloatArray, fs: float, least: float
) -> list[tuple[int, int]]:
    """First and end samples of the stretches in which nothing drives the rig, in order of time.

    Args:
        excitation: (N,) measured force or base motion; None where there is none.
        responses: (n_channels, N).
        fs: sampling rate, Hz.
        least: duration of the shortest stretch that is of use, s.
    """
    acting = _onsets(responses) if excitation is None else _acting(excitation)
    edges = np.flatnonzero(np.diff(np.concatenate(([True], acting, [True])).astype(int)))
    stretches = [(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]
    n = responses.shape[1]
    shifted = [(start + SETTLING if start else 0, end if end == n else end - SETTLING) for start, end in stretches]
    long = [(start, end) for start, end in shifted if end - start >= least * fs]
    loudness = [_loudest(responses[:, start:end]) for start, end in long]
    return [stretch for stretch, loud in zip(long, loudness, strict=True) if loud > RINGS * max(loudness)]


def acting_level(quiet: float, loudest: float, peak: float) -> float:
    """Magnitude above which an excitation acts; below 0, so that it always does, where it is never quiet.

    Args:
        quiet: its quiet level, rms.
        loudest: the largest level, rms.
        peak: its largest magnitude.
    """
    return -1.0 if quiet > NEVER_QUIET * loudest else max(ABOVE_QUIET * quiet, OF_PEAK * peak)


def quiet_and_loudest(excitation: FloatArray) -> tuple[float, float]:
    """Rms level of a (N,) excitation where it is quiet, and that of its loudest piece, in its unit."""
    level = np.sqrt([np.mean(piece**2) for piece in np.array_split(excitation, PIECES)])
    return float(np.percentile(level, QUIET_SHARE)), float(level.max())


def _loudest(responses: FloatArray) -> float:
    """Largest rms of a twentieth of a stretch, in any channel."""
    pieces = np.array_split(responses, 20, axis=1)
    return max(float(np.sqrt(np.mean(piece**2, axis=1)).max()) for piece in pieces)


def _acting(excitation: FloatArray) -> BoolArray:
    """(N,) whether the excitation is above its quiet level."""
    size = np.abs(excitation)
    return np.asarray(size > acting_level(*quiet_and_loudest(excitation), float(size.max())))


def _onsets(responses: FloatArray) -> BoolArray:
    """(N,) whether a blow raises the channels' power just then."""
    n = responses.shape[1]
    edges = np.linspace(0, n, min(PIECES, n) + 1).astype(int)
    scale = np.sqrt(np.mean(responses**2, axis=1, keepdims=True))
    power = np.add.reduceat(np.mean((responses / np.where(scale > 0.0, scale, 1.0)) ** 2, axis=0), edges[:-1])
    acting = np.zeros(n, dtype=bool)
    for k in range(1, len(power)):
        if power[k] > ONSET * power[max(0, k - LOOK_BACK) : k].max() and power[k] > LOUD * power.max():
            acting[edges[k] : edges[k + 1]] = True
            if k == 1:
                acting[: edges[k]] = True
    return acting
