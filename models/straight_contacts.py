"""Contacts whose force is straight in the motion, side by side: those that are closed throughout are met by one step.

docs/theory.md, section 5.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from models.arrays import FloatArray, IntArray
from models.compiled import noticing
from models.contact_forces import halfway, pressed
from models.lanes import EIGHT, FOUR, chosen, digits, eight, four, four_of, put
from models.step_options import INLINE, OPTIONS

MOST_JOINED = FOUR
"""Straight contacts that are solved for together: each set of them that may be closed has its own inverse matrix."""


class Straight(NamedTuple):
    """Contacts whose normal force is k p + c dp/dt, side by side; what is not there of four is 0.

    Attributes:
        k, c: N/m and N s/m.
        clearance, offset, growth: m, m and m/s.
        is_bilateral: it holds from either side, and may pull.
        is_unilateral: it is there and does not.
    """

    k: Any
    c: Any
    clearance: Any
    offset: Any
    growth: Any
    is_bilateral: Any
    is_unilateral: Any


class Weighed(NamedTuple):
    """Straight contacts at one end of a step.

    Attributes:
        p, rate: penetration and its rate.
        side: of the wall, 1 or -1.
        normal: force before it is kept from pulling; 0 where it is open.
    """

    p: Any
    rate: Any
    side: Any
    normal: Any


@njit(**INLINE)
def straight_step(contacts: Straight, t: float, h: float, start: Weighed, q1: Any, v1: Any) -> tuple[Any, ...]:
    """Weights (a, b) of straight contacts that are closed all through a step to t, which ends with q1, v1.

    They are straight in q1 and v1, whether or not the contacts are closed there.

    Returns:
        the weights, penetration at the end, and the forces halfway and at the end: closed where none is below 0.
    """
    p1, rate1 = pressed(contacts.clearance, contacts.offset, contacts.growth, t, start.side, q1, v1)
    p, rate = halfway(h, start.p, start.rate, p1, rate1)
    middle, last = contacts.k * p + contacts.c * rate, contacts.k * p1 + contacts.c * rate1
    a, b = (2.0 * (start.normal + middle) - last) / -3.0, (2.0 * (middle + last) - start.normal) / -3.0
    return start.side * a, start.side * b, p1, middle, last


@njit(**INLINE)
def weighed(contacts: Straight, t: float, q: Any, v: Any) -> Weighed:
    """Straight contacts at q, v."""
    side = chosen(q - contacts.offset >= 0.0, 1.0, -1.0)
    p, rate = pressed(contacts.clearance, contacts.offset, contacts.growth, t, side, q, v)
    normal = chosen(contacts.is_bilateral | (p > 0.0), contacts.k * p + contacts.c * rate, 0.0)
    return Weighed(p, rate, side, normal)


@njit(**INLINE)
def forces_of(contacts: Straight, end: Weighed) -> Any:
    """Forces of contacts on the structure, kept from pulling unless they are bilateral."""
    return end.side * chosen(contacts.is_bilateral | (end.normal > 0.0), end.normal, 0.0) * -1.0


@njit(**INLINE)
def holding(contacts: Straight, start: Weighed) -> Any:
    """Which contacts are closed where a step begins, and would not pull there."""
    holds = (start.p > 0.0) & (start.normal >= 0.0)
    return contacts.is_bilateral | contacts.is_unilateral & holds


@njit(**INLINE)
def stays_out(contacts: Straight, start: Weighed, end: Weighed, a: Any, b: Any) -> Any:
    """Which contacts have no force in a step: open at both its ends, or such that they would pull there."""
    is_open = (start.p <= 0.0) & (end.p <= 0.0)
    would_pull = (start.p > 0.0) & (start.normal < 0.0) & (end.normal <= 0.0)
    return contacts.is_unilateral & (is_open | would_pull) & (a * a + b * b <= 0.0)


@noticing("lanes.py", "step_options.py")
@njit(**OPTIONS)
def inverses_of(
    straight: FloatArray, port: IntArray, h: float,
    q_start: FloatArray, q_end: FloatArray, v_start: FloatArray, v_end: FloatArray,
) -> FloatArray:  # fmt: skip
    """(2^n, 8, 8) inverse matrices of Newton's equations for the weights of n contacts closed throughout.

    The binary digits of the first index tell which of them are closed. Columns, then rows, are the weights ``a`` of
    four, then their weights ``b``; those of contacts that are not closed, or not there, are 0. Forces that are straight
    in the motion are met by one step of it.

    Args:
        straight: (n, 3) as of ``Items``, of the contacts alone.
        port: (n,) of each.
        h: s.
        q_start: (n_ports, n_ports or more) displacement of each port by a unit of ``a`` of the force on one.
        q_end: the same by a unit of ``b``.
        v_start: velocity by a unit of ``a``.
        v_end: velocity by a unit of ``b``.
    """
    n = len(straight)
    whole = np.zeros((2 * n, 2 * n))
    for s in range(n):
        k, c = straight[s, 1], straight[s, 2]
        i = port[s]
        for r in range(n):
            m = port[r]
            for end in range(2):
                q_by, v_by = (q_end[m, i], v_end[m, i]) if end else (q_start[m, i], v_start[m, i])
                whole[s, r + n * end] = c / h * q_by - (k * h / 12.0 + 0.5 * c) * v_by
                whole[s + n, r + n * end] = (k + c / h) * q_by - (k * h / 12.0 - 0.5 * c) * v_by
    found = np.zeros((1 << n, EIGHT, EIGHT))
    for closed in range(1, 1 << n):
        own = np.array([x for x in range(2 * n) if closed >> (x % n) & 1])
        place = own % n + FOUR * (own // n)
        part = np.eye(len(own))
        for x in range(len(own)):
            for y in range(len(own)):
                part[x, y] += whole[own[x], own[y]]
        inverse = np.linalg.inv(part)
        for x in range(len(own)):
            for y in range(len(own)):
                found[closed, place[y], place[x]] = inverse[x, y]
    return found


@noticing("lanes.py", "step_options.py")
@njit(**OPTIONS)
def joined_of(straight: FloatArray) -> tuple[int, int]:
    """The first straight contact, and how many from there on are met together; one that is not so ends the row."""
    first = 0
    while first < len(straight) and not is_straight(straight, first):
        first += 1
    n = 0
    while n < MOST_JOINED and first + n < len(straight) and is_straight(straight, first + n):
        n += 1
    return first, n


@njit(**INLINE)
def is_straight(straight: FloatArray, j: int) -> bool:
    """Whether a row of ``Items.straight`` is that of a contact whose numbers are finite."""
    return bool(straight[j, 0] > 0.0 and np.isfinite(straight[j, 1] + straight[j, 2]))


@njit(**INLINE)
def side_by_side(straight: FloatArray, contact: FloatArray, first: int, n: int) -> Straight:
    """So many contacts from one on, of rows of ``Items``."""
    numbers = np.zeros((7, FOUR))
    for s in range(n):
        numbers[:2, s], numbers[2:5, s] = straight[first + s, 1:], contact[first + s, :3]
        numbers[5, s], numbers[6, s] = contact[first + s, 3], 1.0 - contact[first + s, 3]
    return Straight(
        four(numbers, (0, 0)), four(numbers, (1, 0)), four(numbers, (2, 0)), four(numbers, (3, 0)),
        four(numbers, (4, 0)), four(numbers, (5, 0)) > 0.0, four(numbers, (6, 0)) > 0.0,
    )  # fmt: skip


@njit(**INLINE)
def put_where(mask: Any, array: FloatArray, first: int, numbers: Any) -> None:
    """Write four numbers to an array from one place on, where a mask says so."""
    put(array, first, chosen(mask, numbers, four(array, first)))


@njit(**INLINE)
def met_together(
    contacts: Straight, start: Weighed, closed: int, t: float, h: float, inverses: FloatArray, n_joined: int,
    port: IntArray, a: FloatArray, b: FloatArray, joined: int, port_a: FloatArray, port_b: FloatArray,
    q1: FloatArray, v1: FloatArray, q_start: FloatArray, q_end: FloatArray, v_start: FloatArray, v_end: FloatArray,
    room: FloatArray,
) -> tuple[int, float]:  # fmt: skip
    """One linear step to the weights of all contacts in the set ``closed``, changed in place as the motion is.

    Args:
        contacts: side by side, ``joined`` the first of them among all items.
        start: where the step begins.
        closed: in binary digits.
        t: s, at the end of the step.
        h: s.
        inverses: as of ``inverses_of``.
        n_joined: contacts.
        port: (4,) of each.
        a: (n_items + 4,) weights at the start, changed.
        b: weights at the end, changed.
        joined: number of the first.
        port_a: (n_ports,) weights of the ports' forces at the start, changed.
        port_b: weights at the end, changed.
        q1: displacements of the ports, changed.
        v1: velocities, changed.
        q_start: as of ``reached``, by weights at the start.
        q_end: by weights at the end.
        v_start: of velocities by weights at the start.
        v_end: of velocities by weights at the end.
        room: (4, 8) to work in.

    Returns:
        those of the set that are closed all through the step after that: the others must be met by themselves; and the
        largest change that was asked for, N.
    """
    fault_a, fault_b, change_a, change_b = room[0], room[1], room[2], room[3]
    new_a, new_b, _, _, _ = straight_step(contacts, t, h, start, four_of(q1, port, 0), four_of(v1, port, 0))
    put(fault_a, 0, new_a - four(a, joined))
    put(fault_b, 0, new_b - four(b, joined))
    change = eight(inverses, (closed, 0, 0)) * fault_a[0] + eight(inverses, (closed, FOUR, 0)) * fault_b[0]
    for s in range(1, n_joined):
        change = change + eight(inverses, (closed, s, 0)) * fault_a[s]
        change = change + eight(inverses, (closed, FOUR + s, 0)) * fault_b[s]
    put(change_a, 0, change)
    put(change_b, 0, four(change_a, FOUR))
    put(a, joined, four(a, joined) + four(change_a, 0))
    put(b, joined, four(b, joined) + four(change_b, 0))
    largest = 0.0
    for s in range(n_joined):
        if closed >> s & 1:
            port_a[port[s]] += change_a[s]
            port_b[port[s]] += change_b[s]
            largest = max(largest, abs(fault_a[s]) + abs(fault_b[s]))
    for k in range(0, len(q1), EIGHT):
        q, v = eight(q1, k), eight(v1, k)
        for s in range(n_joined):
            i = port[s]
            q = q + (eight(q_start, (i, k)) * change_a[s] + eight(q_end, (i, k)) * change_b[s])
            v = v + (eight(v_start, (i, k)) * change_a[s] + eight(v_end, (i, k)) * change_b[s])
        put(q1, k, q)
        put(v1, k, v)
    _, _, p1, middle, last = straight_step(contacts, t, h, start, four_of(q1, port, 0), four_of(v1, port, 0))
    stays = contacts.is_bilateral | (p1 > 0.0) & (middle >= 0.0) & (last >= 0.0)
    return closed & digits(stays), largest
