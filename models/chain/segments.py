"""A beam as a chain of rigid segments with a spring at each hinge: where they lie and what they say of the beam.

Hinges lie amid n equal stretches of length h, each with the spring E I / h. With the segments' own inertia m h^2 / 12
the chain carries waves whose frequency is wrong by (k h)^4 / 1440 only, and segment i, at the angle theta_i and the
height z_i, stands for the beam's

    w' = theta + h^2 w''' / 24    and    w = z - h^2 w'' / 24.

The first two hinges are moved so that this also holds at the clamp, up to w'''. Derivation: docs/theory.md, section 7.
"""

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from models.arrays import FloatArray

MEAN = 47.0 / 48.0
CLAMP_HINGES = (MEAN - sqrt(1.25 - MEAN**2), MEAN + sqrt(1.25 - MEAN**2))
"""Places of the first two hinges, as shares of h: their sum is 2 - 1/24, the sum of their squares 5/2."""

LEAST = 4
"""Segments at least: two at the clamp, one between, and the free end's."""


@dataclass(frozen=True)
class Segments:
    """A chain of n segments on a beam.

    Attributes:
        length: of the beam, m.
        n: segments that move; half of one more is the clamp's.
    """

    length: float
    n: int

    @property
    def h(self) -> float:
        """Length of a whole segment, m; the last one is half as long."""
        return self.length / self.n

    @cached_property
    def hinges(self) -> FloatArray:
        """(n,) m from the clamp."""
        places = np.arange(self.n) + 0.5
        places[:2] = CLAMP_HINGES
        return np.asarray(places * self.h)

    @cached_property
    def spans(self) -> FloatArray:
        """(n, 2) where each segment's mass begins and ends, m from the clamp."""
        starts = (np.arange(self.n) + 0.5) * self.h
        return np.stack([starts, np.append(starts[1:], self.length)], axis=1)

    @cached_property
    def centres(self) -> FloatArray:
        """(n,) of mass, m from the clamp."""
        return np.asarray(self.spans.mean(axis=1))

    def segment_at(self, position: float) -> int:
        """Number of the segment that spans a place; the first one also has the clamp's half."""
        return int(np.clip(np.floor(position / self.h - 0.5), 0, self.n - 1))

    def reading(self, position: float, derivative: int = 0) -> tuple[FloatArray, FloatArray]:
        """Weights (heights, slopes), each (n,), of the segments' centres in the beam's deflection or slope at a place.

        Forces act with the same weights, so that what a place is given and what it shows belong together.

        Args:
            position: m from the clamp.
            derivative: 0 deflection, 1 slope.
        """
        i = self.segment_at(position)
        if i == 0:
            return np.zeros(self.n), self._at_clamp(position, derivative)
        heights, slopes = np.zeros(self.n), np.zeros(self.n)
        heights[i] = 1.0 - derivative
        if i == self.n - 1:  # the free end is straight
            slopes[i] = 1.0 if derivative else position - self.centres[i]
            return heights, slopes
        h, away = self.h, position - self.centres[i]
        bending, shear = np.array([-0.5, 0.0, 0.5]) / h, np.array([1.0, -2.0, 1.0]) / h**2
        turn = np.array([0.0, 1.0, 0.0]) + h**2 / 24.0 * shear
        near = slice(i - 1, i + 2)
        if derivative == 0:
            slopes[near] = away * turn + (away**2 / 2.0 - h**2 / 24.0) * bending + away**3 / 6.0 * shear
        else:
            slopes[near] = turn + away * bending + away**2 / 2.0 * shear
        return heights, slopes

    def _at_clamp(self, position: float, derivative: int) -> FloatArray:
        """(n,) weights of the slopes where bending c0 + c1 x from the clamp on turns the first two segments."""
        first, both = CLAMP_HINGES[0], sum(CLAMP_HINGES)
        turned = np.array([[1.0, first * self.h], [2.0, both * self.h]]) * self.h
        power = 2 - derivative
        sought = np.array([position**power / power, position ** (power + 1) / (power * (power + 1))])
        slopes = np.zeros(self.n)
        slopes[:2] = np.linalg.solve(turned.T, sought)
        return slopes
