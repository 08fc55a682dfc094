"""Shapes and small-motion matrices of planar ANCF cable elements: what Exudyn forms inside, for all that it does not.

An element's displacement is cubic in both directions, with the nodes' displacements and changes of the slope vector as
coordinates. Source: J. Gerstmayr, A. A. Shabana, Nonlinear Dyn. 45 (2006) 109, equations 1 to 8.
"""

from math import inf

import numpy as np

from models.arrays import FloatArray
from models.fine.finite_elements import hermite
from models.structure import Structure

OWN = 4
"""Coordinates of a node: displacements x and y, and changes of the slope vector's x and y."""

ALONG, UP = [0, 2, 4, 6], [1, 3, 5, 7]
"""Coordinates of an element that move it along the beam, and upwards."""

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


def both_ways(shape: FloatArray) -> FloatArray:
    """(2, 8) displacements along and upwards of an element by its coordinates, from its four cubic shapes."""
    rows = np.zeros((2, 2 * OWN))
    rows[0, ALONG] = rows[1, UP] = shape
    return rows


def gauss_points(h: float) -> list[tuple[float, float]]:
    """Places, as shares of an element of length h, m, and their weights, m."""
    places, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    return [(float(0.5 * (s + 1.0)), float(0.5 * h * w)) for s, w in zip(places, weights, strict=True)]


def attached_mass(structure: Structure, nodes: FloatArray) -> FloatArray:
    """(n, n) mass of the points on the beam, kg."""
    total = np.zeros((OWN * len(nodes), OWN * len(nodes)))
    for position, mass in structure.masses:
        k, shape = shape_at(nodes, position or 0.0, 0)
        rows, own = both_ways(shape), slice(OWN * k, OWN * (k + 2))
        total[own, own] += mass * rows.T @ rows
    return total


def small_motion(structure: Structure, nodes: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Mass, damping, stiffness of what is attached, and inertia against a moving base, about the straight beam.

    Absorbers' coordinates, their displacements upwards, come last. Stretching is left out of the damping: a beam that
    turns without stretching shortens along x, and only Exudyn's own measure, |r'| - 1, tells one from the other.
    """
    size, hung = OWN * len(nodes), structure.absorbers
    n, beam = size + len(hung), slice(0, size)
    mass, damping, attached = np.zeros((3, n, n))
    mass[beam, beam] = attached_mass(structure, nodes)
    eta1, eta2 = (structure.damping_scale * eta for eta in structure.rayleigh)
    for k, h in enumerate(np.diff(nodes)):
        own = slice(OWN * k, OWN * (k + 2))
        for s, weight in gauss_points(h):
            rows = both_ways(hermite(s, h, 0))
            bend = both_ways(hermite(s, h, 2))[1]
            mass[own, own] += weight * structure.line_mass * rows.T @ rows
            damping[own, own] += eta2 * weight * structure.bending_stiffness * np.outer(bend, bend)
    damping += eta1 * mass
    if structure.clamp_stiffness < inf:
        attached[OWN - 1, OWN - 1] = structure.clamp_stiffness
        damping[OWN - 1, OWN - 1] += eta2 * structure.clamp_stiffness
    for number, absorber in enumerate(hung, start=size):
        k, shape = shape_at(nodes, absorber.position or 0.0, 0)
        stretch = np.zeros(n)
        stretch[OWN * k + np.array(UP)], stretch[number] = -shape, 1.0
        mass[number, number] = absorber.mass
        spring, dashpot = absorber.coefficients
        attached += spring * np.outer(stretch, stretch)
        damping += dashpot * np.outer(stretch, stretch)
    upwards = np.append(np.tile([0.0, 1.0, 0.0, 0.0], len(nodes)), np.ones(len(hung)))
    return mass, damping, attached, mass @ upwards
