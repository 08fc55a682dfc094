"""Mass, damping and stiffness of a beam and what is attached to it, in assumed shapes; docs/theory.md, section 2."""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh

from models.arrays import FloatArray
from models.beam.basis import BeamBasis, beam_basis
from models.errors import NoRestError
from models.structure import Hinge, Structure


@dataclass(frozen=True, eq=False)
class BeamMatrices:
    """The linear beam without sleeves in n Ritz coordinates (assumed shapes, then one per absorber).

    Attributes:
        structure: what was assembled.
        basis: the assumed shapes on 0..1.
        mass, damping, stiffness: (n, n), SI.
        weight: (n,) generalised force of gravity acting downwards, N.
        carried: (n,) generalised inertia against an acceleration of the base, kg: minus this times a(t) is the load.
    """

    structure: Structure
    basis: BeamBasis
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    weight: FloatArray
    carried: FloatArray

    def row(self, position: float, derivative: int = 0) -> FloatArray:
        """(n,) displacement, slope or curvature at a place, m from the clamp, by Ritz coordinate."""
        length = self.structure.length
        shape = self.basis.row(position / length, derivative) / length**derivative
        shape = shape / sqrt(self.structure.line_mass * length)
        return np.concatenate([shape, np.zeros(len(self.structure.absorbers))])

    @property
    def bending(self) -> FloatArray:
        """(n, n) share of the beam's own bending in the stiffness: what grows with E I."""
        structure, n_shapes = self.structure, len(self.basis.resultant)
        share = np.zeros_like(self.stiffness)
        share[:n_shapes, :n_shapes] = self.basis.stiffness
        return share * (structure.bending_stiffness / (structure.line_mass * structure.length**4))


def assemble_beam(structure: Structure, n_modes: int, loads: tuple[float, ...]) -> BeamMatrices:
    """Ritz matrices with ``n_modes`` clamped-free modes and the static shapes of all places where forces act.

    Args:
        structure: beam and attachments.
        n_modes: clamped-free modes in the basis, more than will be kept.
        loads: positions of point laws, contacts and the excitation, m.
    """
    length, line_mass = structure.length, structure.line_mass
    attached = [p for p, _ in (*structure.masses, *structure.springs, *structure.dashpots)]
    attached += [a.position for a in structure.absorbers]
    hinges = tuple(h for h in structure.hinges if h.flexibility > 0.0)
    places = sorted({*loads, *(p for p in attached if p is not None)})
    basis = beam_basis(
        n_modes,
        tuple(p / length for p in places),
        tuple(h.position / length for h in hinges),
        clamp_turns=structure.clamp_stiffness < inf,
    )
    n_shapes, n_absorbers = len(basis.resultant), len(structure.absorbers)
    n = n_shapes + n_absorbers
    square, row = np.zeros((n, n)), np.zeros(n)
    blank = BeamMatrices(structure, basis, square, square, square, row, row)
    own_mass = np.zeros((n, n))
    own_mass[:n_shapes, :n_shapes] = basis.gram
    own_stiffness = np.zeros((n, n))
    own_stiffness[:n_shapes, :n_shapes] = _bending(structure, hinges, basis) / (line_mass * length**4)
    carried = np.zeros(n)
    carried[:n_shapes] = sqrt(line_mass * length) * basis.resultant
    for position, point_mass in structure.masses:
        row = blank.row(position or 0.0)
        own_mass += point_mass * np.outer(row, row)
        carried += point_mass * row
    mass, stiffness = own_mass.copy(), own_stiffness.copy()
    damping = np.zeros((n, n))
    for position, constant in structure.springs:
        row = blank.row(position or 0.0)
        stiffness += constant * np.outer(row, row)
    for position, constant in structure.dashpots:
        row = blank.row(position or 0.0)
        damping += constant * np.outer(row, row)
    for number, absorber in enumerate(structure.absorbers, start=n_shapes):
        stretch = -blank.row(absorber.position or 0.0)
        stretch[number] = 1.0
        spring, dashpot = absorber.coefficients
        mass[number, number] = absorber.mass
        carried[number] = absorber.mass
        stiffness += spring * np.outer(stretch, stretch)
        damping += dashpot * np.outer(stretch, stretch)
    shapes = np.s_[:n_shapes, :n_shapes]
    damping[shapes] += own_damping(structure, own_mass[shapes], own_stiffness[shapes])
    return BeamMatrices(structure, basis, mass, damping, stiffness, -structure.gravity * carried, carried)


def own_damping(structure: Structure, mass: FloatArray, stiffness: FloatArray) -> FloatArray:
    """(n, n) damping of the structure itself: Rayleigh, or one loss factor for all of its modes; SI."""
    if structure.loss_factor is None:
        eta1, eta2 = structure.rayleigh
        return structure.damping_scale * (eta1 * mass + eta2 * stiffness)
    square, phi = natural_modes(stiffness, mass)
    momentum = mass @ phi
    rate = structure.damping_scale * structure.loss_factor * np.sqrt(square)
    return np.asarray((momentum * rate) @ momentum.T)


def _bending(structure: Structure, hinges: tuple[Hinge, ...], basis: BeamBasis) -> FloatArray:
    """Stiffness of the beam itself in units of 1 / L^3 (bending, axial load, clamp, hinges)."""
    ei, length = structure.bending_stiffness, structure.length
    total = ei * basis.stiffness + structure.axial_force * length**2 * basis.slope_stiffness
    if structure.clamp_stiffness < inf:
        total = total + structure.clamp_stiffness * length * np.outer(basis.turn(), basis.turn())
    for hinge, kink in zip(hinges, basis.kinks(), strict=True):
        total = total + length / hinge.flexibility * np.outer(kink, kink)
    return total


LEAST_INVERSE = 1e-14
"""Inverse squared frequencies below this share of the largest are round-off: such modes only yield and do not swing."""


def natural_modes(stiffness: FloatArray, mass: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n,) squared natural frequencies, the lowest first, and (n, n) mass-normalised modes in the columns.

    It is M phi = omega^-2 K phi that is solved, scaled by the diagonal of K: a spring may be as stiff as it likes.

    Raises:
        NoRestError: the structure has no stiffness against some motion.
    """
    own = np.diag(stiffness)
    if own.min() <= 0.0:
        raise _unstable()
    scale = 1.0 / np.sqrt(own)
    both = np.outer(scale, scale)
    try:
        inverse, phi = eigh(mass * both, stiffness * both)
    except LinAlgError as error:
        raise _unstable() from error
    inverse = np.maximum(inverse[::-1], LEAST_INVERSE * inverse[-1])
    return 1.0 / inverse, scale[:, None] * phi[:, ::-1] / np.sqrt(inverse)


def solve_static(stiffness: FloatArray, load: FloatArray) -> FloatArray:
    """Displacement under a static load.

    Raises:
        NoRestError: the structure has no stiffness against some motion.
    """
    try:
        return np.asarray(cho_solve(cho_factor(stiffness), load))
    except LinAlgError as error:
        raise _unstable() from error


def _unstable() -> NoRestError:
    return NoRestError(
        "the beam without its sleeves: its stiffness is not positive",
        "it resists every deflection: compression stays below pi^2 E I / (2 L)^2, and a clamp that turns has a spring",
        "look for an axial_load or a clamp_compliance that is out of scale",
    )
