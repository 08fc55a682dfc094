"""Forces spread along the beam, as forces at Gauss points."""

from functools import lru_cache

import numpy as np


@lru_cache(maxsize=64)
def along(length: float, n: int) -> tuple[tuple[float, float], ...]:
    """(position, stretch) of n Gauss points, m, so that a sum over them stands for an integral along the beam.

    Args:
        length: of the beam, m.
        n: points; the sum is exact for polynomials up to degree 2 n - 1.
    """
    node, weight = np.polynomial.legendre.leggauss(n)
    return tuple(zip((0.5 * length * (1.0 + node)).tolist(), (0.5 * length * weight).tolist(), strict=True))
