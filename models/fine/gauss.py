"""Two-stage Gauss collocation: order 4, keeps the energy of linear motion, stable for any step.

Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II (1996), table IV.5.1.
"""

from math import sqrt

import numpy as np

from models.arrays import FloatArray

NODES = np.array([0.5 - sqrt(3.0) / 6.0, 0.5 + sqrt(3.0) / 6.0])
"""Times of the two stages as fractions of the step."""

WEIGHTS = np.array([[0.25, 0.25 - sqrt(3.0) / 6.0], [0.25 + sqrt(3.0) / 6.0, 0.25]])
"""Integrals of the stages' polynomials up to each stage; over the whole step each is 1/2."""

ORDER = 4

for _power in range(1, ORDER + 1):
    if abs(0.5 * np.sum(NODES ** (_power - 1)) - 1.0 / _power) > 1e-15:
        _message = f"the stages of Gauss collocation miss the condition of order {_power}"
        raise ArithmeticError(_message)


def modal_steps(omega: FloatArray, damping: FloatArray, h: float) -> tuple[FloatArray, FloatArray]:
    """One step of q'' + damping q' + omega^2 q = u for many modes at once.

    Args:
        omega: (n,) natural circular frequencies, rad/s; 0 for a free mass.
        damping: (n,) 1/s.
        h: step, s.

    Returns:
        (2, 4, n): q and q' at the end, and (2, 2, 4, n): q and q' at each stage, both by q and q' at the start and u at
        the two stages.
    """
    n = len(omega)
    system = np.zeros((n, 2, 2))
    system[:, 0, 1], system[:, 1, 0], system[:, 1, 1] = 1.0, -(omega**2), -damping
    given = np.zeros((n, 2, 2, 4))  # slope of the state at each stage, were the state that of the start
    given[:, :, :, :2] = system[:, None]
    given[:, 0, 1, 2] = given[:, 1, 1, 3] = 1.0
    coupled = np.eye(4) - h * np.einsum("ij,nab->niajb", WEIGHTS, system).reshape(n, 4, 4)
    slopes = np.linalg.solve(coupled, given.reshape(n, 4, 4)).reshape(n, 2, 2, 4)
    start = np.zeros((2, 4))
    start[0, 0] = start[1, 1] = 1.0
    stages = start + h * np.einsum("ij,njac->niac", WEIGHTS, slopes)
    end = start + 0.5 * h * slopes.sum(axis=1)
    return np.ascontiguousarray(end.transpose(1, 2, 0)), np.ascontiguousarray(stages.transpose(1, 2, 3, 0))
