"""The march of a system whose bending stiffness grows in time, in segments that each have modes of their own.

A segment has the stiffness of its middle (``models.drift_tables``). Its modes are found in those of the record's start,
which hold all that the finite elements can do, so that state, ports, inputs and what is read turn with one matrix.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, block_diag, eigh

from models.arrays import FloatArray
from models.drift_tables import steps_of_segment
from models.errors import DivergenceError
from models.fine.collocation import march
from models.fine.course import Course
from models.fine.desk import Desk
from models.fine.system import FineSystem
from models.fine.tables import make_tables
from models.point_forces import Items
from models.structure import Structure, check_drift


@dataclass(frozen=True, eq=False)
class Run:
    """What stays the same from segment to segment.

    Attributes:
        system: at the record's start.
        structure: whose bending stiffness grows.
        course: what drives it, the growth of what bends the beam at rest last.
        inputs: (n_inputs, n) generalised force of each known input.
        items: the point forces.
        rows: (n_out, 2n) what is read out of the state.
        h: whole step, s.
    """

    system: FineSystem
    structure: Structure
    course: Course
    inputs: FloatArray
    items: Items
    rows: FloatArray
    h: float


def march_drifting(
    run: Run, band: float, desk: Desk, state: FloatArray, out: FloatArray, trace: FloatArray
) -> tuple[int, int]:
    """March over all whole steps of the course; result as of ``collocation.march``.

    Args:
        run: what is marched.
        band: highest frequency of interest, Hz.
        desk: room.
        state: (2n,) at the start, changed in place.
        out: (M, n_out), filled.
        trace: of ``collocation.march``, filled.

    Raises:
        DivergenceError: nothing is left of the stiffness.
    """
    omega = run.system.omega[: len(run.system.bending)]
    length, n_steps = steps_of_segment(run.structure.stiffness_rate, omega, band, run.h), len(out) - 1
    check_drift(run.structure.stiffness_rate, n_steps * run.h)
    taken = 0
    for first in range(0, max(n_steps, 1), length):
        last = min(first + length, n_steps)
        square, turn = _modes_at(run, (first + 0.5 * length) * run.h)
        ports, inputs = run.system.port_rows @ turn, run.inputs @ turn
        tables = make_tables(np.sqrt(square), _damping(run, square), ports, inputs, run.h)
        both = block_diag(turn, turn)
        turned = both.T @ state
        rows = np.ascontiguousarray(run.rows @ both)
        done, more = march(desk, tables, run.course, run.items, turned, rows, out, trace, first, last)
        state[:], taken = both @ turned, taken + more
        if done < last:
            return done, taken
    return n_steps, taken


def _modes_at(run: Run, t: float) -> tuple[FloatArray, FloatArray]:
    """(n,) squared frequencies and (n, n) modes by those of the start; an absorber's mass stays a coordinate."""
    system, growth = run.system, run.structure.stiffness_rate * t
    n = len(system.bending)
    stiffness = np.diag(system.omega[:n] ** 2) + growth * system.bending
    try:
        inverse, turn = eigh(np.eye(n), stiffness)
    except LinAlgError:
        raise DivergenceError(
            f"stiffness_drift: a bending stiffness that changes by {run.structure.stiffness_rate:g} of itself a second "
            f"cannot hold the beam {t:.4g} s after the start; a shorter record or a smaller rate leaves it some"
        ) from None
    hung, inverse = len(system.omega) - n, inverse[::-1]
    square = np.append(1.0 / inverse, np.zeros(hung))
    return square, block_diag(turn[:, ::-1] / np.sqrt(inverse), np.eye(hung))


def _damping(run: Run, square: FloatArray) -> FloatArray:
    """(n,) 1/s: what is in proportion to the stiffness follows it; one loss factor for all modes stays as it was."""
    if run.structure.loss_factor is not None:
        return run.system.damping
    return run.system.damping + run.structure.viscosity * (square - run.system.omega**2)
