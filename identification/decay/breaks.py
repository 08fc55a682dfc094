"""Times at which the damping of a mode jumps, seen in the skeleton of its ridge."""

import numpy as np
from scipy.signal import find_peaks
from scipy.stats import median_abs_deviation

from identification.decay.ridge import FITTED, Skeleton, follow_mode
from models.arrays import FloatArray

STANDS_OUT = 6.0
"""Standard deviations by which the steepness at a jump exceeds that of the rest of the record."""

APART = 3.0
"""Windows between two jumps, and between a jump and an end of the record."""


def find_breaks(skeleton: Skeleton) -> tuple[float, ...]:
    """Times at which the decay rate is steep as nowhere else.

    A jump gives the rate's derivative the window's own shape, as high as the jump over the window's width. The noise
    grows as the amplitude falls, so the steepness is weighed with it; a steady slope does not count.

    Args:
        skeleton: of a mode, followed without breaks.

    Returns:
        s, in order.
    """
    margin = max(int(APART * skeleton.window / (skeleton.time[1] - skeleton.time[0])), 1)
    inside = slice(margin, max(len(skeleton.time) - margin, margin))
    steepness = skeleton.amplitude * np.gradient(skeleton.decay_rate, skeleton.time)
    excess = np.abs(steepness - np.median(steepness[inside] if steepness[inside].size else steepness))
    usual = median_abs_deviation(steepness[inside], scale="normal") if steepness[inside].size else np.inf
    peaks, _ = find_peaks(excess[inside], height=STANDS_OUT * usual, distance=margin)
    return tuple(skeleton.time[inside][peaks].tolist())


def follow_past_jumps(
    signal: FloatArray,
    fs: float,
    frequency: float | FloatArray,
    scale: float | None = None,
    shape: str = "gaussian",
    edges: str = FITTED,
) -> Skeleton:
    """Follow a mode, find where its damping jumps, and follow it again with windows that end at the jumps.

    A window across a jump smears it over the window's width, which is most of the error of a ridge whose damping steps.

    Args:
        signal: (N,).
        fs: sampling rate, Hz.
        frequency: see ``follow_mode``.
        scale: see ``follow_mode``.
        shape: see ``follow_mode``.
        edges: see ``follow_mode``.

    Raises:
        InputError: what ``follow_mode`` raises.
    """
    first = follow_mode(signal, fs, frequency, scale, shape, edges)
    breaks = find_breaks(first)
    return follow_mode(signal, fs, frequency, scale, shape, edges, breaks) if breaks else first
