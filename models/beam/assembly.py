"""Mass, damping and stiffness of a beam and what is attached to it, in assumed shapes; docs/theory.md, section 2."""

from dataclasses import dataclass
from math import inf, pi, sqrt

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh

from models.arrays import FloatArray
from models.beam.basis import BeamBasis, beam_basis
from models.structure import Structure


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
    places = sorted({*loads, *(p for p in attached if p is not None)})
    basis = beam_basis(
        n_modes,
        tuple(p / length for p in places),
        tuple(h.position / length for h in structure.hinges),
        clamp_turns=structure.clamp_stiffness < inf,
    )
    n_shapes, n_absorbers = len(basis.resultant), len(structure.absorbers)
    n = n_shapes + n_absorbers
    blank = BeamMatrices(structure, basis, *(np.zeros((n, n)) for _ in range(3)), np.zeros(n), np.zeros(n))
    own_mass = np.zeros((n, n))
    own_mass[:n_shapes, :n_shapes] = basis.gram
    own_stiffness = np.zeros((n, n))
    own_stiffness[:n_shapes, :n_shapes] = _bending(structure, basis) / (line_mass * length**4)
    carried = np.zeros(n)
    carried[:n_shapes] = sqrt(line_mass * length) * basis.resultant
    for position, mass in structure.masses:
        row = blank.row(position or 0.0)
        own_mass += mass * np.outer(row, row)
        carried += mass * row
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
        omega = 2.0 * pi * absorber.frequency
        mass[number, number] = absorber.mass
        carried[number] = absorber.mass
        stiffness += absorber.mass * omega**2 * np.outer(stretch, stretch)
        damping += 2.0 * absorber.damping_ratio * omega * absorber.mass * np.outer(stretch, stretch)
    shapes = np.s_[:n_shapes, :n_shapes]
    damping[shapes] += own_damping(structure, own_mass[shapes], own_stiffness[shapes])
    return BeamMatrices(structure, basis, mass, damping, stiffness, -structure.gravity * carried, carried)


def own_damping(structure: Structure, mass: FloatArray, stiffness: FloatArray) -> FloatArray:
    """(n, n) damping of the structure itself: Rayleigh, or one loss factor for all of its modes; SI."""
    if structure.loss_factor is None:
        eta1, eta2 = structure.rayleigh
        return structure.damping_scale * (eta1 * mass + eta2 * stiffness)
    square, phi = eigh(stiffness, mass)
    momentum = mass @ phi
    rate = structure.damping_scale * structure.loss_factor * np.sqrt(np.maximum(square, 0.0))
    return np.asarray((momentum * rate) @ momentum.T)


def _bending(structure: Structure, basis: BeamBasis) -> FloatArray:
    """Stiffness of the beam itself in units of 1 / L^3 (bending, axial load, clamp, hinges)."""
    ei, length = structure.bending_stiffness, structure.length
    total = ei * basis.stiffness + structure.axial_force * length**2 * basis.slope_stiffness
    if structure.clamp_stiffness < inf:
        slope = basis.shapes(np.zeros(1), 1)[0]
        total = total + structure.clamp_stiffness * length * np.outer(slope, slope)
    for hinge, kink in zip(structure.hinges, basis.kinks(), strict=True):
        total = total + length / hinge.flexibility * np.outer(kink, kink)
    return total


def solve_static(stiffness: FloatArray, load: FloatArray) -> FloatArray:
    """Displacement under a static load, for a positive definite stiffness matrix."""
    return np.asarray(cho_solve(cho_factor(stiffness), load))
