"""The compiled time stepper: the linear part exact, laws and contacts implicit, of order 2 to 4.

Within a step each force runs as a parabola over its values at the start, halfway and at the end, on the cubic of the
motion there; where a contact begins or ends within the step, on the part in which it is closed. What the linear part is
given is the straight line with the same impulse and the same first moment. The motion that it causes, and on which it
depends, is found by Newton's iteration at the few ports. docs/theory.md, section 5.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from models.arrays import BoolArray, FloatArray, IntArray
from models.law_call import call_law

MAX_ITERATIONS = 60
SLOPE_NUDGE = 1e-6
INTERNAL_TOLERANCE = 1e-12
"""Fault of an internal state, which is of the order of 1, that ends its iteration."""

LAST_OLD_SLOPE = 1
"""Iterations that use the slope of an earlier step before it is formed anew."""

STEEP_AFTER, LEAST_STEEP = 12, 1.0
"""A law without internal state that has not been met by then, and would take back more than this part of a small force
through the motion within the step, counts as steep: its force is the same all through. The parabola has a middle force,
which a friction that sticks would turn about from step to step without end."""

GIVEN_UP = 30
"""Iterations after which such a law is taken so for this one step, steep or not."""

ROUNDED = 1e-14
"""Of a force times its slope: a fault as small is rounding."""

CONVERGING = 0.1
"""Of the tolerance, below which the next change is not waited for: as it goes on from the last two, it is their ratio
times the last. Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8."""

MOST_JOINED = 4
"""Straight contacts that are solved for together: each set of them that may be closed has its own inverse matrix."""

LEAST_DETERMINANT, LARGEST_DETERMINANT = 0.1, 1e6
"""Of Newton's 2 x 2 equations; others are met only where a difference straddles the gap's edge."""

FINITE = 1e30
"""Beyond it a motion counts as lost."""

OPTIONS: dict[str, Any] = {
    "nogil": True,
    "cache": True,
    "error_model": "numpy",
    "fastmath": {"contract", "reassoc", "nsz", "arcp"},
}
"""A division by nothing gives no number, which counts as a motion that is lost."""

INLINE: dict[str, Any] = {**OPTIONS, "inline": "always"}
"""For what runs in every step: a call that hands over arrays would cost more than the arithmetic."""


class Reading(NamedTuple):
    """Rows that read something from the state, without the half of their columns that may be 0 in all of them.

    Attributes:
        rows: (n_rows, width) on the state from ``first`` on.
        first: number of a column.
    """

    rows: FloatArray
    first: int

    @classmethod
    def of(cls, rows: FloatArray) -> "Reading":
        """Without the first or the last half of (n_rows, 2n) where it is 0."""
        half = rows.shape[1] // 2
        first = 0 if rows[:, :half].any() else half
        last = 2 * half if rows[:, half:].any() else half
        return cls(np.ascontiguousarray(rows[:, min(first, last - half) : last]), min(first, last - half))


class Linear(NamedTuple):
    """The linear part of one step of length h; n is the number of blocks.

    Attributes:
        exponential: (4, n) of ``propagator.Step``.
        in_start, in_end: (n_in, 2n) of ``propagator.Step`` for the known inputs.
        port_start, port_end: (n_ports, 2n) the same for unit port forces.
        q, v: motion of the ports from the state.
        q_rest: (n_ports,) q at rest.
        absolute: (n_ports,) 1 where the port reads absolute motion.
        h: s.
    """

    exponential: FloatArray
    in_start: FloatArray
    in_end: FloatArray
    port_start: FloatArray
    port_end: FloatArray
    q: Reading
    v: Reading
    q_rest: FloatArray
    absolute: FloatArray
    h: float


class Items(NamedTuple):
    """Point laws, then contacts.

    Attributes:
        port: (n,) number of the port.
        law, rate: (n,) addresses of the force and of the internal state's rate, 0 for none.
        values, offset: all parameters in a row, and (n,) where each item's begin.
        contact: (n, 4) clearance, offset, clearance rate, 1 where bilateral; unused for point laws.
        is_contact: (n,) 1 for a contact.
        straight: (n, 3) 1 where a contact's normal force is k p + c dp/dt, and k, N/m, and c, N s/m.
        rest_force: (n,) force at rest, already balanced, N.
    """

    port: IntArray
    law: IntArray
    rate: IntArray
    values: FloatArray
    offset: IntArray
    contact: FloatArray
    is_contact: IntArray
    straight: FloatArray
    rest_force: FloatArray


class Memory(NamedTuple):
    """What a step leaves to the next besides the state, changed in place by a march that goes on from it.

    Attributes:
        q, v: (n_ports,) motion of the ports as their laws see it, m and m/s.
        z: (n_items,) internal states.
        before: (n_items,) forces at the start of the step, from which the next step's are guessed, N.
        newton: (n_items, 2, 2) inverse matrices of the iteration.
        steep: (n_items,) 1 where a law counts as steep.
    """

    q: FloatArray
    v: FloatArray
    z: FloatArray
    before: FloatArray
    newton: FloatArray
    steep: IntArray

    @classmethod
    def fresh(cls, n_ports: int, n_items: int) -> "Memory":
        """For the first step of all."""
        newton = np.zeros((n_items, 2, 2))
        newton[:, 0, 0] = newton[:, 1, 1] = 1.0
        return cls(
            np.zeros(n_ports), np.zeros(n_ports), np.zeros(n_items), np.zeros(n_items), newton, np.zeros(n_items, int)
        )


@njit(**INLINE)
def pressed(contact: FloatArray, j: int, t: float, side: float, q: float, v: float) -> tuple[float, float]:
    """(p, dp/dt) of row j of ``Items.contact`` at q, v, against the wall on this side."""
    return side * (q - contact[j, 1]) - contact[j, 0] - contact[j, 2] * t, side * v - contact[j, 2]


@njit(**INLINE)
def penetration_of(contact: FloatArray, j: int, t: float, q: float, v: float) -> tuple[float, float, float]:
    """(p, dp/dt, side) of row j of ``Items.contact`` at q, v."""
    side = 1.0 if q - contact[j, 1] >= 0.0 else -1.0
    p, rate = pressed(contact, j, t, side, q, v)
    return p, rate, side


@njit(**OPTIONS)
def part_step(start: float, end: float, first: float, middle: float, last: float) -> tuple[float, float]:
    """Weights (a, b) of the straight line over the step with the impulse and first moment of a force on a part.

    The force runs as a parabola from ``first`` at the fraction ``start`` over ``middle`` to ``last`` at ``end``; where
    it would pull, it is 0.
    """
    if first <= 0.0 and last <= 0.0:
        return 0.0, 0.0
    if middle < 0.0:
        middle = 0.5 * (first + last)
    if first < 0.0 or last < 0.0:
        slope, bend = 4.0 * middle - 3.0 * first - last, 2.0 * (first + last) - 4.0 * middle
        root = sqrt(slope * slope - 4.0 * bend * first)
        if first < 0.0:
            cut = -2.0 * first / (slope + root)
            s = 0.5 * (cut + 1.0)
            middle = first + s * (slope + s * bend)
            start, first = start + (end - start) * cut, 0.0
        else:
            cut = 2.0 * first / (root - slope)
            s = 0.5 * cut
            middle = first + s * (slope + s * bend)
            end, last = start + (end - start) * cut, 0.0
    width = end - start
    impulse = width * (first + 4.0 * middle + last) / 6.0
    moment = start * impulse + width * width * (middle / 3.0 + last / 6.0)
    return 4.0 * impulse - 6.0 * moment, 6.0 * moment - 2.0 * impulse


@njit(**INLINE)
def halfway(h: float, x0: float, v0: float, x1: float, v1: float) -> tuple[float, float]:
    """Place and velocity halfway through a time h, by the cubic through both at its ends."""
    return 0.5 * (x0 + x1) + 0.125 * h * (v0 - v1), 1.5 * (x1 - x0) / h - 0.25 * (v0 + v1)


@njit(**OPTIONS)
def crossing(p0: float, r0: float, p1: float, r1: float) -> tuple[float, float]:
    """Fraction of the step where the cubic through (p0, slope r0) and (p1, slope r1) passes 0, and its slope there."""
    s = p0 / (p0 - p1)
    c2, c3 = 3.0 * (p1 - p0) - 2.0 * r0 - r1, 2.0 * (p0 - p1) + r0 + r1
    for _ in range(4):
        slope = r0 + s * (2.0 * c2 + 3.0 * s * c3)
        if slope * (p1 - p0) <= 0.0:
            break
        s -= (p0 + s * (r0 + s * (c2 + s * c3))) / slope
        s = min(max(s, 0.0), 1.0)
    return s, r0 + s * (2.0 * c2 + 3.0 * s * c3)


@njit(**INLINE)
def contact_step(
    law: int, values: FloatArray, offset: int, contact: FloatArray, j: int, t: float, h: float,
    p0: float, r0: float, side0: float, n0: float, q1: float, v1: float,
) -> tuple[float, float]:  # fmt: skip
    """Weights (a, b) of a contact's force on the structure over a step that ends at t with q1, v1.

    The step starts with penetration p0 at rate r0 on side0, and with the normal force n0, not yet kept from pulling.
    """
    p1, r1, side1 = penetration_of(contact, j, t, q1, v1)
    if contact[j, 3] > 0.0:
        first, last = side0 * n0, side1 * call_law(law, t, p1, r1, 0.0, values, offset)
        p, rate = halfway(h, side0 * p0, side0 * r0, side1 * p1, side1 * r1)
        side = 1.0 if p >= 0.0 else -1.0
        middle = side * call_law(law, t - 0.5 * h, side * p, side * rate, 0.0, values, offset)
        rise = (middle - 0.5 * (first + last)) / 1.5
        return -first - rise, -last - rise
    if p0 <= 0.0 and p1 <= 0.0:
        return 0.0, 0.0
    n1 = call_law(law, t, p1, r1, 0.0, values, offset) if p1 > 0.0 else 0.0
    if side0 != side1:
        return (-side0 * max(0.0, n0) if p0 > 0.0 else 0.0), (-side1 * max(0.0, n1) if p1 > 0.0 else 0.0)
    start, end = 0.0, 1.0
    if p0 <= 0.0:
        start, slope = crossing(p0, r0 * h, p1, r1 * h)
        p0, r0 = 0.0, slope / h
        n0 = call_law(law, t - (1.0 - start) * h, 0.0, r0, 0.0, values, offset)
    elif p1 <= 0.0:
        end, slope = crossing(p0, r0 * h, p1, r1 * h)
        p1, r1 = 0.0, slope / h
        n1 = call_law(law, t - (1.0 - end) * h, 0.0, r1, 0.0, values, offset)
    if end <= start:
        return 0.0, 0.0
    p, rate = halfway((end - start) * h, p0, r0, p1, r1)
    middle = call_law(law, t - (1.0 - 0.5 * (start + end)) * h, p, rate, 0.0, values, offset)
    a, b = part_step(start, end, n0, middle, n1)
    return -side0 * a, -side0 * b


@njit(**INLINE)
def law_step(
    law: int, values: FloatArray, offset: int, t: float, h: float,
    q0: float, v0: float, force: float, q1: float, v1: float,
) -> tuple[float, float]:  # fmt: skip
    """Weights (a, b) of the force of a law without internal state, from ``force`` at the start of a step to t."""
    last = call_law(law, t, q1, v1, 0.0, values, offset)
    q, v = halfway(h, q0, v0, q1, v1)
    rise = (call_law(law, t - 0.5 * h, q, v, 0.0, values, offset) - 0.5 * (force + last)) / 1.5
    return force + rise, last + rise


@njit(**INLINE)
def straight_step(
    straight: FloatArray, contact: FloatArray, j: int, t: float, h: float,
    p0: float, r0: float, side0: float, n0: float, q1: float, v1: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """Weights (a, b) of a straight contact that is closed all through a step to t, and whether it is.

    Arguments as of ``contact_step``; what is asked for is straight in q1 and v1, whether or not it is closed there.
    """
    p1, r1 = pressed(contact, j, t, side0, q1, v1)
    p, rate = halfway(h, p0, r0, p1, r1)
    middle, last = straight[j, 1] * p + straight[j, 2] * rate, straight[j, 1] * p1 + straight[j, 2] * r1
    is_closed = contact[j, 3] > 0.0 or (p1 > 0.0 and middle >= 0.0 and last >= 0.0)
    a, b = (2.0 * (n0 + middle) - last) / 3.0, (2.0 * (middle + last) - n0) / 3.0
    return -side0 * a, -side0 * b, is_closed


@njit(**OPTIONS)
def inverses_of(
    straight: FloatArray, joined: IntArray, port: IntArray, h: float,
    q_start: FloatArray, q_end: FloatArray, v_start: FloatArray, v_end: FloatArray,
) -> FloatArray:  # fmt: skip
    """(2^n, 2n, 2n) inverse matrices of Newton's equations for the weights (a, b) of contacts closed throughout.

    The binary digits of the first index tell which of them are closed; rows and columns of the others are 0. Forces
    that are straight in the motion are met by one step of it.
    """
    n = len(joined)
    whole = np.zeros((2 * n, 2 * n))
    for s in range(n):
        k, c = straight[joined[s], 1], straight[joined[s], 2]
        i = port[joined[s]]
        for r in range(n):
            m = port[joined[r]]
            for end in range(2):
                q_by, v_by = (q_end[m, i], v_end[m, i]) if end else (q_start[m, i], v_start[m, i])
                whole[2 * s, 2 * r + end] = c / h * q_by - (k * h / 12.0 + 0.5 * c) * v_by
                whole[2 * s + 1, 2 * r + end] = (k + c / h) * q_by - (k * h / 12.0 - 0.5 * c) * v_by
    found = np.zeros((1 << n, 2 * n, 2 * n))
    for closed in range(1, 1 << n):
        own = np.array([x for x in range(2 * n) if closed >> (x // 2) & 1])
        part = np.eye(len(own))
        for x in range(len(own)):
            for y in range(len(own)):
                part[x, y] += whole[own[x], own[y]]
        inverse = np.linalg.inv(part)
        for x in range(len(own)):
            for y in range(len(own)):
                found[closed, own[x], own[y]] = inverse[x, y]
    return found


@njit(**INLINE)
def met_together(
    inverses: FloatArray, closed: int, joined: IntArray, is_joined: BoolArray, straight: FloatArray,
    contact: FloatArray, port: IntArray, t: float, h: float, p0: FloatArray, r0: FloatArray, side0: FloatArray,
    n0: FloatArray, a: FloatArray, b: FloatArray, port_a: FloatArray, port_b: FloatArray, q1: FloatArray,
    v1: FloatArray, q_start: FloatArray, q_end: FloatArray, v_start: FloatArray, v_end: FloatArray, fault: FloatArray,
) -> tuple[int, float]:  # fmt: skip
    """One linear step to the weights of all contacts in the set ``closed``, changed in place as the motion is.

    Returns:
        the set; none of them where one is not closed all through the step after that, and each must be met by itself;
        and the largest change that was asked for, N.
    """
    largest, n_joined = 0.0, len(joined)
    for s in range(n_joined):
        j = joined[s]
        fault[2 * s], fault[2 * s + 1] = 0.0, 0.0
        if is_joined[j]:
            q, v = q1[port[j]], v1[port[j]]
            a_new, b_new, _ = straight_step(straight, contact, j, t, h, p0[j], r0[j], side0[j], n0[j], q, v)
            fault[2 * s], fault[2 * s + 1] = a_new - a[j], b_new - b[j]
            largest = max(largest, abs(fault[2 * s]) + abs(fault[2 * s + 1]))
    for s in range(n_joined):
        j = joined[s]
        if is_joined[j]:
            i = port[j]
            da, db = 0.0, 0.0
            for m in range(2 * n_joined):
                da += inverses[closed, 2 * s, m] * fault[m]
                db += inverses[closed, 2 * s + 1, m] * fault[m]
            a[j] += da
            b[j] += db
            port_a[i] += da
            port_b[i] += db
            for m in range(len(q1)):
                q1[m] += q_start[i, m] * da + q_end[i, m] * db
                v1[m] += v_start[i, m] * da + v_end[i, m] * db
    for s in range(n_joined):
        j = joined[s]
        if is_joined[j]:
            q, v = q1[port[j]], v1[port[j]]
            _, _, is_closed = straight_step(straight, contact, j, t, h, p0[j], r0[j], side0[j], n0[j], q, v)
            if not is_closed:
                closed = 0
    return closed, largest


@njit(**OPTIONS)
def steady_force(
    law: int, values: FloatArray, offset: int, t: float, q: float, v: float, q_by: float, v_by: float, force: float,
    tolerance: float,
) -> tuple[float, float]:  # fmt: skip
    """The force of a law that is the same all through a step to t, as the motion at its end asks for, and its slope.

    By Newton's method between the bounds that the faults before have set: one that resists the more, the more it is
    pushed, is met however steep it is.

    Args:
        law: address of a force without internal state.
        values: parameters in a row.
        offset: where the law's begin.
        t: at the end of the step, s.
        q: displacement there under ``force``, m.
        v: velocity there under ``force``, m/s.
        q_by: what a unit of force adds to ``q``, m/N.
        v_by: what a unit of force adds to ``v``, m/(N s).
        force: to begin with, N.
        tolerance: fault that ends the iteration, N.

    Returns:
        the force, N, and how much less the law asks for when it is more by a unit; -1 for that where it was not met.
    """
    low, high = -np.inf, np.inf
    q_free, v_free = q - q_by * force, v - v_by * force
    for _ in range(MAX_ITERATIONS):
        unit = tolerance + SLOPE_NUDGE * abs(force)
        q1, v1 = q_free + q_by * force, v_free + v_by * force
        asked = call_law(law, t, q1, v1, 0.0, values, offset)
        slope = (asked - call_law(law, t, q1 + q_by * unit, v1 + v_by * unit, 0.0, values, offset)) / unit
        fault = asked - force
        if not abs(slope) < FINITE or slope <= -1.0:
            break
        if abs(fault) < max(tolerance, ROUNDED * slope * abs(force)):
            return force, slope
        if fault > 0.0:
            low = force
        else:
            high = force
        force += fault / (1.0 + slope)
        if not low < force < high:
            force = 0.5 * (low + high)
    return force, -1.0


@njit(**OPTIONS)
def internal_state(
    rate: int, values: FloatArray, offset: int, t: float, h: float,
    q0: float, v0: float, z0: float, q1: float, v1: float,
) -> float:  # fmt: skip
    """Z at the end of a step, reached at t with q1, v1, by the trapezoidal rule, solved by Newton's method."""
    known = z0 + 0.5 * h * call_law(rate, t - h, q0, v0, z0, values, offset)
    z = z0
    for _ in range(MAX_ITERATIONS):
        fault = z - known - 0.5 * h * call_law(rate, t, q1, v1, z, values, offset)
        above = call_law(rate, t, q1, v1, z + SLOPE_NUDGE, values, offset)
        below = call_law(rate, t, q1, v1, z - SLOPE_NUDGE, values, offset)
        z -= fault / (1.0 - 0.5 * h * min(0.0, (above - below) / (2.0 * SLOPE_NUDGE)))
        if abs(fault) < INTERNAL_TOLERANCE:
            break
    return z


@njit(**INLINE)
def normal_force(law: int, values: FloatArray, offset: int, t: float, p: float, rate: float, bilateral: float) -> float:
    """Normal force of a contact, not yet kept from pulling; 0 where it is open."""
    return float(call_law(law, t, p, rate, 0.0, values, offset)) if p > 0.0 or bilateral > 0.0 else 0.0


@njit(**INLINE)
def on_structure(normal: float, side: float, bilateral: float) -> float:
    """Force of a contact on the structure, kept from pulling unless it is bilateral."""
    return -side * (normal if bilateral > 0.0 else max(0.0, normal))


@njit(**OPTIONS)
def reached(reading: Reading, pushed: FloatArray) -> FloatArray:
    """(n_ports, n_rows) what is read after a step in which a unit force pushed a port as (n_ports, 2n) says."""
    first, width = reading.first, reading.rows.shape[1]
    motion: FloatArray = np.dot(np.ascontiguousarray(pushed[:, first : first + width]), reading.rows.T)
    return motion


def march(
    linear: Linear, items: Items, inputs: FloatArray, base: FloatArray, state: FloatArray,
    read: Reading, out: FloatArray, trace: FloatArray, tolerance: float,
) -> int:  # fmt: skip
    """March from the start; arguments and result as ``march_on``."""
    memory = Memory.fresh(len(linear.q_rest), len(items.port))
    done: int = march_on(linear, items, inputs, base, state, memory, 0, read, out, trace, tolerance)
    return done


@njit(**OPTIONS)
def march_on(  # noqa: C901, PLR0912, PLR0915
    linear: Linear, items: Items, inputs: FloatArray, base: FloatArray, state: FloatArray, memory: Memory, past: int,
    read: Reading, out: FloatArray, trace: FloatArray, tolerance: float,
) -> int:  # fmt: skip
    """March over all columns of ``out`` and record, on from where an earlier march has stopped.

    Args:
        linear: one step of the linear part.
        items: laws and contacts.
        inputs: (n_in, n_steps + 1) known inputs.
        base: (2, n_steps + 1) displacement and velocity of the base, or (2, 0).
        state: (2n,) at the start, changed in place.
        memory: of the last step, changed in place; filled from the state where there was none.
        past: steps done before, which tell the laws the time.
        read: (n_out,) what is recorded.
        out: (n_out, n_steps + 1), filled.
        trace: (n_steps + 1, 2 n_ports + n_items), filled with q, v of the ports and the items' forces; (0, 0) for none.
        tolerance: change of a force that ends the iteration, N.

    Returns:
        the number of steps done; less than n_steps where the motion left the finite numbers.
    """
    # Fields become locals, once: reading a field in a loop would count its references.
    exponential, in_start, in_end, port_start, port_end, q_read, v_read, q_rest, absolute, h = linear
    law_of, rate_of, values, offset, contact, is_contact, straight, rest_force = items[1:]
    port_of = items.port.astype(np.uint64)  # unsigned: no index has to be asked whether it counts from the end
    n, n_steps = exponential.shape[1], int(out.shape[1] - 1)
    n_ports, n_items, n_in, n_out = q_rest.shape[0], port_of.shape[0], in_start.shape[0], out.shape[0]
    q_rows, v_rows, out_rows = q_read.rows, v_read.rows, read.rows
    q_width, v_width, out_width = q_rows.shape[1], v_rows.shape[1], out_rows.shape[1]
    q_start, q_end = reached(q_read, port_start), reached(q_read, port_end)
    v_start, v_end = reached(v_read, port_start), reached(v_read, port_end)
    q0, v0, q1, v1 = memory.q.copy(), memory.v.copy(), np.zeros(n_ports), np.zeros(n_ports)
    z0, z1 = memory.z.copy(), np.zeros(n_items)
    a, b = np.zeros(n_items), np.zeros(n_items)
    force, before, port_a, port_b = np.zeros(n_items), memory.before.copy(), np.zeros(n_ports), np.zeros(n_ports)
    p0, r0, side0, n0 = np.zeros(n_items), np.zeros(n_items), np.ones(n_items), np.zeros(n_items)
    newton, steep, unmet = memory.newton.copy(), memory.steep.copy(), np.zeros(n_items, np.bool_)
    joined = np.flatnonzero((straight[:, 0] > 0.0) & np.isfinite(straight[:, 1] + straight[:, 2]))[:MOST_JOINED]
    inverses = inverses_of(straight, joined, items.port, h, q_start, q_end, v_start, v_end)
    n_joined, fault, is_joined = len(joined), np.zeros(2 * len(joined)), np.zeros(n_items, np.bool_)
    for s in range(n_joined if past == 0 else 0):
        newton[joined[s]] = inverses[1 << s][2 * s : 2 * s + 2, 2 * s : 2 * s + 2]
    new = state.copy()
    first, second, new_first, new_second = state[:n], state[n:], new[:n], new[n:]
    q_state, v_state, out_state = new[q_read.first :], new[v_read.first :], new[read.first :]
    for i in range(n_ports if past == 0 else 0):
        q0[i], v0[i] = q_rest[i], 0.0
        for k in range(q_width):
            q0[i] += q_rows[i, k] * q_state[k]
        for k in range(v_width):
            v0[i] += v_rows[i, k] * v_state[k]
        if absolute[i] > 0.0 and base.shape[1] > 0:
            q0[i] += base[0, 0]
            v0[i] += base[1, 0]
    t = past * h
    for j in range(n_items):
        i = port_of[j]
        if is_contact[j]:
            p0[j], r0[j], side0[j] = penetration_of(contact, j, t, q0[i], v0[i])
            n0[j] = normal_force(law_of[j], values, offset[j], t, p0[j], r0[j], contact[j, 3])
            force[j] = on_structure(n0[j], side0[j], contact[j, 3])
        else:
            force[j] = call_law(law_of[j], t, q0[i], v0[i], z0[j], values, offset[j])
        if past == 0:
            before[j] = force[j]
    for m in range(n_out):
        out[m, 0] = 0.0
        for k in range(out_width):
            out[m, 0] += out_rows[m, k] * out_state[k]
    tracing = trace.shape[0] > 0
    for step in range(n_steps):
        if tracing:
            for i in range(n_ports):
                trace[step, i] = q0[i]
                trace[step, n_ports + i] = v0[i]
            for j in range(n_items):
                trace[step, 2 * n_ports + j] = force[j]
        t = (past + step + 1) * h
        for k in range(n):
            new_first[k] = exponential[0, k] * first[k] + exponential[1, k] * second[k]
            new_second[k] = exponential[2, k] * first[k] + exponential[3, k] * second[k]
        for m in range(n_in):
            u0, u1 = inputs[m, step], inputs[m, step + 1]
            for k in range(2 * n):
                new[k] += in_start[m, k] * u0 + in_end[m, k] * u1
        for i in range(n_ports):
            total_q, total_v = q_rest[i], 0.0
            for k in range(q_width):
                total_q += q_rows[i, k] * q_state[k]
            for k in range(v_width):
                total_v += v_rows[i, k] * v_state[k]
            if absolute[i] > 0.0 and base.shape[1] > 0:
                total_q += base[0, step + 1]
                total_v += base[1, step + 1]
            q1[i], v1[i] = total_q, total_v
            port_a[i], port_b[i] = 0.0, 0.0
        for j in range(n_items):
            i = port_of[j]
            is_open = is_contact[j] and p0[j] <= 0.0 and contact[j, 3] == 0.0
            a[j], b[j] = force[j], 0.0 if is_open else 2.0 * force[j] - before[j]
            z1[j] = z0[j]
            port_a[i] += a[j] - rest_force[j]
            port_b[i] += b[j] - rest_force[j]
        for i in range(n_ports):
            if port_a[i] != 0.0 or port_b[i] != 0.0:
                for m in range(n_ports):
                    q1[m] += q_start[i, m] * port_a[i] + q_end[i, m] * port_b[i]
                    v1[m] += v_start[i, m] * port_a[i] + v_end[i, m] * port_b[i]
        closed = 0
        for s in range(n_joined):
            j = joined[s]
            is_joined[j] = contact[j, 3] > 0.0 or (p0[j] > 0.0 and n0[j] >= 0.0)
            closed += is_joined[j] << s
        largest = 0.0
        for iteration in range(MAX_ITERATIONS):
            previous, largest, n_asked = largest, 0.0, 0
            if closed > 0:
                closed, largest = met_together(
                    inverses, closed, joined, is_joined, straight, contact, port_of, t, h, p0, r0, side0, n0, a, b,
                    port_a, port_b, q1, v1, q_start, q_end, v_start, v_end, fault,
                )  # fmt: skip
                for j in range(n_items if closed == 0 else 0):
                    is_joined[j] = False
            for j in range(n_items):
                if is_joined[j]:
                    continue
                i = port_of[j]
                is_open = is_contact[j] and p0[j] <= 0.0 and a[j] == 0.0 and b[j] == 0.0 and contact[j, 3] == 0.0
                if is_open and penetration_of(contact, j, t, q1[i], v1[i])[0] <= 0.0:  # to the end, as guessed
                    continue
                n_asked += 1
                change, da, db, is_steady = 0.0, 0.0, 0.0, False
                if (steep[j] or (iteration >= STEEP_AFTER and unmet[j])) and not is_contact[j] and rate_of[j] == 0:
                    q_by, v_by = q_start[i, i] + q_end[i, i], v_start[i, i] + v_end[i, i]
                    q, v = q1[i] + q_end[i, i] * (a[j] - b[j]), v1[i] + v_end[i, i] * (a[j] - b[j])
                    steady, slope = steady_force(law_of[j], values, offset[j], t, q, v, q_by, v_by, a[j], tolerance)
                    steep[j] = slope > LEAST_STEEP
                    is_steady = slope > (LEAST_STEEP if iteration < GIVEN_UP else -1.0)
                if is_steady:
                    da, db = steady - a[j], steady - b[j]
                    change = abs(da) + abs(db)
                else:
                    a_new, b_new, a_by_a, b_by_a, unit = 0.0, 0.0, 0.0, 0.0, 0.0
                    # The motion as it is, then with a little more of the force's start, then of its end.
                    for probe in range(3):
                        q, v = q1[i], v1[i]
                        if probe == 1:
                            q, v = q + q_start[i, i] * unit, v + v_start[i, i] * unit
                        elif probe == 2:
                            q, v = q + q_end[i, i] * unit, v + v_end[i, i] * unit
                        if is_contact[j]:
                            a_near, b_near = contact_step(
                                law_of[j], values, offset[j], contact, j, t, h, p0[j], r0[j], side0[j], n0[j], q, v
                            )
                        elif rate_of[j] == 0:
                            a_near, b_near = law_step(law_of[j], values, offset[j], t, h, q0[i], v0[i], force[j], q, v)
                        else:
                            z = internal_state(rate_of[j], values, offset[j], t, h, q0[i], v0[i], z0[j], q, v)
                            a_near, b_near = force[j], call_law(law_of[j], t, q, v, z, values, offset[j])
                            if probe == 0:
                                z1[j] = z
                        if probe == 0:
                            a_new, b_new = a_near, b_near
                            change = abs(a_new - a[j]) + abs(b_new - b[j])
                            if change < tolerance or iteration <= LAST_OLD_SLOPE:
                                break
                            unit = tolerance + SLOPE_NUDGE * abs(b_new)
                        elif probe == 1:
                            a_by_a, b_by_a = (a_near - a_new) / unit, (b_near - b_new) / unit
                        else:
                            a_by_b, b_by_b = (a_near - a_new) / unit, (b_near - b_new) / unit
                            determinant = (1.0 - a_by_a) * (1.0 - b_by_b) - a_by_b * b_by_a
                            if LEAST_DETERMINANT < determinant < LARGEST_DETERMINANT:
                                newton[j, 0, 0], newton[j, 0, 1] = (1.0 - b_by_b) / determinant, a_by_b / determinant
                                newton[j, 1, 0], newton[j, 1, 1] = b_by_a / determinant, (1.0 - a_by_a) / determinant
                    damped = 1.0 if iteration < MAX_ITERATIONS // 3 else 0.5
                    da = damped * (newton[j, 0, 0] * (a_new - a[j]) + newton[j, 0, 1] * (b_new - b[j]))
                    db = damped * (newton[j, 1, 0] * (a_new - a[j]) + newton[j, 1, 1] * (b_new - b[j]))
                unmet[j] = change >= tolerance
                if not unmet[j]:
                    continue
                largest = max(largest, change)
                a[j] += da
                b[j] += db
                port_a[i] += da
                port_b[i] += db
                for m in range(n_ports):
                    q1[m] += q_start[i, m] * da + q_end[i, m] * db
                    v1[m] += v_start[i, m] * da + v_end[i, m] * db
            if n_asked == 0 or largest < tolerance or largest * largest < CONVERGING * tolerance * previous:
                break
        for i in range(n_ports):
            if port_a[i] != 0.0 or port_b[i] != 0.0:
                for k in range(2 * n):
                    new[k] += port_start[i, k] * port_a[i] + port_end[i, k] * port_b[i]
        for k in range(2 * n):
            state[k] = new[k]
        for j in range(n_items):
            i = port_of[j]
            before[j] = force[j]
            z0[j] = z1[j]
            if is_contact[j]:
                p0[j], r0[j], side0[j] = penetration_of(contact, j, t, q1[i], v1[i])
                n0[j] = normal_force(law_of[j], values, offset[j], t, p0[j], r0[j], contact[j, 3])
                force[j] = on_structure(n0[j], side0[j], contact[j, 3])
            else:
                force[j] = call_law(law_of[j], t, q1[i], v1[i], z1[j], values, offset[j])
        for i in range(n_ports):
            q0[i], v0[i] = q1[i], v1[i]
        size = 0.0
        for m in range(n_out):
            total = 0.0
            for k in range(out_width):
                total += out_rows[m, k] * out_state[k]
            out[m, step + 1] = total
            size += abs(total)
        if not size < FINITE:
            return step
    memory.q[:], memory.v[:], memory.z[:], memory.before[:], memory.newton[:] = q0, v0, z0, before, newton
    memory.steep[:] = steep
    if tracing:
        for i in range(n_ports):
            trace[n_steps, i] = q0[i]
            trace[n_steps, n_ports + i] = v0[i]
        for j in range(n_items):
            trace[n_steps, 2 * n_ports + j] = force[j]
    return n_steps
