"""Forces of laws and contacts over one step, each by itself: weights of the straight line that has their impulse.

A force runs as a parabola over its values at the start, halfway and at the end, on the cubic of the motion there; where
a contact begins or ends within the step, on the part in which it is closed. docs/theory.md, section 5.
"""

from math import sqrt
from typing import Any

import numpy as np
from numba import njit

from models.arrays import FloatArray
from models.compiled import noticing
from models.law_call import call_law
from models.step_options import INLINE, OPTIONS

MAX_ITERATIONS = 60

SLOPE_NUDGE = 1e-6

INTERNAL_TOLERANCE = 1e-12
"""Fault of an internal state, which is of the order of 1, that ends its iteration."""

ROUNDED = 1e-14
"""Of a force times its slope: a fault as small is rounding."""

ROOT_ROUNDING = 1e-8
"""Last change of a fraction that Newton's method finds: the next is its square."""

FINITE = 1e30
"""Beyond it a motion counts as lost."""


@njit(**INLINE)
def pressed(clearance: Any, offset: Any, growth: Any, t: float, side: Any, q: Any, v: Any) -> tuple[Any, Any]:
    """(p, dp/dt) at q, v of a contact against the wall on this side, or of several side by side."""
    return side * (q - offset) - clearance - growth * t, side * v - growth


@njit(**INLINE)
def penetration_of(contact: FloatArray, j: int, t: float, q: float, v: float) -> tuple[float, float, float]:
    """(p, dp/dt, side) of row j of ``Items.contact`` at q, v."""
    side = 1.0 if q - contact[j, 1] >= 0.0 else -1.0
    p, rate = pressed(contact[j, 0], contact[j, 1], contact[j, 2], t, side, q, v)
    return p, rate, side


@noticing("step_options.py")
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


@noticing("step_options.py")
@njit(**OPTIONS)
def crossing(p0: float, r0: float, p1: float, r1: float) -> tuple[float, float]:
    """Fraction of the step where the cubic through (p0, slope r0) and (p1, slope r1) passes 0, and its slope there."""
    s = p0 / (p0 - p1)
    c2, c3 = 3.0 * (p1 - p0) - 2.0 * r0 - r1, 2.0 * (p0 - p1) + r0 + r1
    for _ in range(4):
        slope = r0 + s * (2.0 * c2 + 3.0 * s * c3)
        if slope * (p1 - p0) <= 0.0:
            break
        before = s
        s = min(max(s - (p0 + s * (r0 + s * (c2 + s * c3))) / slope, 0.0), 1.0)
        if abs(s - before) < ROOT_ROUNDING:
            break
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


@noticing("law_call.py", "step_options.py")
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


@noticing("law_call.py", "step_options.py")
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
