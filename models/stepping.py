"""The compiled time stepper: the linear part exact, laws and contacts implicit and second order.

Within a step each law's force runs straight from its value at the start to its value at the end; that end value depends
on the motion it causes and is found by a damped Newton iteration at the few ports. Where a contact begins or ends within a
step, the force that acts only for a part of it is replaced by the straight line with the same impulse and the same first
moment, so that neither the jump of a dashpot nor the corner of a spring costs the order of the method.
docs/theory.md, section 5.
"""

from typing import Any

import numpy as np
from numba import njit

from models.law_call import call_law

MAX_ITERATIONS = 60
SLOPE_NUDGE = 1e-6
LAST_OLD_SLOPE = 1
"""Iterations that use the slope of an earlier step before it is formed anew."""

MAX_SLOPE = 1e6
"""Slope of a force per unit of its own end value; more is met only where a difference straddles the gap's edge."""

OPTIONS: dict[str, Any] = {"nogil": True, "cache": True, "fastmath": {"contract", "reassoc", "nsz", "arcp"}}


@njit(**OPTIONS)
def penetration_of(q, v, t, contacts, j):  # type: ignore[no-untyped-def]
    """(p, dp/dt, side) of contact row j (clearance, offset, clearance rate, bilateral) at q, v."""
    u = q - contacts[j, 1]
    side = 1.0 if u >= 0.0 else -1.0
    return side * u - contacts[j, 0] - contacts[j, 2] * t, side * v - contacts[j, 2], side


@njit(**OPTIONS)
def part_step(start, end, at_start, at_end):  # type: ignore[no-untyped-def]
    """Weights (a, b) of the straight line over the whole step with the impulse and first moment of a force on a part.

    The force runs straight from ``at_start`` at the fraction ``start`` to ``at_end`` at ``end``; where it would pull, it
    is 0.
    """
    if at_start <= 0.0 and at_end <= 0.0:
        return 0.0, 0.0
    if at_start < 0.0:
        start += (end - start) * at_start / (at_start - at_end)
        at_start = 0.0
    elif at_end < 0.0:
        end = start + (end - start) * at_start / (at_start - at_end)
        at_end = 0.0
    width = end - start
    impulse = 0.5 * width * (at_start + at_end)
    moment = start * impulse + width * width * (at_start / 6.0 + at_end / 3.0)
    return 4.0 * impulse - 6.0 * moment, 6.0 * moment - 2.0 * impulse


@njit(**OPTIONS)
def crossing(p0, r0, p1, r1):  # type: ignore[no-untyped-def]
    """Fraction of the step at which the cubic through (p0, slope r0) and (p1, slope r1) passes 0, and its slope there."""
    s = p0 / (p0 - p1)
    c2, c3 = 3.0 * (p1 - p0) - 2.0 * r0 - r1, 2.0 * (p0 - p1) + r0 + r1
    for _ in range(4):
        slope = r0 + s * (2.0 * c2 + 3.0 * s * c3)
        if slope * (p1 - p0) <= 0.0:
            break
        s -= (p0 + s * (r0 + s * (c2 + s * c3))) / slope
        s = min(max(s, 0.0), 1.0)
    return s, r0 + s * (2.0 * c2 + 3.0 * s * c3)


@njit(**OPTIONS)
def contact_normal(law, t, p, rate, values, offset):  # type: ignore[no-untyped-def]
    """Normal force before it is kept from pulling."""
    return call_law(law, t, p, rate, 0.0, values, offset)


@njit(**OPTIONS)
def contact_step(law, values, offset, contacts, j, t, h, p0, r0, side0, n0, q1, v1):  # type: ignore[no-untyped-def]
    """Weights (a, b) of a contact's force on the structure over a step that ends at t with q1, v1.

    The step starts with penetration p0 at rate r0 on side0, and with the normal force n0, not yet kept from pulling.
    """
    p1, r1, side1 = penetration_of(q1, v1, t, contacts, j)
    if contacts[j, 3] > 0.0:
        return -side0 * n0, -side1 * contact_normal(law, t, p1, r1, values, offset)
    if p0 <= 0.0 and p1 <= 0.0:
        return 0.0, 0.0
    n1 = contact_normal(law, t, p1, r1, values, offset) if p1 > 0.0 else 0.0
    if p0 > 0.0 and p1 > 0.0 and side0 == side1:
        if n0 >= 0.0 and n1 >= 0.0:
            return -side0 * n0, -side1 * n1
        a, b = part_step(0.0, 1.0, n0, n1)
        return -side0 * a, -side0 * b
    if side0 != side1:
        return (-side0 * max(0.0, n0) if p0 > 0.0 else 0.0), (-side1 * max(0.0, n1) if p1 > 0.0 else 0.0)
    s, slope = crossing(p0, r0 * h, p1, r1 * h)
    at_crossing = contact_normal(law, t - (1.0 - s) * h, 0.0, slope / h, values, offset)
    a, b = part_step(s, 1.0, at_crossing, n1) if p1 > 0.0 else part_step(0.0, s, n0, at_crossing)
    return -side0 * a, -side0 * b


@njit(**OPTIONS)
def internal_state(rate, values, offset, t, h, q0, v0, z0, q1, v1):  # type: ignore[no-untyped-def]
    """z at the end of the step by the trapezoidal rule, solved by Newton's method."""
    start = call_law(rate, t, q0, v0, z0, values, offset)
    z = z0
    for _ in range(MAX_ITERATIONS):
        fault = z - z0 - 0.5 * h * (start + call_law(rate, t + h, q1, v1, z, values, offset))
        above = call_law(rate, t + h, q1, v1, z + SLOPE_NUDGE, values, offset)
        below = call_law(rate, t + h, q1, v1, z - SLOPE_NUDGE, values, offset)
        gain = 1.0 - 0.5 * h * min(0.0, (above - below) / (2.0 * SLOPE_NUDGE))
        z -= fault / gain
        if abs(fault) < 1e-12:
            break
    return z


@njit(**OPTIONS)
def contact_force_at(law, values, offset, contacts, j, t, q, v):  # type: ignore[no-untyped-def]
    """Force of a contact on the structure at an instant."""
    p, rate, side = penetration_of(q, v, t, contacts, j)
    if contacts[j, 3] > 0.0:
        return -side * contact_normal(law, t, p, rate, values, offset)
    return -side * max(0.0, contact_normal(law, t, p, rate, values, offset)) if p > 0.0 else 0.0


@njit(**OPTIONS)
def march(  # type: ignore[no-untyped-def]  # noqa: C901, PLR0912, PLR0913, PLR0915
    exponential, in_start, in_end, port_start, port_end, state, inputs, q_rows, v_rows, q_rest, base, moves,
    out_rows, out, trace, n_steps, h, port_of, law_of, rate_of, values, offsets, contacts, is_contact, rest_force,
    tolerance,
):  # fmt: skip
    """March ``n_steps`` steps and record.

    Args:
        exponential: (4, n) of ``propagator.Step``.
        in_start, in_end: (n_in, 2n) of ``propagator.Step`` for the known inputs.
        port_start, port_end: (n_ports, 2n) the same for unit port forces.
        state: (2n,) at the start, changed in place.
        inputs: (n_in, n_steps + 1) known inputs.
        q_rows, v_rows: (n_ports, 2n) port motion from the state.
        q_rest: (n_ports,) q at rest.
        base: (2, n_steps + 1) displacement and velocity of the base, or (2, 0).
        moves: (n_ports,) 1 where the port reads absolute motion.
        out_rows: (n_out, 2n) what is recorded; out: (n_steps + 1, n_out) is filled.
        trace: (n_steps + 1, 2 n_ports + n_items) is filled with q, v of the ports and the items' forces; (0, 0) for none.
        port_of, law_of, rate_of, offsets, is_contact: (n_items,) port, law addresses (0 for none), place in ``values``.
        contacts: (n_items, 4) clearance, offset, clearance rate, bilateral.
        rest_force: (n_items,) the items' forces at rest, already balanced.
        tolerance: change of a force that ends the iteration, N.

    Returns:
        the number of steps done; less than n_steps where the motion left the finite numbers.
    """
    n = exponential.shape[1]
    n_ports, n_items, n_in, n_out = q_rows.shape[0], port_of.shape[0], in_start.shape[0], out_rows.shape[0]
    q_start = np.zeros((n_ports, n_ports))
    q_end, v_start, v_end = np.zeros_like(q_start), np.zeros_like(q_start), np.zeros_like(q_start)
    for i in range(n_ports):
        for j in range(n_ports):
            for k in range(2 * n):
                q_start[i, j] += q_rows[i, k] * port_start[j, k]
                q_end[i, j] += q_rows[i, k] * port_end[j, k]
                v_start[i, j] += v_rows[i, k] * port_start[j, k]
                v_end[i, j] += v_rows[i, k] * port_end[j, k]
    q0, v0, q1, v1 = np.zeros(n_ports), np.zeros(n_ports), np.zeros(n_ports), np.zeros(n_ports)
    z0, z1 = np.zeros(n_items), np.zeros(n_items)
    a, b = np.zeros(n_items), np.zeros(n_items)
    force, before, port_a, port_b = np.zeros(n_items), np.zeros(n_items), np.zeros(n_ports), np.zeros(n_ports)
    p0, r0, side0, n0 = np.zeros(n_items), np.zeros(n_items), np.ones(n_items), np.zeros(n_items)
    weight = np.ones(n_items)
    new = np.zeros(2 * n)
    for i in range(n_ports):
        q0[i] = q_rest[i]
        for k in range(2 * n):
            q0[i] += q_rows[i, k] * state[k]
            v0[i] += v_rows[i, k] * state[k]
        if moves[i] > 0.0 and base.shape[1] > 0:
            q0[i] += base[0, 0]
            v0[i] += base[1, 0]
    for j in range(n_items):
        i = port_of[j]
        if is_contact[j]:
            p0[j], r0[j], side0[j] = penetration_of(q0[i], v0[i], 0.0, contacts, j)
            if p0[j] > 0.0 or contacts[j, 3] > 0.0:
                n0[j] = contact_normal(law_of[j], 0.0, p0[j], r0[j], values, offsets[j])
            force[j] = -side0[j] * (n0[j] if contacts[j, 3] > 0.0 else max(0.0, n0[j]))
        else:
            force[j] = call_law(law_of[j], 0.0, q0[i], v0[i], 0.0, values, offsets[j])
        before[j] = force[j]
    for k in range(n_out):
        total = 0.0
        for i in range(2 * n):
            total += out_rows[k, i] * state[i]
        out[0, k] = total
    tracing = trace.shape[0] > 0
    for step in range(n_steps):
        if tracing:
            for i in range(n_ports):
                trace[step, i] = q0[i]
                trace[step, n_ports + i] = v0[i]
            for j in range(n_items):
                trace[step, 2 * n_ports + j] = force[j]
        t = step * h
        for k in range(n):
            new[k] = exponential[0, k] * state[k] + exponential[1, k] * state[n + k]
            new[n + k] = exponential[2, k] * state[k] + exponential[3, k] * state[n + k]
        for m in range(n_in):
            first, last = inputs[m, step], inputs[m, step + 1]
            for k in range(2 * n):
                new[k] += in_start[m, k] * first + in_end[m, k] * last
        for i in range(n_ports):
            total_q, total_v = q_rest[i], 0.0
            for k in range(2 * n):
                total_q += q_rows[i, k] * new[k]
                total_v += v_rows[i, k] * new[k]
            if moves[i] > 0.0 and base.shape[1] > 0:
                total_q += base[0, step + 1]
                total_v += base[1, step + 1]
            q1[i], v1[i] = total_q, total_v
            port_a[i], port_b[i] = 0.0, 0.0
        for j in range(n_items):
            i = port_of[j]
            a[j], b[j] = force[j], 2.0 * force[j] - before[j]
            z1[j] = z0[j]
            port_a[i] += a[j] - rest_force[j]
            port_b[i] += b[j] - rest_force[j]
        for i in range(n_ports):
            for j in range(n_ports):
                q1[i] += q_start[i, j] * port_a[j] + q_end[i, j] * port_b[j]
                v1[i] += v_start[i, j] * port_a[j] + v_end[i, j] * port_b[j]
        for iteration in range(MAX_ITERATIONS):
            largest = 0.0
            for j in range(n_items):
                i = port_of[j]
                if is_contact[j]:
                    a_new, b_new = contact_step(
                        law_of[j], values, offsets[j], contacts, j, t + h, h, p0[j], r0[j], side0[j], n0[j], q1[i], v1[i]
                    )
                else:
                    if rate_of[j] != 0:
                        z1[j] = internal_state(
                            rate_of[j], values, offsets[j], t, h, q0[i], v0[i], z0[j], q1[i], v1[i]
                        )
                    a_new = force[j]
                    b_new = call_law(law_of[j], t + h, q1[i], v1[i], z1[j], values, offsets[j])
                change = abs(a_new - a[j]) + abs(b_new - b[j])
                if change < tolerance:
                    continue
                largest = max(largest, change)
                if iteration == LAST_OLD_SLOPE + 1 or (iteration > LAST_OLD_SLOPE and not is_contact[j]):
                    unit = tolerance + SLOPE_NUDGE * abs(b_new)
                    q_near, v_near = q1[i] + q_end[i, i] * unit, v1[i] + v_end[i, i] * unit
                    if is_contact[j]:
                        here = contact_force_at(law_of[j], values, offsets[j], contacts, j, t + h, q1[i], v1[i])
                        near = contact_force_at(law_of[j], values, offsets[j], contacts, j, t + h, q_near, v_near)
                    else:
                        z_near, here = z1[j], b_new
                        if rate_of[j] != 0:
                            z_near = internal_state(
                                rate_of[j], values, offsets[j], t, h, q0[i], v0[i], z0[j], q_near, v_near
                            )
                        near = call_law(law_of[j], t + h, q_near, v_near, z_near, values, offsets[j])
                    weight[j] = 1.0 / (1.0 - max(-MAX_SLOPE, min(0.0, (near - here) / unit)))
                damped = weight[j] if iteration < MAX_ITERATIONS // 3 else 0.5 * weight[j]
                da, db = damped * (a_new - a[j]), damped * (b_new - b[j])
                a[j] += da
                b[j] += db
                port_a[i] += da
                port_b[i] += db
                for m in range(n_ports):
                    q1[m] += q_start[m, i] * da + q_end[m, i] * db
                    v1[m] += v_start[m, i] * da + v_end[m, i] * db
            if largest < tolerance:
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
                p0[j], r0[j], side0[j] = penetration_of(q1[i], v1[i], t + h, contacts, j)
                n0[j] = 0.0
                if p0[j] > 0.0 or contacts[j, 3] > 0.0:
                    n0[j] = contact_normal(law_of[j], t + h, p0[j], r0[j], values, offsets[j])
                force[j] = -side0[j] * (n0[j] if contacts[j, 3] > 0.0 else max(0.0, n0[j]))
            else:
                force[j] = b[j]
        for i in range(n_ports):
            q0[i], v0[i] = q1[i], v1[i]
        check = 0.0
        for k in range(n_out):
            total = 0.0
            for i in range(2 * n):
                total += out_rows[k, i] * new[i]
            out[step + 1, k] = total
            check += abs(total)
        if not check < 1e30:  # noqa: PLR2004
            return step
    if tracing:
        for i in range(n_ports):
            trace[n_steps, i] = q0[i]
            trace[n_steps, n_ports + i] = v0[i]
        for j in range(n_items):
            trace[n_steps, 2 * n_ports + j] = force[j]
    return n_steps

