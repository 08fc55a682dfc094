"""The compiled march: Gauss collocation with implicit point forces, finer where a force is not smooth.

Through one step a contact stays as it is, open or closed, so that every equation solved is smooth. A step is repeated
at a quarter of its size where a contact turned out to open or close within it, or where the force at a port leaves the
straight line through the two stages; the smallest step, h / 256, is taken as it comes.
"""

from models.arrays import FloatArray
from models.compiled import compiled
from models.fine.course import Course
from models.fine.desk import END, FORCE, LAW, RATE, START, Desk, Q, V, Z
from models.fine.gauss import NODES
from models.fine.newton import correct, faults
from models.fine.stage_laws import lean, pressing, weigh
from models.fine.tables import LEVELS, Tables
from models.point_forces import IS_CONTACT, Items

MAX_ITERATIONS = 30

STATE_TOLERANCE = 1e-11
"""Fault of an internal state that ends Newton's iteration."""

HUGE = 1e30
"""Motion beyond this has left the finite numbers."""

EARLY, LATE = float(NODES[0]), float(NODES[1])
BEYOND = EARLY / (LATE - EARLY)
"""From a stage to the nearest end of the step, in distances between the stages."""


@compiled
def hermite(values: FloatArray, slopes: FloatArray, step: int, s: float, h: float) -> float:
    """Value at the fraction s of a whole step of h by the cubic through its ends."""
    left, rise = values[step], values[step + 1] - values[step]
    turn = (1.0 - s) * slopes[step] - s * slopes[step + 1]
    value: float = left + s * s * (3.0 - 2.0 * s) * rise + h * s * (1.0 - s) * turn
    return value


@compiled
def carry_base(desk: Desk, course: Course, step: int, s: float, h: float, stage: int) -> None:
    """Add the motion of the base at the fraction s of a whole step where a port reads absolute motion."""
    if course.base.shape[1] > 0:
        shift = hermite(course.base[0], course.base[1], step, s, h)
        speed = hermite(course.base[1], course.base[2], step, s, h)
        for i in range(desk.port.shape[2]):
            desk.port[Q, stage, i] += course.absolute[i] * shift
            desk.port[V, stage, i] += course.absolute[i] * speed


@compiled
def begin(desk: Desk, tables: Tables, course: Course, state: FloatArray, level: int, step: int, s: float) -> None:
    """Free motion, known inputs and first guesses for a step from the fraction s of the whole step ``step``."""
    n_ports = desk.port.shape[2]
    for row in range(4):
        for i in range(n_ports):
            total = 0.0
            for k in range(state.shape[0]):
                total += tables.free[level, row, i, k] * state[k]
            desk.free[row, i] = total
    for stage in range(2):
        place = s + (EARLY if stage == 0 else LATE) * 0.25**level
        for m in range(course.inputs.shape[0]):
            known = hermite(course.inputs[m], course.slopes[m], step, place, tables.h[0])
            desk.strength[stage, n_ports + m] = known
        for i in range(n_ports):
            desk.port[FORCE, stage, i] = desk.port[LAW, START, i]
        for j in range(desk.item.shape[2]):
            desk.item[Z, stage, j] = desk.item[Z, START, j]


@compiled
def place_ports(desk: Desk, tables: Tables, course: Course, level: int, step: int, s: float, stage: int) -> None:
    """Motion of the ports at a stage from the free motion and the forces at hand; s is the place in the whole step."""
    n_ports = desk.port.shape[2]
    for i in range(n_ports):
        desk.strength[0, i] = desk.port[FORCE, 0, i] - course.held[i]
        desk.strength[1, i] = desk.port[FORCE, 1, i] - course.held[i]
    for i in range(n_ports):
        q, v = course.at_rest[i] + desk.free[2 * stage, i], desk.free[2 * stage + 1, i]
        for other in range(2):
            for k in range(desk.strength.shape[1]):
                q += tables.reached[level, 2 * stage, i, other, k] * desk.strength[other, k]
                v += tables.reached[level, 2 * stage + 1, i, other, k] * desk.strength[other, k]
        desk.port[Q, stage, i], desk.port[V, stage, i] = q, v
    carry_base(desk, course, step, s, tables.h[0], stage)


@compiled
def solve(desk: Desk, tables: Tables, course: Course, items: Items, level: int, step: int, s: float) -> bool:
    """Find forces and motion at both stages; whether the iteration ended."""
    for _ in range(MAX_ITERATIONS):
        for stage in range(2):
            place = s + (EARLY if stage == 0 else LATE) * 0.25**level
            place_ports(desk, tables, course, level, step, place, stage)
            weigh(desk, items, (step + place) * tables.h[0], stage)
        force, internal, size = faults(desk, items, tables.h[level])
        if force <= course.force_tolerance and internal <= STATE_TOLERANCE:
            return True
        for stage in range(2):
            place = s + (EARLY if stage == 0 else LATE) * 0.25**level
            lean(desk, items, (step + place) * tables.h[0], stage)
        correct(desk, tables, items, level, size)
    return False


@compiled
def push(desk: Desk, tables: Tables, state: FloatArray, level: int) -> None:
    """Leave in ``desk.new`` the state at the end of the step, from its start and the strength of the sources."""
    n, end = tables.sources.shape[1], tables.end
    early, late = desk.pushed[0], desk.pushed[1]
    for k in range(n):
        early[k] = late[k] = 0.0
    for i in range(tables.sources.shape[0]):
        first, second = desk.strength[0, i], desk.strength[1, i]
        if first != 0.0 or second != 0.0:
            for k in range(n):
                early[k] += tables.sources[i, k] * first
                late[k] += tables.sources[i, k] * second
    for row in range(2):
        for k in range(n):
            free = end[level, row, 0, k] * state[k] + end[level, row, 1, k] * state[n + k]
            desk.new[row * n + k] = free + end[level, row, 2, k] * early[k] + end[level, row, 3, k] * late[k]


@compiled
def arrive(desk: Desk, tables: Tables, course: Course, items: Items, level: int, step: int, s: float) -> None:
    """Motion, internal states and forces at the end of a step, which is the fraction s of the whole step."""
    n = tables.sources.shape[1]
    for i in range(desk.port.shape[2]):
        q, v = course.at_rest[i], 0.0
        for k in range(n):
            q += tables.sources[i, k] * desk.new[k]
            v += tables.sources[i, k] * desk.new[n + k]
        desk.port[Q, END, i], desk.port[V, END, i] = q, v
    carry_base(desk, course, step, s, tables.h[0], END)
    for j in range(desk.item.shape[2]):
        mean = 0.5 * (desk.item[RATE, 0, j] + desk.item[RATE, 1, j])
        desk.item[Z, END, j] = desk.item[Z, START, j] + tables.h[level] * mean
    weigh(desk, items, (step + s) * tables.h[0], END)


@compiled
def is_smooth(desk: Desk, course: Course, items: Items, t: float, h: float) -> bool:
    """Whether no contact changed within the step that ends at t and no force left the line through the stages."""
    for i in range(desk.port.shape[2]):
        rise = BEYOND * (desk.port[FORCE, 1, i] - desk.port[FORCE, 0, i])
        before = abs(desk.port[FORCE, 0, i] - rise - desk.port[LAW, START, i])
        after = abs(desk.port[FORCE, 1, i] + rise - desk.port[LAW, END, i])
        if max(before, after) > course.bend_tolerance:
            return False
    for j in range(items.port.shape[0]):
        if items.contact[j, IS_CONTACT] > 0.0:
            i = items.port[j]
            for stage in (0, 1, END):
                at = t - h * (0.0 if stage == END else 1.0 - (EARLY if stage == 0 else LATE))
                if pressing(items, j, at, desk.port[Q, stage, i], desk.port[V, stage, i]) != desk.closed[j]:
                    return False
    return True


@compiled
def settle(desk: Desk, items: Items, t: float) -> None:
    """Take the end of a step as the start of the next, each contact open or closed as it now is."""
    for j in range(items.port.shape[0]):
        if items.contact[j, IS_CONTACT] > 0.0:
            i = items.port[j]
            desk.closed[j] = pressing(items, j, t, desk.port[Q, END, i], desk.port[V, END, i])
        desk.item[Z, START, j] = desk.item[Z, END, j]
    weigh(desk, items, t, END)
    for i in range(desk.port.shape[2]):
        desk.port[LAW, START, i] = desk.port[LAW, END, i]


@compiled
def advance(desk: Desk, tables: Tables, course: Course, items: Items, state: FloatArray, step: int, s: float) -> float:
    """Take the largest smooth step from the fraction s of a whole step; the share of the whole step that it is."""
    level, share = 0, 1.0
    while s % share != 0.0:
        level, share = level + 1, 0.25 * share
    while True:
        begin(desk, tables, course, state, level, step, s)
        done = solve(desk, tables, course, items, level, step, s)
        push(desk, tables, state, level)
        arrive(desk, tables, course, items, level, step, s + share)
        t = (step + s + share) * tables.h[0]
        if level == LEVELS - 1 or (done and is_smooth(desk, course, items, t, tables.h[level])):
            break
        level, share = level + 1, 0.25 * share
    settle(desk, items, t)
    return share


@compiled
def read_out(desk: Desk, out_rows: FloatArray, out: FloatArray, trace: FloatArray, at: int) -> bool:
    """Write down the state at a whole step; whether it is finite."""
    total = 0.0
    for i in range(out_rows.shape[0]):
        value = 0.0
        for k in range(out_rows.shape[1]):
            value += out_rows[i, k] * desk.new[k]
        out[at, i] = value
        total += abs(value)
    for i in range(desk.port.shape[2]):
        total += abs(desk.port[Q, END, i])
        if trace.shape[0] > 0:
            trace[at, 0, i], trace[at, 1, i] = desk.port[Q, END, i], desk.port[V, END, i]
            trace[at, 2, i] = desk.port[LAW, END, i]
    return total < HUGE


@compiled
def march(
    desk: Desk,
    tables: Tables,
    course: Course,
    items: Items,
    state: FloatArray,
    out_rows: FloatArray,
    out: FloatArray,
    trace: FloatArray,
    first: int,
    last: int,
) -> tuple[int, int]:
    """March over whole steps of the course and read out after each; after the first of all, on from the desk as left.

    Args:
        desk: room from ``make_desk``.
        tables: the linear system.
        course: what drives it.
        items: the point forces.
        state: (2n,) at the start, changed in place.
        out_rows: (n_out, 2n) what is read.
        out: (M, n_out) is filled.
        trace: (M, 3, n_ports) is filled with q, v and force of the ports; (0, 3, n_ports) for none.
        first: whole steps done before.
        last: whole steps done when it ends; M - 1 for all.

    Returns:
        whole steps done, fewer than ``last`` where the motion left the finite numbers, and steps of any size taken.
    """
    taken = 0
    for k in range(state.shape[0]):
        desk.new[k] = state[k]
    for at in range(first + 1 if first > 0 else 0, last + 1):
        if at == 0:
            arrive(desk, tables, course, items, at, at, 0.0)
            settle(desk, items, 0.0)
        s = 0.0 if at > 0 else 1.0
        while s < 1.0:
            s += advance(desk, tables, course, items, state, at - 1, s)
            for k in range(state.shape[0]):
                state[k] = desk.new[k]
            taken += 1
        if not read_out(desk, out_rows, out, trace, at):
            return at, taken
    return last, taken
