"""The exact step of a linear modal system whose inputs are linear within the step.

State x = (q, q'), x' = A x + B u. A real similarity brings A to 2 x 2 blocks: one a mode where the damping is
proportional, one a pair of eigenvalues of A where it is not, so that a step costs the same for any linear system.
Source: C. F. Van Loan, IEEE Trans. Autom. Control 23 (1978) 395, for the input integrals.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from models.arrays import FloatArray
from models.errors import InputError

MAX_CONDITION = 1e9
"""Of the eigenvectors; beyond it two modes have merged into one defective pair."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """A linear system x' = A x + B u in 2 x 2 real blocks; coordinates are (first of each block, second of each block).

    Attributes:
        blocks: (n, 2, 2) of A.
        inputs: (2n, n_inputs) B.
        displacement: (n_rows, 2n) rows that give displacements from the state.
        velocity: (n_rows, 2n) rows that give velocities.
        from_modal: (2n, 2n) maps (q, q') to the state.
    """

    blocks: FloatArray
    inputs: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    from_modal: FloatArray


def to_blocks(omega: FloatArray, damping: FloatArray, inputs: FloatArray, rows: FloatArray) -> Blocks:
    """Blocks of q'' + C q' + omega^2 q = inputs u, read out by ``rows``.

    Args:
        omega: (n,) rad/s.
        damping: (n, n) 1/s.
        inputs: (n, n_inputs) modal force per unit input.
        rows: (n_rows, n).

    Raises:
        InputError: the damping merges two modes into one that cannot be separated.
    """
    n = len(omega)
    zero = np.zeros_like(rows)
    if np.count_nonzero(damping - np.diag(np.diag(damping))) == 0:
        blocks = np.zeros((n, 2, 2))
        blocks[:, 0, 1] = 1.0
        blocks[:, 1, 0], blocks[:, 1, 1] = -(omega**2), -np.diag(damping)
        force = np.vstack([np.zeros_like(inputs), inputs])
        return Blocks(blocks, force, np.hstack([rows, zero]), np.hstack([zero, rows]), np.eye(2 * n))
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(omega**2), -damping]])
    blocks, basis = _real_blocks(system)
    back = np.linalg.inv(basis)
    force = back @ np.vstack([np.zeros_like(inputs), inputs])
    return Blocks(blocks, force, np.hstack([rows, zero]) @ basis, np.hstack([zero, rows]) @ basis, back)


def _real_blocks(system: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n, 2, 2) blocks and (2n, 2n) basis: pairs of conjugate, then pairs of real eigenvalues."""
    value, vector = np.linalg.eig(system)
    size = np.abs(value).max()
    upper = np.flatnonzero(value.imag > 1e-12 * size)
    real = np.flatnonzero(np.abs(value.imag) <= 1e-12 * size)
    first = [vector[:, i].real for i in upper] + [vector[:, i].real for i in real[0::2]]
    second = [vector[:, i].imag for i in upper] + [vector[:, i].real for i in real[1::2]]
    basis = np.column_stack(first + second)
    if basis.shape[0] != basis.shape[1] or np.linalg.cond(basis / np.linalg.norm(basis, axis=0)) > MAX_CONDITION:
        raise InputError(
            "damping: two modes merge into one critically damped pair",
            "modes that can be told apart",
            "change a dashpot by a part in a million",
        )
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
    power = expm(big)
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
