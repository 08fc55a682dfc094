"""A best linear approximation between the lines that it was measured on."""

import numpy as np
from scipy.ndimage import maximum_filter1d

from models.arrays import BoolArray, ComplexArray, FloatArray


def between(excited: BoolArray, bla: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """The linear response on all lines within the excited range, and how far off a straight line may lie.

    How far is seen where an excited line is drawn from its two neighbours; they lie further apart than those of a line
    between two, so it is an upper bound where the response bends.

    Args:
        excited: (K,).
        bla: (n, L) on the excited lines.

    Returns:
        (n, K) response per unit excitation, 0 beyond the excited range, and (n, K) its squared error.
    """
    lines, known = np.arange(len(excited)), np.flatnonzero(excited)
    values = np.stack([np.interp(lines, known, row.real) + 1j * np.interp(lines, known, row.imag) for row in bla])
    error = np.zeros(values.shape)
    if len(known) >= 3:
        weight = (known[1:-1] - known[:-2]) / (known[2:] - known[:-2])
        drawn = (1.0 - weight) * bla[:, :-2] + weight * bla[:, 2:]
        miss = np.pad(np.abs(bla[:, 1:-1] - drawn) ** 2, ((0, 0), (1, 1)), mode="edge")
        miss = maximum_filter1d(miss, 3, axis=1)
        error = np.stack([np.interp(lines, known, row) for row in miss])
    outside = (lines < known[0]) | (lines > known[-1])
    values[:, outside] = 0.0
    error[:, outside | excited] = 0.0
    return values, error
