"""The exact step of a linear modal system whose inputs are linear within the step.

State x = (q, q'), x' = A x + B u. A real similarity brings A to 2 x 2 blocks: one a mode where the damping is
proportional, one a pair of eigenvalues of A where it is not, so that a step costs the same for any linear system.
Source: C. F. Van Loan, IEEE Trans. Autom. Control 23 (1978) 395, for the input integrals.
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.errors import NotComputableError
from models.lanes import LANES

SERIES_NORM = 0.5
SERIES_TERMS = 14
"""Terms of the exponential's series for a matrix of that norm; the first one left out is below round-off."""

MAX_CONDITION = 1e9
"""Of the eigenvectors; beyond it two modes have merged into one defective pair."""

SPLITTING = 1e-9
"""Share of stiffness and damping by which each mode is moved away from the one before where two are one: eigenvalues
part by the root of it, so that the condition is some 1e5; frequencies stay right to a few parts in 1e8."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """A linear system x' = A x + B u in 2 x 2 real blocks; coordinates are (first of each block, second of each block).

    Attributes:
        blocks: (n, 2, 2) of A; n is a multiple of ``LANES``.
        inputs: (2n, n_inputs) B.
        from_modal: (2n, 2m) maps (q, q') of the m modes to the state.
        to_modal: (2m, 2n) maps back.
    """

    blocks: FloatArray
    inputs: FloatArray
    from_modal: FloatArray
    to_modal: FloatArray

    def displacement(self, rows: FloatArray) -> FloatArray:
        """(n_rows, 2n) displacements from the state, for rows (n_rows, m) by modal coordinate."""
        return np.asarray(rows @ self.to_modal[: rows.shape[1]])

    def velocity(self, rows: FloatArray) -> FloatArray:
        """(n_rows, 2n) velocities from the state, for rows (n_rows, m) by modal coordinate."""
        return np.asarray(rows @ self.to_modal[rows.shape[1] :])


def to_blocks(
    omega: FloatArray, damping: FloatArray, inputs: FloatArray, stiffening: FloatArray | None = None
) -> Blocks:
    """Blocks of q'' + C q' + (omega^2 + stiffening) q = inputs u.

    Args:
        omega: (m,) rad/s.
        damping: (m, m) 1/s.
        inputs: (m, n_inputs) modal force per unit input.
        stiffening: (m, m) what the stiffness has beside omega^2, 1/s^2; None for nothing.

    Raises:
        NotComputableError: two modes are one, and a slight change does not separate them.
    """
    m = len(omega)
    n = -(-m // LANES) * LANES
    blocks = np.zeros((n, 2, 2))
    if stiffening is None and np.count_nonzero(damping - np.diag(np.diag(damping))) == 0:
        speed = np.where(omega > 0.0, omega, 1.0)
        blocks[:m, 0, 1], blocks[:m, 1, 0], blocks[:m, 1, 1] = speed, -(omega**2) / speed, -np.diag(damping)
        scale = np.concatenate([np.ones(m), speed])
        basis, inverse = np.diag(scale), np.diag(1.0 / scale)
    else:
        stiffness = np.diag(omega**2) if stiffening is None else np.diag(omega**2) + stiffening
        system = np.block([[np.zeros((m, m)), np.eye(m)], [-stiffness, -damping]])
        found = _real_blocks(system)
        if found is None:
            system[m:] *= 1.0 + SPLITTING * np.arange(1, m + 1)[:, None]
            found = _real_blocks(system)
        if found is None:
            raise NotComputableError(
                "stiffness and damping: two modes that merge into one",
                "modes that can be told apart",
                "hold the structure, or change a dashpot by a part in a million",
            )
        blocks[:m], basis = found
        inverse = np.asarray(np.linalg.inv(basis), np.float64)
    busy = np.concatenate([np.arange(m), n + np.arange(m)])
    from_modal, to_modal = np.zeros((2 * n, 2 * m)), np.zeros((2 * m, 2 * n))
    from_modal[busy], to_modal[:, busy] = inverse, basis
    return Blocks(blocks, from_modal[:, m:] @ inputs, from_modal, to_modal)


def _real_blocks(system: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """(n, 2, 2) blocks and (2n, 2n) basis: pairs of conjugate, then pairs of real eigenvalues; None if two are one."""
    value, vector = np.linalg.eig(system)
    size = np.abs(value).max()
    upper = np.flatnonzero(value.imag > 1e-12 * size)
    real = np.flatnonzero(np.abs(value.imag) <= 1e-12 * size)
    first = [vector[:, i].real for i in upper] + [vector[:, i].real for i in real[0::2]]
    second = [vector[:, i].imag for i in upper] + [vector[:, i].real for i in real[1::2]]
    basis = np.column_stack(first + second)
    if basis.shape[0] != basis.shape[1] or np.linalg.cond(basis / np.linalg.norm(basis, axis=0)) > MAX_CONDITION:
        return None
    n = len(first)
    blocks = np.zeros((n, 2, 2))
    for k, i in enumerate(upper):
        sigma, omega = value[i].real, value[i].imag
        blocks[k] = [[sigma, omega], [-omega, sigma]]
    for k, (i, j) in enumerate(zip(real[0::2], real[1::2], strict=True), start=len(upper)):
        blocks[k] = np.diag([value[i].real, value[j].real])
    return blocks, basis


@dataclass(frozen=True, eq=False)
class Step:
    """One step of length h: x1 = E x0 + start u(0) + end u(h), with u linear in between.

    Attributes:
        exponential: (4, n) entries 11, 12, 21, 22 of each block's exponential.
        start, end: (n_inputs, 2n) what a unit of the input at the start and at the end of the step adds to the state.
    """

    exponential: FloatArray
    start: FloatArray
    end: FloatArray


def exact_step(system: Blocks, h: float) -> Step:
    """The step of length h, s, from one matrix exponential a block: exp of [[A, I, 0], [0, 0, I], [0, 0, 0]] h."""
    n = len(system.blocks)
    big = np.zeros((n, 6, 6))
    big[:, :2, :2] = system.blocks * h
    big[:, :2, 2:4] = big[:, 2:4, 4:] = np.eye(2)
    power = exponentials(big)
    hold, ramp = h * power[:, :2, 2:4], h * power[:, :2, 4:]
    force = system.inputs.reshape(2, n, -1)
    end = np.einsum("nij,jnk->kin", ramp, force)
    both = np.einsum("nij,jnk->kin", hold, force)
    n_inputs = force.shape[2]
    exponential = power[:, :2, :2].reshape(n, 4).T
    return Step(
        np.ascontiguousarray(exponential),
        np.ascontiguousarray((both - end).reshape(n_inputs, 2 * n)),
        np.ascontiguousarray(end.reshape(n_inputs, 2 * n)),
    )


def exponentials(matrices: FloatArray) -> FloatArray:
    """(n, m, m) exponentials by a Taylor series of the halved matrix, squared up again, all matrices at once."""
    halvings = max(0, int(np.ceil(np.log2(np.abs(matrices).sum(axis=2).max() / SERIES_NORM))))
    small = matrices / 2.0**halvings
    power = np.eye(matrices.shape[1]) + small / SERIES_TERMS
    for k in range(SERIES_TERMS - 1, 0, -1):
        power = np.eye(matrices.shape[1]) + small @ power / k
    for _ in range(halvings):
        power = power @ power
    return power
