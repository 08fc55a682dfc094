"""Bending modes of the uniform clamped-free beam, of length 1 and unit mass per length, in a form that cannot overflow.

The characteristic equation is cos(b) cosh(b) = -1, with b = beta L.
Source: W. Weaver, S. Timoshenko, D. Young, Vibration Problems in Engineering (1990), section 5.11.
"""

from functools import cache

import numpy as np

from models.arrays import FloatArray


@cache
def wave_numbers(n: int) -> FloatArray:
    """(n,) the first roots b of cos(b) cosh(b) = -1, by Newton's method on cos(b) + 1/cosh(b) = 0."""
    b = np.asarray((np.arange(n) + 0.5) * np.pi, np.float64)
    b[0] = 1.8751
    for _ in range(8):
        secant = 1.0 / np.cosh(b)
        b -= (np.cos(b) + secant) / (-np.sin(b) - secant * np.tanh(b))
    b.setflags(write=False)
    return b


def clamped_free_modes(x: FloatArray, n: int, derivative: int = 0) -> FloatArray:
    """Shapes with unit mean square, or their first or second derivative.

    With s = (cosh b + cos b) / (sinh b + sin b) the shape is cosh bx - cos bx - s (sinh bx - sin bx); the growing
    exponential is multiplied by 1 - s, which is of the order of exp(-b), so both are combined before they are formed.

    Args:
        x: (m,) places, 0 at the clamp and 1 at the free end.
        n: number of modes.
        derivative: 0, 1 or 2, with respect to x.

    Returns:
        (m, n).
    """
    b = wave_numbers(n)
    arg = np.multiply.outer(np.asarray(x, float), b)
    decay = np.exp(-b)
    denominator = 0.5 * (1.0 - decay**2) + np.sin(b) * decay
    growing = 0.5 * (-decay + np.sin(b) - np.cos(b)) * np.exp(arg - b) / denominator
    s = (0.5 * (1.0 + decay**2) + np.cos(b) * decay) / denominator
    falling = 0.5 * (1.0 + s) * np.exp(-arg)
    if derivative == 0:
        return np.asarray(growing + falling - np.cos(arg) + s * np.sin(arg))
    if derivative == 1:
        return np.asarray(b * (growing - falling + np.sin(arg) + s * np.cos(arg)))
    return np.asarray(b**2 * (growing + falling + np.cos(arg) - s * np.sin(arg)))
