"""How noisy measured FRFs are, from the roughness between neighbouring lines.

A structure's FRF is locally a quotient of two polynomials, whatever its modes. Each line is predicted from its
neighbours by such a quotient; what it misses is noise, its own and what the prediction carries. With a coherence the
noise's size from line to line is known (Bendat and Piersol) and only its scale is estimated, that is, the averages;
without one, the noise is taken as a constant part and a part in proportion to the FRF.

Source: T. McKelvey, G. Guerin, Non-parametric frequency response estimation using a local rational model, IFAC SYSID
2012; J. S. Bendat, A. G. Piersol, Random Data (2010), table 9.6.
"""

import numpy as np
from scipy.optimize import nnls

from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from models.record import FrfRecord

NEIGHBOURS = 8
"""Lines on each side from which a line is predicted."""

NUMERATOR, DENOMINATOR = 2, 2
"""Degrees of the polynomials: a resonance, and what the modes further away leave of it."""

LEAST_LINES = 4 * NEIGHBOURS

LEAST_SHARE = 1e-3
"""Noise assumed at least, as a share of the FRF: the reduced model is not computed closer."""

LEAST_OF_RMS = 1e-5
"""The same beside the lines' rms, for anti-resonances."""

TURNS = 30
"""Of the reweighted fit of the noise's parts."""

OUTLIER = 9.0
"""A line whose squared error is more than this many times the mean, one of 8000, is a resonance between two lines."""

FULL_COHERENCE = 1.0 - 1e-9


def frf_noise(record: FrfRecord) -> tuple[FloatArray, str]:
    """Standard deviation of the real part, and of the imaginary part, of every value; and how it was found.

    Args:
        record: its lines, the noise of neighbours independent.

    Returns:
        (n_sensors, n) SI, and the words.

    Raises:
        InputError: too few lines.
    """
    if len(record.frequency) < LEAST_LINES:
        raise InputError(
            f"{record.name}: FRFs on {len(record.frequency)} lines above 0 Hz",
            f"their noise is told from the roughness between neighbours, of {LEAST_LINES} lines at least",
            "export more lines, or compare with testbed compare",
        )
    rows = [
        _noise_of(record.frequency, values, None if record.coherence is None else record.coherence[i])
        for i, values in enumerate(record.values)
    ]
    if record.coherence is not None:
        return np.stack(rows), "the coherence, its scale from the roughness between neighbouring lines"
    return np.stack(rows), "the roughness between neighbouring lines, a constant part and one in proportion to the FRF"


def _noise_of(frequency: FloatArray, values: ComplexArray, coherence: FloatArray | None) -> FloatArray:
    power = np.abs(values) ** 2
    parts = np.stack([np.full_like(power, np.mean(power)), power])
    if coherence is not None:
        known = np.clip(coherence, 1.0 - FULL_COHERENCE, FULL_COHERENCE)
        parts = ((1.0 - known) / known * power)[None]
    size = _sizes(*_misses(frequency, values, parts))
    least = LEAST_SHARE**2 * power + LEAST_OF_RMS**2 * np.mean(power)
    return np.asarray(np.sqrt(np.maximum(size @ parts / 2.0, least)))


def _misses(frequency: FloatArray, values: ComplexArray, parts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(m,) squared errors of the lines' predictions and (n_parts, m) what each part of the noise adds to them."""
    windows = np.lib.stride_tricks.sliding_window_view
    around = np.delete(np.arange(2 * NEIGHBOURS + 1), NEIGHBOURS)
    lines = windows(frequency, 2 * NEIGHBOURS + 1)
    centre = lines[:, NEIGHBOURS, None]
    r = (lines - centre)[:, around] / np.ptp(lines, axis=1)[:, None]
    near = windows(values, 2 * NEIGHBOURS + 1)
    here, near = near[:, NEIGHBOURS], near[:, around]
    # (1 + b1 r + b2 r^2) H = a0 + a1 r + a2 r^2, so that the prediction at r = 0 is a0.
    powers = r[:, :, None] ** np.arange(1, max(NUMERATOR, DENOMINATOR) + 1)
    columns = [np.ones_like(near)[:, :, None], powers[:, :, :NUMERATOR], -powers[:, :, :DENOMINATOR] * near[:, :, None]]
    inverse = np.linalg.pinv(np.concatenate(columns, axis=2))
    found = np.einsum("kcr,kr->kc", inverse, near)
    denominator = 1.0 + np.einsum("krd,kd->kr", powers[:, :, :DENOMINATOR], found[:, 1 + NUMERATOR :])
    carried = np.abs(inverse[:, 0] * denominator) ** 2
    spread = windows(parts, 2 * NEIGHBOURS + 1, axis=1)
    added = spread[:, :, NEIGHBOURS] + np.einsum("pkr,kr->pk", spread[:, :, around], carried)
    return np.abs(here - found[:, 0]) ** 2, added


def _sizes(squares: FloatArray, parts: FloatArray) -> FloatArray:
    """(n_parts,) sizes of the parts whose sum is the mean of squares that are spread exponentially about it."""
    # Each part alone would explain the median; together they begin at half of that.
    size = np.array([np.median(squares / part) for part in parts]) / np.log(2.0) / len(parts)
    for _ in range(TURNS):
        mean = np.maximum(size @ parts, np.finfo(float).tiny)
        kept = squares < OUTLIER * mean
        weight = kept / mean
        size = nnls((parts * weight).T, squares * weight)[0]
    return np.asarray(size)
