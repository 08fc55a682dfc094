"""The compiled time stepper: the linear part exact, laws and contacts implicit, of order 2 to 4.

Within a step each force runs as a parabola over its values at the start, halfway and at the end, on the cubic of the
motion there; where a contact begins or ends within the step, on the part in which it is closed. What the linear part is
given is the straight line with the same impulse and the same first moment. The motion that it causes, and on which it
depends, is found by Newton's iteration at the few ports. docs/theory.md, section 5.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from models.arrays import FloatArray, IntArray
from models.compiled import noticing
from models.contact_forces import (
    FINITE,
    MAX_ITERATIONS,
    SLOPE_NUDGE,
    contact_step,
    internal_state,
    law_step,
    normal_force,
    on_structure,
    penetration_of,
    steady_force,
)
from models.lanes import EIGHT, FOUR, LANES, at, chosen, digits, eight, four, four_of, lanes, put, total
from models.law_call import call_law
from models.step_options import INLINE, OPTIONS
from models.straight_contacts import (
    forces_of,
    holding,
    inverses_of,
    joined_of,
    met_together,
    put_where,
    side_by_side,
    stays_out,
    weighed,
)

LAST_OLD_SLOPE = 1
"""Iterations that use the slope of an earlier step before it is formed anew."""

STEEP_AFTER, LEAST_STEEP = 12, 1.0
"""A law without internal state that has not been met by then, and would take back more than this part of a small force
through the motion within the step, counts as steep: its force is the same all through. The parabola has a middle force,
which a friction that sticks would turn about from step to step without end."""

GIVEN_UP = 30
"""Iterations after which such a law is taken so for this one step, steep or not."""

CONVERGING = 0.1
"""Of the tolerance, below which the next change is not waited for: as it goes on from the last two, it is their ratio
times the last. Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8."""

NO_DIGIT = 62
"""Of a set in binary digits, for what is in none."""

LEAST_DETERMINANT, LARGEST_DETERMINANT = 0.1, 1e6
"""Of Newton's 2 x 2 equations; others are met only where a difference straddles the gap's edge."""


class Reading(NamedTuple):
    """Rows that read something from the state, without the half of their columns that may be 0 in all of them.

    Attributes:
        rows: (n_rows, width) on the state from ``first`` on; the width is a multiple of ``LANES``.
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
        return cls(np.array(rows[:, min(first, last - half) : last], order="C"), min(first, last - half))


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


@noticing("lanes.py", "step_options.py")
@njit(**OPTIONS)
def reached(reading: Reading, pushed: FloatArray) -> FloatArray:
    """(n_ports, n_rows, and some that are 0) what is read after a step in which a unit force pushed a port.

    Args:
        reading: of rows.
        pushed: (n_ports, 2n) what the force of each port adds to the state.
    """
    first, (n_rows, width) = reading.first, reading.rows.shape
    motion = np.zeros((len(pushed), max(1, -(-n_rows // EIGHT)) * EIGHT))
    motion[:, :n_rows] = np.dot(np.ascontiguousarray(pushed[:, first : first + width]), reading.rows.T)
    return motion


@njit(**INLINE)
def moved_by(moved: FloatArray, start: FloatArray, end: FloatArray, i: int, a: float, b: float) -> None:
    """Add to the motion of all ports what the weights (a, b) of a force on port i do."""
    for k in range(0, len(moved), EIGHT):
        put(moved, k, eight(moved, k) + (eight(start, (i, k)) * a + eight(end, (i, k)) * b))


@njit(**INLINE)
def went_on(
    exponential: FloatArray, in_start: FloatArray, in_end: FloatArray, inputs: FloatArray, step: int,
    state: FloatArray, new: FloatArray,
) -> None:  # fmt: skip
    """The linear part of a step under the known inputs: ``new`` from ``state``."""
    n = exponential.shape[1]
    for k in range(0, n, LANES):
        x, y = lanes(state, k), lanes(state, n + k)
        x1 = lanes(exponential, (0, k)) * x + lanes(exponential, (1, k)) * y
        y1 = lanes(exponential, (2, k)) * x + lanes(exponential, (3, k)) * y
        for m in range(len(in_start)):
            u0, u1 = inputs[m, step], inputs[m, step + 1]
            x1 = x1 + (lanes(in_start, (m, k)) * u0 + lanes(in_end, (m, k)) * u1)
            y1 = y1 + (lanes(in_start, (m, n + k)) * u0 + lanes(in_end, (m, n + k)) * u1)
        put(new, k, x1)
        put(new, n + k, y1)


@njit(**INLINE)
def read_from(rows: FloatArray, first: int, i: int, state: FloatArray) -> float:
    """What one of the rows of a ``Reading`` reads."""
    found = 0.0
    for k in range(0, rows.shape[1], LANES):
        found += total(lanes(rows, (i, k)) * lanes(state, first + k))
    return found


@njit(**INLINE)
def pushed_on(
    new: FloatArray, port_start: FloatArray, port_end: FloatArray, port_a: FloatArray, port_b: FloatArray,
    state: FloatArray,
) -> None:  # fmt: skip
    """The state at the end of a step: the linear part's, and what the weights of the ports' forces add."""
    for k in range(0, len(state), LANES):
        x = lanes(new, k)
        for i in range(len(port_a)):
            if port_a[i] != 0.0 or port_b[i] != 0.0:
                x = x + (lanes(port_start, (i, k)) * port_a[i] + lanes(port_end, (i, k)) * port_b[i])
        put(state, k, x)


@njit(**INLINE)
def recorded(columns: FloatArray, state: FloatArray, out: FloatArray, step: int) -> bool:
    """Fill a column of ``out``; whether what it reads is finite.

    Args:
        columns: (n_groups, width, 8) columns of the rows that read, eight of them at once.
        state: (width or more,) what they read from.
        out: (n_out, n_steps + 1).
        step: column.
    """
    size, n_out = 0.0, len(out)
    for group in range(len(columns)):
        even, odd = eight(columns, (group, 0, 0)) * state[0], eight(columns, (group, 1, 0)) * state[1]
        for k in range(2, columns.shape[1], 2):
            even = even + eight(columns, (group, k, 0)) * state[k]
            odd = odd + eight(columns, (group, k + 1, 0)) * state[k + 1]
        seen = even + odd
        size += total(seen * seen)
        first = EIGHT * group
        if first + EIGHT <= n_out:
            for m in range(EIGHT):
                out[first + m, step] = at(seen, m)
        else:
            for m in range(n_out - first):
                out[first + m, step] = at(seen, m)
    return size < FINITE * FINITE


def march(
    linear: Linear, items: Items, inputs: FloatArray, base: FloatArray, state: FloatArray,
    read: Reading, out: FloatArray, trace: FloatArray, tolerance: float,
) -> int:  # fmt: skip
    """March from the start; arguments and result as ``march_on``."""
    memory = Memory.fresh(len(linear.q_rest), len(items.port))
    done: int = march_on(linear, items, inputs, base, state, memory, 0, read, out, trace, tolerance)
    return done


@noticing("contact_forces.py", "lanes.py", "law_call.py", "step_options.py", "straight_contacts.py")
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
    rest = np.concatenate((rest_force, np.zeros(FOUR)))
    n, n_steps = exponential.shape[1], int(out.shape[1] - 1)
    n_ports, n_items, n_out = q_rest.shape[0], rate_of.shape[0], out.shape[0]
    q_rows, v_rows, out_rows = q_read.rows, v_read.rows, read.rows
    q_first, v_first, out_first = q_read.first, v_read.first, read.first
    q_width, v_width, out_width = q_rows.shape[1], v_rows.shape[1], out_rows.shape[1]
    q_start, q_end = reached(q_read, port_start), reached(q_read, port_end)
    v_start, v_end = reached(v_read, port_start), reached(v_read, port_end)
    width, padded = q_start.shape[1], n_items + FOUR  # four items can be read from any on, so there are four more
    q0, v0, q1, v1 = np.zeros(width), np.zeros(width), np.zeros(width), np.zeros(width)
    q0[:n_ports], v0[:n_ports] = memory.q, memory.v
    z0, z1, port_a, port_b = memory.z.copy(), np.zeros(n_items), np.zeros(n_ports), np.zeros(n_ports)
    newton, steep, unmet = memory.newton.copy(), memory.steep.copy(), np.zeros(n_items, np.bool_)
    a, b, force, before = np.zeros(padded), np.zeros(padded), np.zeros(padded), np.zeros(padded)
    p0, r0, n0, side0 = np.zeros(padded), np.zeros(padded), np.zeros(padded), np.zeros(padded)
    before[:n_items] = memory.before
    port_of = np.zeros(padded, np.uint64)  # unsigned: no index has to be asked whether it counts from the end
    port_of[:n_items] = items.port
    joined, n_joined = joined_of(straight)
    together, contacts = slice(joined, joined + n_joined), side_by_side(straight, contact, joined, n_joined)
    inverses = inverses_of(straight[together], items.port[together], h, q_start, q_end, v_start, v_end)
    for s in range(n_joined if past == 0 else 0):
        for x in range(4):
            newton[joined + s, x // 2, x % 2] = inverses[1 << s, s + FOUR * (x % 2), s + FOUR * (x // 2)]
    port4, digit = port_of[joined : joined + FOUR].copy(), np.full(n_items, NO_DIGIT)
    digit[together] = np.arange(n_joined)
    others, room = np.flatnonzero(digit == NO_DIGIT).astype(np.uint64), np.zeros((4, EIGHT))
    new, seen_from = np.zeros(2 * n), state[out_first:]
    out_columns = np.zeros((-(-n_out // EIGHT), out_width, EIGHT))
    for m in range(n_out):
        out_columns[m // EIGHT, :, m % EIGHT] = out_rows[m]
    for i in range(n_ports if past == 0 else 0):
        q0[i], v0[i] = q_rest[i], 0.0
        for k in range(q_width):
            q0[i] += q_rows[i, k] * state[q_first + k]
        for k in range(v_width):
            v0[i] += v_rows[i, k] * state[v_first + k]
        if absolute[i] > 0.0 and base.shape[1] > 0:
            q0[i] += base[0, 0]
            v0[i] += base[1, 0]
    t = past * h
    for o in range(len(others)):
        j = others[o]
        i = port_of[j]
        if is_contact[j]:
            p0[j], r0[j], side0[j] = penetration_of(contact, j, t, q0[i], v0[i])
            n0[j] = normal_force(law_of[j], values, offset[j], t, p0[j], r0[j], contact[j, 3])
            force[j] = on_structure(n0[j], side0[j], contact[j, 3])
        else:
            force[j] = call_law(law_of[j], t, q0[i], v0[i], z0[j], values, offset[j])
        if past == 0:
            before[j] = force[j]
    is_there = contacts.is_bilateral | contacts.is_unilateral
    start = weighed(contacts, t, four_of(q0, port4, 0), four_of(v0, port4, 0))
    end, is_closed, all_joined = start, holding(contacts, start), (1 << n_joined) - 1
    closed = digits(is_closed)
    if n_joined > 0:
        put_where(is_there, force, joined, forces_of(contacts, start))
        if past == 0:
            put_where(is_there, before, joined, four(force, joined))
    for m in range(n_out):
        out[m, 0] = 0.0
        for k in range(out_width):
            out[m, 0] += out_rows[m, k] * seen_from[k]
    tracing = trace.shape[0] > 0
    for step in range(n_steps):
        if tracing:
            for i in range(n_ports):
                trace[step, i] = q0[i]
                trace[step, n_ports + i] = v0[i]
            for j in range(n_items):
                trace[step, 2 * n_ports + j] = force[j]
        t = (past + step + 1) * h
        went_on(exponential, in_start, in_end, inputs, step, state, new)
        for i in range(n_ports):
            q1[i] = q_rest[i] + read_from(q_rows, q_first, i, new)
            v1[i] = read_from(v_rows, v_first, i, new)
            if absolute[i] > 0.0 and base.shape[1] > 0:
                q1[i] += base[0, step + 1]
                v1[i] += base[1, step + 1]
            port_a[i], port_b[i] = 0.0, 0.0
        if n_joined > 0:  # those closed are met at once, from any weights; the others are guessed to have no force
            guess = chosen(is_closed, four(rest, joined), 0.0)
            put(a, joined, guess)
            put(b, joined, guess)
            for s in range(n_joined):
                port_a[port4[s]] += a[joined + s] - rest[joined + s]
                port_b[port4[s]] += a[joined + s] - rest[joined + s]
        for o in range(len(others)):
            j = others[o]
            i = port_of[j]
            is_open = is_contact[j] and p0[j] <= 0.0 and contact[j, 3] == 0.0
            a[j], b[j] = force[j], 0.0 if is_open else 2.0 * force[j] - before[j]
            z1[j] = z0[j]
            port_a[i] += a[j] - rest[j]
            port_b[i] += b[j] - rest[j]
        for i in range(n_ports):
            if port_a[i] != 0.0 or port_b[i] != 0.0:
                moved_by(q1, q_start, q_end, i, port_a[i], port_b[i])
                moved_by(v1, v_start, v_end, i, port_a[i], port_b[i])
        largest = 0.0
        for iteration in range(MAX_ITERATIONS):
            previous, largest, n_asked, quiet = largest, 0.0, 0, closed
            if closed > 0:
                closed, largest = met_together(
                    contacts, start, closed, t, h, inverses, n_joined, port4, a, b, joined, port_a, port_b, q1, v1,
                    q_start, q_end, v_start, v_end, room,
                )  # fmt: skip
            if n_joined > 0:
                end = weighed(contacts, t, four_of(q1, port4, 0), four_of(v1, port4, 0))
                quiet = closed | digits(stays_out(contacts, start, end, four(a, joined), four(b, joined)))
                if quiet & all_joined == all_joined and len(others) == 0:
                    break
                put_where(is_there, p0, joined, start.p)
                put_where(is_there, r0, joined, start.rate)
                put_where(is_there, side0, joined, start.side)
                put_where(is_there, n0, joined, start.normal)
            for j in range(n_items):
                if quiet >> digit[j] & 1:
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
                moved_by(q1, q_start, q_end, i, da, db)
                moved_by(v1, v_start, v_end, i, da, db)
            if n_asked == 0 or largest < tolerance or largest * largest < CONVERGING * tolerance * previous:
                break
        pushed_on(new, port_start, port_end, port_a, port_b, state)
        for o in range(len(others)):
            j = others[o]
            i = port_of[j]
            before[j] = force[j]
            z0[j] = z1[j]
            if is_contact[j]:
                p0[j], r0[j], side0[j] = penetration_of(contact, j, t, q1[i], v1[i])
                n0[j] = normal_force(law_of[j], values, offset[j], t, p0[j], r0[j], contact[j, 3])
                force[j] = on_structure(n0[j], side0[j], contact[j, 3])
            else:
                force[j] = call_law(law_of[j], t, q1[i], v1[i], z1[j], values, offset[j])
        if n_joined > 0:
            start = weighed(contacts, t, four_of(q1, port4, 0), four_of(v1, port4, 0)) if n_asked > 0 else end
            is_closed = holding(contacts, start)
            closed = digits(is_closed)
            put_where(is_there, before, joined, four(force, joined))
            put_where(is_there, force, joined, forces_of(contacts, start))
        for i in range(n_ports):
            q0[i], v0[i] = q1[i], v1[i]
        if not recorded(out_columns, seen_from, out, step + 1):
            return step
    memory.q[:], memory.v[:], memory.z[:], memory.before[:] = q0[:n_ports], v0[:n_ports], z0, before[:n_items]
    memory.newton[:], memory.steep[:] = newton, steep
    if tracing:
        for i in range(n_ports):
            trace[n_steps, i] = q0[i]
            trace[n_steps, n_ports + i] = v0[i]
        for j in range(n_items):
            trace[n_steps, 2 * n_ports + j] = force[j]
    return n_steps
