"""Euler-Bernoulli beam elements with cubic shapes and consistent mass, on the mesh of ``models.fine.mesh``.

Springs, dashpots and absorbers are not in these matrices: they act through the ports like every other point force
(``models.fine.doors``), so that the damping of the beam itself stays diagonal in its modes.
Source: R. D. Cook et al., Concepts and Applications of Finite Element Analysis (2002), sections 2.3, 11.3 and 18.2.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import inf

import numpy as np
from scipy.linalg import eigh

from models.arrays import FloatArray, IntArray
from models.errors import NoRestError
from models.structure import Structure

TOUCH = 1e-9
"""Two places closer than this share of the length are one."""


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """The beam with its masses, clamp, axial force and hinges, without springs, dashpots, absorbers and sleeves.

    Attributes:
        structure: what is discretised.
        nodes: (n_nodes,) m from the clamp.
        dofs: (n_elements, 4) deflection and slope at the left, then at the right end; -1 where the clamp holds it. A
            hinge gives its node a slope on each side.
        mass, stiffness: (n, n), SI.
        bending: (n, n) share of the beam's own bending in the stiffness: what grows with E I.
        carried: (n,) inertia against an acceleration of the base, kg.
    """

    structure: Structure
    nodes: FloatArray
    dofs: IntArray
    mass: FloatArray = field(repr=False)
    stiffness: FloatArray = field(repr=False)
    bending: FloatArray = field(repr=False)
    carried: FloatArray = field(repr=False)

    def row(self, position: float, derivative: int = 0) -> FloatArray:
        """(n,) deflection, slope or curvature at a place, m from the clamp; on a node the mean of its two sides."""
        return _row(self.nodes, self.dofs, len(self.carried), position, derivative)

    @cached_property
    def modes(self) -> tuple[FloatArray, FloatArray]:
        """(n,) natural circular frequencies, rad/s, ascending, and (n, n) mass-normalised shapes.

        The inverse problem is solved, whose large eigenvalues, the low modes, keep all their digits.

        Raises:
            NoRestError: an axial force beyond the buckling load.
        """
        try:
            inverse_square, shapes = eigh(self.mass, self.stiffness)
        except np.linalg.LinAlgError:
            raise NoRestError(
                f"axial_load: force = {self.structure.axial_force:g} N",
                "a beam carries less compression than its buckling load",
                "take a smaller compression",
            ) from None
        omega = 1.0 / np.sqrt(inverse_square[::-1])
        return omega, shapes[:, ::-1] * omega

    def damping(self) -> FloatArray:
        """(n,) modal damping 2 zeta omega of the beam itself, 1/s: Rayleigh, or one loss factor for all modes."""
        omega, _ = self.modes
        if self.structure.loss_factor is not None:
            return np.asarray(self.structure.damping_scale * self.structure.loss_factor * omega)
        eta1, eta2 = self.structure.rayleigh
        return self.structure.damping_scale * (eta1 + eta2 * omega**2)


def assemble(structure: Structure, nodes: FloatArray) -> FiniteElements:
    """Mass and stiffness of a beam on a mesh.

    Args:
        structure: a beam with its attachments.
        nodes: (n_nodes,) m from the clamp; each hinge sits on the nearest one.
    """
    hinged = {int(np.argmin(np.abs(nodes - hinge.position))): hinge.flexibility for hinge in structure.hinges}
    hinged.pop(len(nodes) - 1, None)  # beyond the free end nothing bends
    dofs, joints, n = _number(len(nodes), set(hinged), turns=structure.clamp_stiffness < inf)
    (mass, stiffness, bending), carried = np.zeros((3, n, n)), np.zeros(n)
    for element, h in zip(dofs, np.diff(nodes), strict=True):
        held = element >= 0
        own, at = element[held], np.ix_(element[held], element[held])
        element_mass = structure.line_mass * h / 420.0 * _mass_shape(h)
        bent = structure.bending_stiffness / h**3 * _bending_shape(h)
        stretch = bent + structure.axial_force / (30.0 * h) * _axial_shape(h)
        mass[at] += element_mass[np.ix_(held, held)]
        bending[at] += bent[np.ix_(held, held)]
        stiffness[at] += stretch[np.ix_(held, held)]
        carried[own] += (element_mass @ np.array([1.0, 0.0, 1.0, 0.0]))[held]
    if structure.clamp_stiffness < inf:
        stiffness[0, 0] += structure.clamp_stiffness
    for node, flexibility in hinged.items():
        jump = np.zeros(n)
        for dof, sign in zip(joints[node], (-1.0, 1.0), strict=True):
            if dof >= 0:
                jump[dof] = sign
        stiffness += np.outer(jump, jump) / flexibility
    for position, point_mass in structure.masses:
        row = _row(nodes, dofs, n, position or 0.0, 0)
        mass += point_mass * np.outer(row, row)
        carried += point_mass * row
    return FiniteElements(structure, nodes, dofs, mass, stiffness, bending, carried)


def _number(n_nodes: int, hinged: set[int], *, turns: bool) -> tuple[IntArray, dict[int, tuple[int, int]], int]:
    """Degrees of freedom of each element, the two slopes of each hinged node, and how many there are in all."""
    dofs = np.full((n_nodes - 1, 4), -1, np.int64)
    joints: dict[int, tuple[int, int]] = {}
    n = 0
    for node in range(n_nodes):
        deflection, slope = (-1, -1)
        if node > 0:
            deflection, n = n, n + 1
        if node > 0 or turns:
            slope, n = n, n + 1
        after = slope
        if node in hinged:
            after, n = n, n + 1
            joints[node] = (slope, after)
        if node > 0:
            dofs[node - 1, 2:] = deflection, slope
        if node < n_nodes - 1:
            dofs[node, :2] = deflection, after
    return dofs, joints, n


def _row(nodes: FloatArray, dofs: IntArray, n: int, position: float, derivative: int) -> FloatArray:
    near = TOUCH * nodes[-1]
    row = np.zeros(n + 1)  # the last entry collects what the clamp holds
    touching = np.flatnonzero((nodes[:-1] - near <= position) & (position <= nodes[1:] + near))
    for element in touching:
        h = nodes[element + 1] - nodes[element]
        row[dofs[element]] += hermite((position - nodes[element]) / h, h, derivative) / len(touching)
    return row[:n]


def hermite(s: float, h: float, derivative: int) -> FloatArray:
    """(4,) cubic shapes at the fraction s of an element of length h."""
    if derivative == 0:
        return np.array([1 - 3 * s**2 + 2 * s**3, h * s * (1 - s) ** 2, 3 * s**2 - 2 * s**3, h * s**2 * (s - 1)])
    if derivative == 1:
        return np.array([6 * s * (s - 1) / h, 1 - 4 * s + 3 * s**2, 6 * s * (1 - s) / h, 3 * s**2 - 2 * s])
    return np.array([(12 * s - 6) / h**2, (6 * s - 4) / h, (6 - 12 * s) / h**2, (6 * s - 2) / h])


def _mass_shape(h: float) -> FloatArray:
    return np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h**2, 13 * h, -3 * h**2],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
        ]
    )


def _bending_shape(h: float) -> FloatArray:
    return np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h**2, -6 * h, 2 * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h**2, -6 * h, 4 * h**2],
        ]
    )


def _axial_shape(h: float) -> FloatArray:
    return np.array(
        [
            [36, 3 * h, -36, 3 * h],
            [3 * h, 4 * h**2, -3 * h, -(h**2)],
            [-36, -3 * h, 36, -3 * h],
            [3 * h, -(h**2), -3 * h, 4 * h**2],
        ]
    )
