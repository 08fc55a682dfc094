"""The compiled march: Gauss collocation with implicit point forces, finer where a force is not smooth.

Through one step a contact stays as it is, open or closed, so that every equation solved is smooth. A step is repeated in
quarters where a contact turned out to open or close within it, or where the force at a port bends too much for the
straight line through the two stages; the smallest quarters place an event to h / 256.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from models.arrays import FloatArray
from models.fine.gauss import NODES, WEIGHTS
from models.fine.stage_laws import OPTIONS, lean, normal_state, weigh
from models.fine.tables import LEVELS, QUARTERS, TICKS

MAX_ITERATIONS = 30
STATE_TOLERANCE = 1e-11
"""Fault of an internal state that ends Newton's iteration."""

HUGE = 1e30
"""Motion beyond this has left the finite numbers."""

EARLY, LATE = float(NODES[0]), float(NODES[1])
A11, A12, A21, A22 = (float(weight) for weight in WEIGHTS.ravel())
BEYOND = EARLY / (LATE - EARLY)
"""From a stage to the nearest end of the step, in distances between the stages."""


class Course(NamedTuple):
    """What is known beforehand at every whole step.

    Attributes:
        inputs, slopes: (n_inputs, M) and their time derivatives.
        base: (4, M) displacement, velocity, acceleration and its slope of the base, m and s.
        absolute: (n_ports,) 1 where the port reads absolute motion.
        at_rest: (n_ports,) q at rest.
        held: (n_ports,) port forces at rest, already balanced.
        force_tolerance: N, where Newton's iteration ends.
        bend_tolerance: N, how much a force may leave the straight line through the stages.
    """

    inputs: FloatArray
    slopes: FloatArray
    base: FloatArray
    absolute: FloatArray
    at_rest: FloatArray
    held: FloatArray
    force_tolerance: float
    bend_tolerance: float


@njit(**OPTIONS)
def eliminate(matrix, right, n):  # type: ignore[no-untyped-def]
    """Solve the leading n equations in place; the solution stands in ``right``."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            for j in range(k, n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            right[k], right[best] = right[best], right[k]
        for i in range(k + 1, n):
            share = matrix[i, k] / matrix[k, k]
            if share != 0.0:
                for j in range(k + 1, n):
                    matrix[i, j] -= share * matrix[k, j]
                right[i] -= share * right[k]
    for k in range(n - 1, -1, -1):
        total = right[k]
        for j in range(k + 1, n):
            total -= matrix[k, j] * right[j]
        right[k] = total / matrix[k, k]


@njit(**OPTIONS)
def hermite(values, slopes, step, s, h):  # type: ignore[no-untyped-def]
    """Value at the fraction s of a whole step of h by the cubic through its ends."""
    left, right = values[step], values[step + 1]
    turn = (1.0 - s) * slopes[step] - s * slopes[step + 1]
    return left + s * s * (3.0 - 2.0 * s) * (right - left) + h * s * (1.0 - s) * turn


@njit(**OPTIONS)
def carry_base(desk, course, step, s, h, stage):  # type: ignore[no-untyped-def]
    """Add the motion of the base at the fraction s of a whole step where a port reads absolute motion."""
    if course.base.shape[1] > 0:
        shift = hermite(course.base[0], course.base[1], step, s, h)
        speed = hermite(course.base[1], course.base[2], step, s, h)
        for i in range(desk.q.shape[1]):
            desk.q[stage, i] += course.absolute[i] * shift
            desk.v[stage, i] += course.absolute[i] * speed


@njit(**OPTIONS)
def place_ports(desk, tables, course, level, step, s, stage):  # type: ignore[no-untyped-def]
    """Motion of the ports at a stage from the free motion and the forces at hand; s is the place in the whole step."""
    n_ports = desk.q.shape[1]
    for i in range(n_ports):
        q, v = desk.free[2 * stage, i], desk.free[2 * stage + 1, i]
        for from_stage in range(2):
            for j in range(n_ports):
                force = desk.force[from_stage, j] - course.held[j]
                q += tables.reached[level, 2 * stage, i, from_stage, j] * force
                v += tables.reached[level, 2 * stage + 1, i, from_stage, j] * force
        desk.q[stage, i] = course.at_rest[i] + q
        desk.v[stage, i] = v
    carry_base(desk, course, step, s, tables.h[0], stage)


@njit(**OPTIONS)
def fault_of(desk, items, start_z, h):  # type: ignore[no-untyped-def]
    """Fill in what is missing in the forces and internal states; the largest of each is returned."""
    n_ports, n_items = desk.q.shape[1], items.port.shape[0]
    worst_force, worst_state = 0.0, 0.0
    for stage in range(2):
        for i in range(n_ports):
            fault = desk.law[stage, i] - desk.force[stage, i]
            desk.fault[stage * n_ports + i] = fault
            worst_force = max(worst_force, abs(fault))
    row = 2 * n_ports
    for j in range(n_items):
        if items.rate[j] != 0:
            early, late = desk.rate[0, j], desk.rate[1, j]
            desk.fault[row] = start_z[j] + h * (A11 * early + A12 * late) - desk.z[0, j]
            desk.fault[row + 1] = start_z[j] + h * (A21 * early + A22 * late) - desk.z[1, j]
            worst_state = max(worst_state, abs(desk.fault[row]), abs(desk.fault[row + 1]))
            row += 2
    return worst_force, worst_state, row


@njit(**OPTIONS)
def correct(desk, tables, items, level, size):  # type: ignore[no-untyped-def]
    """One Newton correction of the forces and internal states at both stages."""
    n_ports, h = desk.q.shape[1], tables.h[level]
    matrix = desk.matrix
    for stage in range(2):
        for i in range(n_ports):
            row = stage * n_ports + i
            for k in range(size):
                matrix[row, k] = 0.0
            for from_stage in range(2):
                for m in range(n_ports):
                    matrix[row, from_stage * n_ports + m] = -(
                        desk.by_q[stage, i] * tables.reached[level, 2 * stage, i, from_stage, m]
                        + desk.by_v[stage, i] * tables.reached[level, 2 * stage + 1, i, from_stage, m]
                    )
            matrix[row, row] += 1.0
    row = 2 * n_ports
    for j in range(items.port.shape[0]):
        if items.rate[j] == 0:
            continue
        i = items.port[j]
        for stage in range(2):
            early, late = (A11, A12) if stage == 0 else (A21, A22)
            for k in range(size):
                matrix[row + stage, k] = 0.0
            for from_stage in range(2):
                for m in range(n_ports):
                    total = 0.0
                    for at, weight in ((0, early), (1, late)):
                        total += weight * (
                            desk.rate_by_q[at, j] * tables.reached[level, 2 * at, i, from_stage, m]
                            + desk.rate_by_v[at, j] * tables.reached[level, 2 * at + 1, i, from_stage, m]
                        )
                    matrix[row + stage, from_stage * n_ports + m] = -h * total
            matrix[row + stage, row] = -h * early * desk.rate_by_z[0, j]
            matrix[row + stage, row + 1] = -h * late * desk.rate_by_z[1, j]
            matrix[row + stage, row + stage] += 1.0
            matrix[stage * n_ports + i, row + stage] -= desk.by_z[stage, j]
        row += 2
    eliminate(matrix, desk.fault, size)
    for stage in range(2):
        for i in range(n_ports):
            desk.force[stage, i] += desk.fault[stage * n_ports + i]
    row = 2 * n_ports
    for j in range(items.port.shape[0]):
        if items.rate[j] != 0:
            desk.z[0, j] += desk.fault[row]
            desk.z[1, j] += desk.fault[row + 1]
            row += 2


@njit(**OPTIONS)
def attempt(desk, tables, course, items, closed, state, start_force, start_z, level, step, tick):  # type: ignore[no-untyped-def]
    """Solve one step of a level that begins ``tick`` smallest steps after the whole step ``step``.

    The new state is left in ``desk.new``; True where the iteration ended.
    """
    n, n_ports, n_inputs = tables.ports.shape[1], tables.ports.shape[0], tables.inputs.shape[0]
    h, share = tables.h[level], 1.0 / QUARTERS**level
    first, second = tick / TICKS + share * EARLY, tick / TICKS + share * LATE
    for r in range(4):
        for i in range(n_ports):
            total = 0.0
            for k in range(2 * n):
                total += tables.free[level, r, i, k] * state[k]
            desk.free[r, i] = total
    for m in range(n_inputs):
        early = hermite(course.inputs[m], course.slopes[m], step, first, tables.h[0])
        late = hermite(course.inputs[m], course.slopes[m], step, second, tables.h[0])
        desk.input[0, m], desk.input[1, m] = early, late
        for r in range(4):
            for i in range(n_ports):
                driven = tables.driven[level, r, i, m]
                desk.free[r, i] += driven[0] * early + driven[1] * late
    for stage in range(2):
        desk.force[stage, :] = start_force
        desk.z[stage, :] = start_z
    t = step * tables.h[0]
    done = False
    for _ in range(MAX_ITERATIONS):
        place_ports(desk, tables, course, level, step, first, 0)
        place_ports(desk, tables, course, level, step, second, 1)
        weigh(desk, items, closed, t + first * tables.h[0], 0)
        weigh(desk, items, closed, t + second * tables.h[0], 1)
        force, internal, size = fault_of(desk, items, start_z, h)
        if force <= course.force_tolerance and internal <= STATE_TOLERANCE:
            done = True
            break
        lean(desk, items, closed, t + first * tables.h[0], 0)
        lean(desk, items, closed, t + second * tables.h[0], 1)
        correct(desk, tables, items, level, size)
    for k in range(n):
        early, late = 0.0, 0.0
        for m in range(n_inputs):
            early += tables.inputs[m, k] * desk.input[0, m]
            late += tables.inputs[m, k] * desk.input[1, m]
        for i in range(n_ports):
            early += tables.ports[i, k] * (desk.force[0, i] - course.held[i])
            late += tables.ports[i, k] * (desk.force[1, i] - course.held[i])
        end = tables.end[level]
        q, v = state[k], state[n + k]
        desk.new[k] = end[0, 0, k] * q + end[0, 1, k] * v + end[0, 2, k] * early + end[0, 3, k] * late
        desk.new[n + k] = end[1, 0, k] * q + end[1, 1, k] * v + end[1, 2, k] * early + end[1, 3, k] * late
    return done


@njit(**OPTIONS)
def arrive(desk, tables, course, items, closed, step, s):  # type: ignore[no-untyped-def]
    """Fill in motion and forces at the end of a step, row 2 of the desk; s is the place in the whole step."""
    n, n_ports = tables.ports.shape[1], tables.ports.shape[0]
    for i in range(n_ports):
        q, v = course.at_rest[i], 0.0
        for k in range(n):
            q += tables.ports[i, k] * desk.new[k]
            v += tables.ports[i, k] * desk.new[n + k]
        desk.q[2, i], desk.v[2, i] = q, v
    carry_base(desk, course, step, s, tables.h[0], 2)
    weigh(desk, items, closed, (step + s) * tables.h[0], 2)


@njit(**OPTIONS)
def is_smooth(desk, course, items, closed, start_force, t, h):  # type: ignore[no-untyped-def]
    """Whether no contact changed within the step that ends at t and the forces hardly leave a straight line."""
    for i in range(desk.q.shape[1]):
        rise = BEYOND * (desk.force[1, i] - desk.force[0, i])
        before = abs(desk.force[0, i] - rise - start_force[i])
        after = abs(desk.force[1, i] + rise - desk.law[2, i])
        if max(before, after) > course.bend_tolerance:
            return False
    for j in range(items.port.shape[0]):
        if items.contact[j, 0] > 0.0:
            i = items.port[j]
            for stage, past in ((0, (1.0 - EARLY) * h), (1, (1.0 - LATE) * h), (2, 0.0)):
                if normal_state(items, j, t - past, desk.q[stage, i], desk.v[stage, i]) != closed[j]:
                    return False
    return True


@njit(**OPTIONS)
def settle(desk, items, closed, t):  # type: ignore[no-untyped-def]
    """Set which contacts press at the end of a step, and the forces there with them."""
    for j in range(items.port.shape[0]):
        if items.contact[j, 0] > 0.0:
            closed[j] = normal_state(items, j, t, desk.q[2, items.port[j]], desk.v[2, items.port[j]])
    weigh(desk, items, closed, t, 2)


@njit(**OPTIONS)
def advance(desk, tables, course, items, closed, state, step, tick):  # type: ignore[no-untyped-def]
    """Take the largest step from ``tick`` that is smooth; its end stands in row 2 of the desk.

    Returns:
        the smallest steps it is worth.
    """
    level = 0
    while tick % (TICKS // QUARTERS**level) != 0:
        level += 1
    start_force, start_z = desk.law[2].copy(), desk.z[2].copy()
    while True:
        done = attempt(desk, tables, course, items, closed, state, start_force, start_z, level, step, tick)
        for j in range(items.port.shape[0]):
            desk.z[2, j] = start_z[j] + 0.5 * tables.h[level] * (desk.rate[0, j] + desk.rate[1, j])
        s = tick / TICKS + 1.0 / QUARTERS**level
        arrive(desk, tables, course, items, closed, step, s)
        t = (step + s) * tables.h[0]
        if level == LEVELS - 1 or (done and is_smooth(desk, course, items, closed, start_force, t, tables.h[level])):
            break
        level += 1
    settle(desk, items, closed, t)
    return TICKS // QUARTERS**level


@njit(**OPTIONS)
def read_out(desk, out_rows, out, trace, at):  # type: ignore[no-untyped-def]
    """Write down the state at a whole step; whether it is finite."""
    total = 0.0
    for i in range(out_rows.shape[0]):
        value = 0.0
        for k in range(out_rows.shape[1]):
            value += out_rows[i, k] * desk.new[k]
        out[at, i] = value
        total += abs(value)
    for i in range(desk.q.shape[1]):
        total += abs(desk.q[2, i])
        if trace.shape[0] > 0:
            trace[at, 0, i], trace[at, 1, i], trace[at, 2, i] = desk.q[2, i], desk.v[2, i], desk.law[2, i]
    return total < HUGE


@njit(**OPTIONS)
def march(desk, tables, course, items, out_rows, out, trace, state):  # type: ignore[no-untyped-def]
    """March over all whole steps of the course and read out at each.

    Args:
        desk: room from ``make_desk``.
        tables: the linear system.
        course: what drives it.
        items: the point forces.
        out_rows: (n_out, 2n) what is read; out: (M, n_out) is filled.
        trace: (M, 3, n_ports) is filled with q, v and force of the ports; (0, 3, n_ports) for none.
        state: (2n,) at the start, changed in place.

    Returns:
        whole steps done, fewer than M - 1 where the motion left the finite numbers, and steps of any size taken.
    """
    closed = np.zeros(items.port.shape[0], np.int64)
    desk.new[:] = state
    desk.z[2, :] = 0.0
    arrive(desk, tables, course, items, closed, 0, 0.0)
    settle(desk, items, closed, 0.0)
    read_out(desk, out_rows, out, trace, 0)
    taken = 0
    for step in range(out.shape[0] - 1):
        tick = 0
        while tick < TICKS:
            tick += advance(desk, tables, course, items, closed, state, step, tick)
            state[:] = desk.new
            taken += 1
        if not read_out(desk, out_rows, out, trace, step + 1):
            return step, taken
    return out.shape[0] - 1, taken
