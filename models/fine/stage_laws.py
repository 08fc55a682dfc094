"""The point forces at one stage of a step and their slopes, as compiled code."""

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from models.arrays import FloatArray
from models.law_call import call_law

NUDGE_Q, NUDGE_V, NUDGE_Z = 1e-9, 1e-7, 1e-7
"""For slopes of laws, m, m/s and the internal state's unit."""

OPTIONS: dict[str, Any] = {"nogil": True, "cache": True, "fastmath": {"contract", "reassoc", "nsz", "arcp"}}


class Desk(NamedTuple):
    """Room for one step: stage index first (0, 1, and 2 for the step's end), then port or item."""

    q: FloatArray
    v: FloatArray
    z: FloatArray
    force: FloatArray
    law: FloatArray
    by_q: FloatArray
    by_v: FloatArray
    by_z: FloatArray
    rate: FloatArray
    rate_by_q: FloatArray
    rate_by_v: FloatArray
    rate_by_z: FloatArray
    free: FloatArray
    input: FloatArray
    matrix: FloatArray
    fault: FloatArray
    new: FloatArray


def make_desk(n: int, n_ports: int, n_items: int, n_inputs: int) -> Desk:
    """Empty room for a system of n coordinates, its ports, point forces and inputs."""
    size = 2 * (n_ports + n_items)
    port = [np.zeros((3, n_ports)) for _ in range(6)]
    item = [np.zeros((3, n_items)) for _ in range(6)]
    return Desk(
        q=port[0], v=port[1], z=item[0], force=port[2], law=port[3], by_q=port[4], by_v=port[5], by_z=item[1],
        rate=item[2], rate_by_q=item[3], rate_by_v=item[4], rate_by_z=item[5], free=np.zeros((4, n_ports)),
        input=np.zeros((2, n_inputs)),
        matrix=np.zeros((size, size)), fault=np.zeros(size), new=np.zeros(2 * n),
    )  # fmt: skip


@njit(**OPTIONS)
def normal_state(items, j, t, q, v):  # type: ignore[no-untyped-def]
    """0 where contact j is open, else the side, 1 or -1, on which it presses; 2 where it is bilateral."""
    if items.contact[j, 1] > 0.0:
        return 2
    u = q - items.contact[j, 3]
    side = 1 if u >= 0.0 else -1
    p = side * u - items.contact[j, 2] - items.contact[j, 4] * t
    if p <= 0.0:
        return 0
    normal = call_law(items.law[j], t, p, side * v - items.contact[j, 4], 0.0, items.values, items.offset[j])
    return side if normal > 0.0 else 0


@njit(**OPTIONS)
def item_force(items, j, closed, t, q, v, z):  # type: ignore[no-untyped-def]
    """Force of item j on the structure, a contact being open or closed as told."""
    if items.contact[j, 0] == 0.0:
        return call_law(items.law[j], t, q, v, z, items.values, items.offset[j])
    if closed == 0:
        return 0.0
    u = q - items.contact[j, 3]
    side = (1 if u >= 0.0 else -1) if closed == 2 else closed
    p = max(0.0, side * u - items.contact[j, 2] - items.contact[j, 4] * t)
    return -side * call_law(items.law[j], t, p, side * v - items.contact[j, 4], 0.0, items.values, items.offset[j])


@njit(**OPTIONS)
def weigh(desk, items, closed, t, stage):  # type: ignore[no-untyped-def]
    """Fill in the forces of the laws at one stage."""
    desk.law[stage, :] = 0.0
    for j in range(items.port.shape[0]):
        i = items.port[j]
        q, v, z = desk.q[stage, i], desk.v[stage, i], desk.z[stage, j]
        desk.law[stage, i] += item_force(items, j, closed[j], t, q, v, z)
        if items.rate[j] != 0:
            desk.rate[stage, j] = call_law(items.rate[j], t, q, v, z, items.values, items.offset[j])


@njit(**OPTIONS)
def lean(desk, items, closed, t, stage):  # type: ignore[no-untyped-def]
    """Fill in the slopes of the laws at one stage."""
    desk.by_q[stage, :] = 0.0
    desk.by_v[stage, :] = 0.0
    for j in range(items.port.shape[0]):
        if items.contact[j, 0] > 0.0 and closed[j] == 0:
            continue
        i = items.port[j]
        q, v, z = desk.q[stage, i], desk.v[stage, i], desk.z[stage, j]
        nudge = NUDGE_Q * (1.0 + abs(q))
        here = item_force(items, j, closed[j], t, q, v, z)
        desk.by_q[stage, i] += (item_force(items, j, closed[j], t, q + nudge, v, z) - here) / nudge
        desk.by_v[stage, i] += (item_force(items, j, closed[j], t, q, v + NUDGE_V, z) - here) / NUDGE_V
        if items.rate[j] != 0:
            law, values, offset = items.rate[j], items.values, items.offset[j]
            now = desk.rate[stage, j]
            desk.by_z[stage, j] = (item_force(items, j, closed[j], t, q, v, z + NUDGE_Z) - here) / NUDGE_Z
            desk.rate_by_q[stage, j] = (call_law(law, t, q + nudge, v, z, values, offset) - now) / nudge
            desk.rate_by_v[stage, j] = (call_law(law, t, q, v + NUDGE_V, z, values, offset) - now) / NUDGE_V
            desk.rate_by_z[stage, j] = (call_law(law, t, q, v, z + NUDGE_Z, values, offset) - now) / NUDGE_Z
