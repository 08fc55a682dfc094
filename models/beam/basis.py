"""The assumed shapes of a cantilever: clamped-free modes and the static shapes that plain truncation lacks.

Everything here is for unit length, bending stiffness and mass per length, so that one basis serves all values of E, rho
and diameter. The static shapes are exact deflections: under a unit load at each place where a force can act, under the
beam's own weight, a rotation of the clamp, and a kink at each hinge. What the modes already hold is taken out of them;
what is left is made orthonormal: the plain beam's mass matrix is the identity and its stiffness matrix diagonal.
Source: residual vectors, R. R. Craig, A. J. Kurdila, Fundamentals of Structural Dynamics (2006), section 17.6.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

from models.arrays import FloatArray
from models.beam.clamped_free import clamped_free_modes, wave_numbers

DROP = 1e-12
"""Static shapes whose strain energy, beyond the modes and each other, is a smaller share than this add nothing."""


@dataclass(frozen=True, eq=False)
class BeamBasis:
    """Shapes on 0..1; see ``beam_basis``.

    Attributes:
        n_modes: clamped-free modes among the raw shapes.
        loads: places of the unit loads.
        hinges: places of the kinks.
        clamp_turns: whether a rotation of the clamp is among the shapes.
        combine: (n_raw, n) raw shapes -> basis.
        gram: (n, n) integral of the product of shapes: the identity but for the strain-free shapes.
        stiffness: (n, n) of the plain beam (bending only; a rotating clamp or a kink costs nothing yet).
        slope_stiffness: (n, n) integral of the product of slopes, for axial loads.
        resultant: (n,) integral of each shape.
    """

    n_modes: int
    loads: tuple[float, ...]
    hinges: tuple[float, ...]
    clamp_turns: bool
    combine: FloatArray
    gram: FloatArray
    stiffness: FloatArray
    slope_stiffness: FloatArray
    resultant: FloatArray

    def shapes(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """(m, n) values (or first, second derivatives) of the shapes at x, (m,) on 0..1."""
        raw = _raw_shapes(np.atleast_1d(np.asarray(x, float)), self, derivative)
        return np.asarray(raw @ self.combine)

    def row(self, x: float, derivative: int = 0) -> FloatArray:
        """(n,) the same at one place, kept for the next model with this basis; not to be written to."""
        return _row(self, x, derivative)

    def turn(self) -> FloatArray:
        """(n,) rotation of each shape at a clamp that turns."""
        return np.asarray(self.combine[self.combine.shape[0] - len(self.hinges) - 1])

    def kinks(self) -> FloatArray:
        """(n_hinges, n) jump of slope of each shape at each hinge."""
        n_raw = self.combine.shape[0]
        return self.combine[n_raw - len(self.hinges) :]


@lru_cache(maxsize=8192)
def _row(basis: BeamBasis, x: float, derivative: int) -> FloatArray:
    row = np.asarray(basis.shapes(np.array([x]), derivative)[0])
    row.setflags(write=False)
    return row


@lru_cache(maxsize=512)
def beam_basis(n_modes: int, loads: tuple[float, ...], hinges: tuple[float, ...], *, clamp_turns: bool) -> BeamBasis:
    """The basis for these places, on 0..1.

    Args:
        n_modes: clamped-free modes.
        loads: where forces act.
        hinges: where the beam may have a kink.
        clamp_turns: include the rotation about the clamp.
    """
    places = (n_modes, loads, hinges, clamp_turns)
    none = np.empty((0, 0))
    raw_basis = BeamBasis(*places, combine=none, gram=none, stiffness=none, slope_stiffness=none, resultant=np.empty(0))
    x, weight = _quadrature(n_modes, (*loads, *hinges))
    value, slope, curvature = (_raw_shapes(x, raw_basis, d) for d in (0, 1, 2))
    root = np.sqrt(weight)[:, None]
    combine = _orthonormal(root * value, root * curvature, n_modes, free=len(hinges) + clamp_turns)
    moving, turning, bending = (root * (shape @ combine) for shape in (value, slope, curvature))
    return BeamBasis(
        *places,
        combine=combine,
        gram=moving.T @ moving,
        stiffness=bending.T @ bending,
        slope_stiffness=turning.T @ turning,
        resultant=weight @ (value @ combine),
    )


def _orthonormal(value: FloatArray, curvature: FloatArray, n_modes: int, free: int) -> FloatArray:
    """(n_raw, n) modes as they are, then static shapes without their share of the modes, then the strain-free shapes.

    The inner products are formed after the modes are taken out: what is left is small, and so would drown in round-off.
    """
    n_raw = value.shape[1]
    n_static = n_raw - n_modes - free
    static = np.eye(n_raw)[:, n_modes : n_modes + n_static]
    static[:n_modes] = -value[:, :n_modes].T @ value[:, n_modes : n_modes + n_static]
    strain = curvature @ static
    full = np.linalg.norm(curvature[:, n_modes : n_modes + n_static], axis=0)
    energy, direction = eigh(strain.T @ strain / np.outer(full, full))
    keep = energy > DROP
    static = static @ (direction[:, keep] / full[:, None]) / np.sqrt(energy[keep])
    left = value @ static
    inertia, direction = eigh(left.T @ left)
    static = static @ (direction / np.sqrt(inertia))
    return np.hstack([np.eye(n_raw, n_modes), static, np.eye(n_raw)[:, n_raw - free :]])


def _raw_shapes(x: FloatArray, basis: BeamBasis, derivative: int) -> FloatArray:
    columns = [clamped_free_modes(x, basis.n_modes, derivative)]
    columns += [_unit_load(x, a, derivative)[:, None] for a in basis.loads]
    columns.append(_own_weight(x, derivative)[:, None])
    if basis.clamp_turns:
        columns.append([x, np.ones_like(x), np.zeros_like(x)][derivative][:, None])
    columns += [_kink(x, a, derivative)[:, None] for a in basis.hinges]
    return np.hstack(columns)


def _unit_load(x: FloatArray, a: float, derivative: int) -> FloatArray:
    near = np.minimum(x, a)
    if derivative == 0:
        return near**2 * (3.0 * np.maximum(x, a) - near) / 6.0
    return near * (a - 0.5 * near) if derivative == 1 else a - near


def _own_weight(x: FloatArray, derivative: int) -> FloatArray:
    if derivative == 0:
        return x**2 * (6.0 - 4.0 * x + x**2) / 24.0
    return x * (3.0 - 3.0 * x + x**2) / 6.0 if derivative == 1 else 0.5 * (1.0 - x) ** 2


def _kink(x: FloatArray, a: float, derivative: int) -> FloatArray:
    if derivative == 0:
        return np.maximum(x - a, 0.0)
    return (x > a).astype(float) if derivative == 1 else np.zeros_like(x)


def _quadrature(n_modes: int, breaks: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights between breaks, several to the shortest wave: products are exact to round-off."""
    edges = np.unique(np.clip([0.0, *breaks, 1.0], 0.0, 1.0))
    points, weights = [], []
    for start, end in pairwise(edges):
        phase = (end - start) * float(wave_numbers(n_modes)[-1])
        node, weight = _gauss(int(1.2 * phase) + 12)
        points.append(start + (end - start) * node)
        weights.append((end - start) * weight)
    return np.concatenate(points), np.concatenate(weights)


@lru_cache(maxsize=256)
def _gauss(n: int) -> tuple[FloatArray, FloatArray]:
    node, weight = np.polynomial.legendre.leggauss(n)
    return 0.5 * (node + 1.0), 0.5 * weight
