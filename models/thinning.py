"""Fewer samples of a signal of which only the lowest band is wanted: a short filter, then every so many of its values.

It keeps out only what would be folded into that band. What it does within the band is known, and taken back where the
band is filtered anyway: so it needs no sharp edge, and costs a fraction of the transform of all samples.
"""

from functools import lru_cache

import numpy as np
from numba import njit
from scipy.signal import firwin, kaiser_beta

from models.arrays import FloatArray
from models.compiled import OPTIONS, noticing
from models.lanes import LANES, lanes, total

WANTED = 0.45
"""The band that is wanted, as a fraction of the rate at which it is recorded in the end: just beyond its stop edge."""

FOLDED = 190.0
"""dB by which what would be folded into the band is kept out, as the window is asked for; it keeps 180."""


LEAST_THINNED = 3
"""Times fewer samples, from which on the filter costs less than what it spares."""


def thinned_to(factor: int) -> int:
    """How many times the rate of the record is left after thinning: the least that can be, above 1; all where none is.

    Args:
        factor: how many times it is before.
    """
    return next((left for left in range(2, factor // LEAST_THINNED + 1) if factor % left == 0), factor)


@lru_cache(maxsize=64)
def thinning_taps(factor: int, left: int) -> FloatArray:
    """(n,) taps, an odd number, symmetric.

    Source: J. F. Kaiser, Proc. IEEE Int. Symp. Circuits and Systems (1974) 20, for window and length.

    Args:
        factor: times the rate of the record that the samples have.
        left: times that they have after thinning, 2 at least.
    """
    width = 2.0 * np.pi * (left - 2.0 * WANTED) / factor
    half = int(np.ceil((FOLDED - 7.95) / (2.285 * width) / 2.0))
    taps = firwin(2 * half + 1, left / factor, window=("kaiser", kaiser_beta(FOLDED)))
    taps.flags.writeable = False
    return np.asarray(taps)


def gain_of(taps: FloatArray, freq: FloatArray) -> FloatArray:
    """Gain of symmetric taps.

    Args:
        taps: (n,), an odd number.
        freq: in cycles per sample, any shape.
    """
    half = len(taps) // 2
    return np.asarray(
        taps[half] + 2.0 * np.cos(2.0 * np.pi * np.multiply.outer(freq, np.arange(1, half + 1))) @ taps[half + 1 :]
    )


@noticing("compiled.py", "lanes.py")
@njit(cache=True, **OPTIONS)
def thinned(signal: FloatArray, taps: FloatArray, every: int) -> FloatArray:
    """(n, M / every) every so many values of filtered rows, the first at the first sample; beyond the ends is nothing.

    Args:
        signal: (n, M), M a multiple of ``every``.
        taps: (n_taps,), an odd number, symmetric.
        every: samples.
    """
    n_rows, n_samples = signal.shape
    half, n_left = len(taps) // 2, n_samples // every
    found, whole = np.empty((n_rows, n_left)), np.zeros(-(-len(taps) // LANES) * LANES)
    whole[: len(taps)] = taps
    for m in range(n_rows):
        for i in range(n_left):
            first = i * every - half
            if first >= 0 and first + len(whole) <= n_samples:
                weighted = lanes(whole, 0) * lanes(signal, (m, first))
                for k in range(LANES, len(whole), LANES):
                    weighted = weighted + lanes(whole, k) * lanes(signal, (m, first + k))
                found[m, i] = total(weighted)
            else:
                found[m, i] = 0.0
                for k in range(max(0, -first), min(len(taps), n_samples - first)):
                    found[m, i] += taps[k] * signal[m, first + k]
    return found
