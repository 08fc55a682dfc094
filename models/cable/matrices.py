"""Shapes and small-motion matrices of ANCF cable elements: what Exudyn forms inside, for all that it does not.

An element's displacement is cubic in every direction, with the nodes' displacements and changes of the slope vector as
coordinates. Source: J. Gerstmayr, A. A. Shabana, Nonlinear Dyn. 45 (2006) 109, equations 1 to 8.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from models.arrays import FloatArray
from models.fine.finite_elements import hermite
from models.structure import Structure

ALONG, UP, ACROSS = range(3)
"""Ways that a point of the beam can go: x, y, and out of the rig's plane z."""


@dataclass(frozen=True)
class Layout:
    """How Exudyn numbers the coordinates of a node: its displacements, then the changes of its slope vector.

    Attributes:
        ways: 2 in the plane, 3 in space.
    """

    ways: int

    @property
    def own(self) -> int:
        """Coordinates of a node."""
        return 2 * self.ways

    @property
    def turning(self) -> tuple[int, ...]:
        """Coordinates of a node that turn it away from the x axis."""
        return tuple(range(self.ways + UP, self.own))

    @property
    def fixed(self) -> tuple[int, ...]:
        """Coordinates of a node that displace it."""
        return tuple(range(self.ways))

    def of_element(self, way: int) -> list[int]:
        """Coordinates of an element that move it one way, in the order of the four cubic shapes."""
        return [way, self.ways + way, self.own + way, self.own + self.ways + way]

    def rows(self, shape: FloatArray) -> FloatArray:
        """(ways, 2 own) displacements of an element by its coordinates, from its four cubic shapes."""
        rows = np.zeros((self.ways, 2 * self.own))
        for way, row in enumerate(rows):
            row[self.of_element(way)] = shape
        return rows


PLANE, SPACE = Layout(2), Layout(3)

GAUSS_POINTS = 4
"""Per element: exact for the products of cubic shapes, and for an element's strain energy but for its sixth power."""


def axial_stiffness(structure: Structure) -> float:
    """E A of a solid round section, N."""
    return 16.0 * structure.bending_stiffness / structure.diameter**2


def shape_at(nodes: FloatArray, position: float, derivative: int) -> tuple[int, FloatArray]:
    """Number of the element at a place, and its four cubic shapes, or their derivatives, there."""
    k = int(np.clip(np.searchsorted(nodes, position, side="right") - 1, 0, len(nodes) - 2))
    h = nodes[k + 1] - nodes[k]
    return k, hermite((position - nodes[k]) / h, h, derivative)


def gauss_points(h: float) -> list[tuple[float, float]]:
    """Places, as shares of an element of length h, m, and their weights, m."""
    places, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    return [(float(0.5 * (s + 1.0)), float(0.5 * h * w)) for s, w in zip(places, weights, strict=True)]


def attached_mass(structure: Structure, nodes: FloatArray, layout: Layout) -> FloatArray:
    """(n, n) mass of the points on the beam, kg."""
    total = np.zeros((layout.own * len(nodes), layout.own * len(nodes)))
    for position, mass in structure.masses:
        k, shape = shape_at(nodes, position or 0.0, 0)
        rows, own = layout.rows(shape), slice(layout.own * k, layout.own * (k + 2))
        total[own, own] += mass * rows.T @ rows
    return total


def small_motion(
    structure: Structure, nodes: FloatArray, layout: Layout
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Mass, damping, stiffness of what is attached, and inertia against a moving base, about the straight beam.

    Absorbers' coordinates, their displacements upwards, come last. Stretching is left out of the damping: a beam that
    turns without stretching shortens along x, and only Exudyn's own measure, |r'| - 1, tells one from the other.
    """
    size, hung = layout.own * len(nodes), structure.absorbers
    n, beam = size + len(hung), slice(0, size)
    mass, damping, attached = np.zeros((3, n, n))
    mass[beam, beam] = attached_mass(structure, nodes, layout)
    eta1, eta2 = (structure.damping_scale * eta for eta in structure.rayleigh)
    for k, h in enumerate(np.diff(nodes)):
        own = slice(layout.own * k, layout.own * (k + 2))
        for s, weight in gauss_points(h):
            rows = layout.rows(hermite(s, h, 0))
            bend = layout.rows(hermite(s, h, 2))[UP:]
            mass[own, own] += weight * structure.line_mass * rows.T @ rows
            damping[own, own] += eta2 * weight * structure.bending_stiffness * bend.T @ bend
    damping += eta1 * mass
    if structure.clamp_stiffness < inf:
        for turning in layout.turning:
            attached[turning, turning] = structure.clamp_stiffness
            damping[turning, turning] += eta2 * structure.clamp_stiffness
    for number, absorber in enumerate(hung, start=size):
        k, shape = shape_at(nodes, absorber.position or 0.0, 0)
        stretch = np.zeros(n)
        stretch[layout.own * k + np.array(layout.of_element(UP))], stretch[number] = -shape, 1.0
        mass[number, number] = absorber.mass
        spring, dashpot = absorber.coefficients
        attached += spring * np.outer(stretch, stretch)
        damping += dashpot * np.outer(stretch, stretch)
    upwards = np.append(np.tile(np.eye(layout.own)[UP], len(nodes)), np.ones(len(hung)))
    return mass, damping, attached, mass @ upwards
