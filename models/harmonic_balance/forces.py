"""What the laws and contacts say over one period of given motion, and their slopes, as compiled code.

A contact is closed for a part of a sample where it begins or ends there. The share grows with a slope that begins and
ends at 0: a dashpot that jumped in would give the curve of periodic motions corners, where it may even turn back, and
methods with slopes would not get around them. The slopes of neighbouring samples add up to the same wherever these fall
about the touch (a hat, two samples wide, unless motion crawls through ``TOUCH``); were it not so, the curve would be
rough, and stability of motion that grazes a sleeve a matter of where its samples fall.
"""

import numpy as np

from models.arrays import FloatArray
from models.compiled import compiled
from models.law_call import call_law
from models.point_forces import BILATERAL, CLEARANCE, IS_CONTACT, OFFSET, Items

NUDGE_Q, NUDGE_V = 1e-10, 1e-9
"""For slopes: m (times 1 + |q|) and m/s."""

TOUCH = 1e-8
"""m before and after first touch over which a contact closes however slowly it does, as rough surfaces do."""


@compiled
def closing(p: float, rate: float, h: float) -> tuple[float, float]:
    """Share of a sample in which a contact is closed, and the penetration, m, with which the share has the mean.

    Args:
        p: penetration, m, negative where there is room.
        rate: dp/dt, m/s.
        h: time between samples, s.
    """
    reach = h * abs(rate) + TOUCH
    if p >= reach:
        return 1.0, p
    if p <= -reach:
        return 0.0, 0.0
    x = p / reach
    if x < 0.0:
        return 0.5 * (1.0 + x) ** 2, reach * (1.0 + x) / 3.0
    share = 1.0 - 0.5 * (1.0 - x) ** 2
    return share, reach * (x + (1.0 - x) ** 3 / 6.0) / share


@compiled
def contact_force(law: int, values: FloatArray, first: int, p: float, rate: float, h: float) -> float:
    """Mean normal force over a sample; a contact never pulls.

    Args:
        law: its address.
        values: of all laws.
        first: where its own begin.
        p: penetration, m, negative where there is room.
        rate: dp/dt, m/s.
        h: time between samples, s.
    """
    share, amid = closing(p, rate, h)
    if share == 0.0:
        return 0.0
    normal: float = call_law(law, 0.0, amid, rate, 0.0, values, first)
    return share * max(0.0, normal)


@compiled
def point_force(law: int, values: FloatArray, first: int, contact: FloatArray, q: float, v: float, h: float) -> float:
    """Force of one law or contact on the structure, N.

    Args:
        law: its address.
        values: of all laws.
        first: where its own begin.
        contact: (5,) its row of ``Items.contact``.
        q: displacement of its port, m, gravity's sag included.
        v: velocity, m/s.
        h: time between samples, s.
    """
    if contact[IS_CONTACT] == 0.0:
        force: float = call_law(law, 0.0, q, v, 0.0, values, first)
        return force
    away = q - contact[OFFSET]
    if contact[BILATERAL] > 0.0:
        side = 1.0 if away >= 0.0 else -1.0
        normal: float = call_law(law, 0.0, side * away - contact[CLEARANCE], side * v, 0.0, values, first)
        return -side * normal
    # A fast motion may cross a narrow gap within a sample and touch both walls.
    upper = contact_force(law, values, first, away - contact[CLEARANCE], v, h)
    return contact_force(law, values, first, -away - contact[CLEARANCE], -v, h) - upper


@compiled
def forces_at(items: Items, q: FloatArray, v: FloatArray, h: float) -> FloatArray:
    """(n_ports, N) forces on the structure, N.

    Args:
        items: laws and contacts that do not change with time.
        q: (n_ports, N) m, gravity's sag included.
        v: (n_ports, N) m/s.
        h: time between samples, s.
    """
    force = np.zeros(q.shape)
    values = items.values
    for j in range(items.port.shape[0]):
        i, law, first, contact = items.port[j], items.law[j], items.first[j], items.contact[j]
        for k in range(q.shape[1]):
            force[i, k] += point_force(law, values, first, contact, q[i, k], v[i, k], h)
    return force


@compiled
def _is_open(contact: FloatArray, q: float, v: float, h: float) -> bool:
    """Whether a contact is open, and stays so when it is nudged."""
    if contact[IS_CONTACT] == 0.0 or contact[BILATERAL] > 0.0:
        return False
    room: float = contact[CLEARANCE] - abs(q - contact[OFFSET])
    return room > h * (abs(v) + NUDGE_V) + 2.0 * TOUCH


@compiled
def forces_and_slopes(
    items: Items, q: FloatArray, v: FloatArray, h: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(n_ports, N) forces, N, and their slopes over q, N/m, and over v, N s/m.

    Args:
        items: laws and contacts that do not change with time.
        q: (n_ports, N) m, gravity's sag included.
        v: (n_ports, N) m/s.
        h: time between samples, s.
    """
    force, by_q, by_v = np.zeros(q.shape), np.zeros(q.shape), np.zeros(q.shape)
    values = items.values
    for j in range(items.port.shape[0]):
        i, law, first, contact = items.port[j], items.law[j], items.first[j], items.contact[j]
        for k in range(q.shape[1]):
            place, speed = q[i, k], v[i, k]
            if _is_open(contact, place, speed, h):
                continue
            nudge = NUDGE_Q * (1.0 + abs(place))
            here = point_force(law, values, first, contact, place, speed, h)
            force[i, k] += here
            by_q[i, k] += (point_force(law, values, first, contact, place + nudge, speed, h) - here) / nudge
            by_v[i, k] += (point_force(law, values, first, contact, place, speed + NUDGE_V, h) - here) / NUDGE_V
    return force, by_q, by_v
