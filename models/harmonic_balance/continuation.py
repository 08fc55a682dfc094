"""Following a curve of solutions around its folds by pseudo-arclength, with steps as long as Newton's method allows.

Slopes are found once a point, where it is first guessed: a quasi-Newton method improves them on the way, since what is
left of the equations is far cheaper to find than slopes are.

Sources: R. Seydel, Practical Bifurcation and Stability Analysis (2010), chapter 4; P. Deuflhard, Newton Methods for
Nonlinear Problems (2004), section 2.1.4 for the quasi-Newton method QNERR (Broyden's good updates), chapter 5 for steps
by contraction.
"""

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from models.arrays import FloatArray

TOLERANCE = 1e-9
"""Of a point, in the curve's own units."""

ROUND_OFF = 1e-13
"""A correction so small says nothing more."""

SLOWEST = 0.5
"""What a quasi-Newton correction may leave of the one before; more, and slopes are found anew."""

WANTED = 0.05
"""What a first correction is to leave: steps grow or shrink towards it."""

MOST_ITERATIONS = 10
"""A point that needs more is sought again closer by."""

MOST_HALVINGS = 6
"""Of a correction that leads further away."""

SHARPEST_TURN = 0.8
"""Cosine between the directions of two neighbouring points below which the step was too long."""

CORNER = 1e-4
"""Length of a step below which the curve may turn by up to a right angle: where a dashpot begins to touch it bends."""

STEPS = (1e-8, 0.02, 0.1)
"""Least, first and longest step, in the curve's own units."""


class Curve(Protocol):
    """m equations for m + 1 numbers."""

    def residual(self, u: FloatArray) -> FloatArray:
        """(m,) what is left of the equations at a point."""

    def slopes(self, u: FloatArray) -> FloatArray:
        """(m, m + 1) slopes of what is left."""


@dataclass(frozen=True, eq=False)
class Slopes:
    """Factorised slopes, with the plane in which one corrects as their last row.

    Attributes:
        factors: (m + 1, m + 1) lower and upper triangle of the transposed matrix.
        swaps: (m + 1,) of its rows.
    """

    factors: FloatArray
    swaps: NDArray[np.int32]

    @classmethod
    def of(cls, slopes: FloatArray, normal: FloatArray) -> Self | None:
        """Of (m, m + 1) slopes and the plane's normal; None where they have no inverse."""
        factors, swaps, info = dgetrf(np.vstack([slopes, normal]).T, overwrite_a=True)
        return None if info != 0 else cls(factors, swaps)

    def correction(self, residual: FloatArray) -> FloatArray:
        """(m + 1,) that would take away what is left, within the plane."""
        return -self._solved(np.append(residual, 0.0))

    @property
    def direction(self) -> FloatArray:
        """(m + 1,) of the curve, of length 1, to the side of the plane's normal."""
        ahead = np.zeros(len(self.swaps))
        ahead[-1] = 1.0
        along = self._solved(ahead)
        return along / np.linalg.norm(along)

    def _solved(self, right: FloatArray) -> FloatArray:
        return np.asarray(dgetrs(self.factors, self.swaps, right, trans=1)[0])


@dataclass(frozen=True, eq=False)
class Point:
    """A solution on the curve.

    Attributes:
        u: (m + 1,) in the curve's own units.
        direction: (m + 1,) of the curve, of length 1, where the slopes were last found.
        contraction: what the first correction left of itself.
    """

    u: FloatArray
    direction: FloatArray
    contraction: float


def corrected(curve: Curve, guess: FloatArray, direction: FloatArray, *, in_corner: bool = False) -> Point | None:
    """The solution in the plane through a guess at right angles to a direction; None where Newton's method fails.

    Args:
        curve: the equations.
        guess: (m + 1,) near the curve.
        direction: (m + 1,) of the plane's normal, to whose side the new direction turns.
        in_corner: slopes change so fast that those at the guess do not serve, and the direction is that at the end.
    """
    slopes = Slopes.of(curve.slopes(guess), direction)
    if slopes is None:
        return None
    return _by_newton(curve, guess, direction, slopes) if in_corner else _by_quasi_newton(curve, guess, slopes)


def _by_quasi_newton(curve: Curve, guess: FloatArray, slopes: Slopes) -> Point | None:
    """By slopes found once; None where corrections do not shrink as they should."""
    u, first = guess, None
    steps = [slopes.correction(curve.residual(guess))]
    squares = [float(steps[0] @ steps[0])]
    for _ in range(MOST_ITERATIONS):
        u = u + steps[-1]
        if squares[-1] < (ROUND_OFF * (1.0 + float(np.linalg.norm(u)))) ** 2:
            return Point(u, slopes.direction, first or 0.0)
        ahead = slopes.correction(curve.residual(u))
        for before, after, square in zip(steps[:-1], steps[1:], squares[:-1], strict=True):
            ahead += (ahead @ before) / square * after
        contraction = float(np.sqrt(ahead @ ahead / squares[-1]))
        if not contraction < SLOWEST:
            return None
        first = contraction if first is None else first
        steps.append(ahead / (1.0 - float(ahead @ steps[-1]) / squares[-1]))
        squares.append(float(steps[-1] @ steps[-1]))
        if contraction * np.sqrt(squares[-1]) < TOLERANCE * (1.0 + float(np.linalg.norm(u))):
            return Point(u + steps[-1], slopes.direction, first)
    return None


def _by_newton(curve: Curve, guess: FloatArray, direction: FloatArray, slopes: Slopes | None) -> Point | None:
    """By slopes found after every step, which is halved while more is left after it than before."""
    u, residual, sizes = guess, curve.residual(guess), list[float]()
    for _ in range(MOST_ITERATIONS):
        if slopes is None:
            return None
        step, left = slopes.correction(residual), float(np.linalg.norm(residual))
        sizes.append(float(np.linalg.norm(step)))
        if not np.isfinite(sizes[-1]):
            return None
        if sizes[-1] < TOLERANCE * (1.0 + np.linalg.norm(u)):
            first = sizes[1] / sizes[0] if len(sizes) > 1 and sizes[0] > 0.0 else 0.0
            return Point(u + step, slopes.direction, first)
        residual = curve.residual(u + step)
        for _ in range(MOST_HALVINGS):
            if np.linalg.norm(residual) <= left:
                break
            # A contact that just touches has two slopes; the longer way led past the corner.
            step = 0.5 * step
            residual = curve.residual(u + step)
        u = u + step
        slopes = Slopes.of(curve.slopes(u), direction)
    return None


def next_step(step: float, contraction: float) -> float:
    """Length of the next step after one of ``step`` whose first correction left so much of itself."""
    return float(
        np.clip(step * np.clip(np.sqrt(WANTED / max(contraction, WANTED / 4.0)), 0.5, 2.0), STEPS[0], STEPS[2])
    )
