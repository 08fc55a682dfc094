"""The point forces at one stage of a step and their slopes, as compiled code."""

from models.compiled import compiled
from models.fine.desk import BY_Q, BY_V, BY_Z, LAW, RATE, RATE_BY_Q, RATE_BY_V, RATE_BY_Z, Desk, Q, V, Z
from models.law_call import call_law
from models.point_forces import BILATERAL, CLEARANCE, GROWTH, IS_CONTACT, OFFSET, Items

NUDGE_Q, NUDGE_V, NUDGE_Z = 1e-9, 1e-7, 1e-7
"""For slopes of laws: m (times 1 + |q|), m/s and the internal state's unit."""


@compiled
def pressing(items: Items, j: int, t: float, q: float, v: float) -> int:
    """What ``Desk.closed`` should say of contact j at an instant."""
    if items.contact[j, BILATERAL] > 0.0:
        return 2
    u, rate = q - items.contact[j, OFFSET], items.contact[j, GROWTH]
    side = 1 if u >= 0.0 else -1
    p = side * u - items.contact[j, CLEARANCE] - rate * t
    if p <= 0.0:
        return 0
    normal: float = call_law(items.law[j], t, p, side * v - rate, 0.0, items.values, items.first[j])
    return side if normal > 0.0 else 0


@compiled
def item_force(items: Items, j: int, closed: int, t: float, q: float, v: float, z: float) -> float:
    """Force of item j on the structure, a contact being open or closed as told."""
    force: float = 0.0
    if items.contact[j, IS_CONTACT] == 0.0:
        force = call_law(items.law[j], t, q, v, z, items.values, items.first[j])
    elif closed != 0:
        u, rate = q - items.contact[j, OFFSET], items.contact[j, GROWTH]
        side = (1 if u >= 0.0 else -1) if closed == 2 else closed
        p = max(0.0, side * u - items.contact[j, CLEARANCE] - rate * t)
        force = -side * call_law(items.law[j], t, p, side * v - rate, 0.0, items.values, items.first[j])
    return force


@compiled
def weigh(desk: Desk, items: Items, t: float, stage: int) -> None:
    """Fill in what the laws say at one stage."""
    for i in range(desk.port.shape[2]):
        desk.port[LAW, stage, i] = 0.0
    for j in range(items.port.shape[0]):
        i = items.port[j]
        q, v, z = desk.port[Q, stage, i], desk.port[V, stage, i], desk.item[Z, stage, j]
        desk.port[LAW, stage, i] += item_force(items, j, desk.closed[j], t, q, v, z)
        if items.rate[j] != 0:
            desk.item[RATE, stage, j] = call_law(items.rate[j], t, q, v, z, items.values, items.first[j])


@compiled
def lean(desk: Desk, items: Items, t: float, stage: int) -> None:
    """Fill in the slopes of the laws at one stage."""
    for i in range(desk.port.shape[2]):
        desk.port[BY_Q, stage, i] = desk.port[BY_V, stage, i] = 0.0
    for j in range(items.port.shape[0]):
        if items.contact[j, IS_CONTACT] > 0.0 and desk.closed[j] == 0:
            continue
        i, closed = items.port[j], desk.closed[j]
        q, v, z = desk.port[Q, stage, i], desk.port[V, stage, i], desk.item[Z, stage, j]
        nudge = NUDGE_Q * (1.0 + abs(q))
        here = item_force(items, j, closed, t, q, v, z)
        desk.port[BY_Q, stage, i] += (item_force(items, j, closed, t, q + nudge, v, z) - here) / nudge
        desk.port[BY_V, stage, i] += (item_force(items, j, closed, t, q, v + NUDGE_V, z) - here) / NUDGE_V
        if items.rate[j] != 0:
            law, first, now = items.rate[j], items.first[j], desk.item[RATE, stage, j]
            desk.item[BY_Z, stage, j] = (item_force(items, j, closed, t, q, v, z + NUDGE_Z) - here) / NUDGE_Z
            desk.item[RATE_BY_Q, stage, j] = (call_law(law, t, q + nudge, v, z, items.values, first) - now) / nudge
            desk.item[RATE_BY_V, stage, j] = (call_law(law, t, q, v + NUDGE_V, z, items.values, first) - now) / NUDGE_V
            desk.item[RATE_BY_Z, stage, j] = (call_law(law, t, q, v, z + NUDGE_Z, items.values, first) - now) / NUDGE_Z
