"""What the laws and contacts say over one period of given motion, and their slopes, as compiled code.

A contact is closed for a part of a sample where it begins or ends there. The share grows with a slope that begins and
ends at 0: a dashpot that jumped in would give the curve of periodic motions corners, where it may even turn back, and
methods with slopes would not get around them. The mean of a linear spring over such a sample stays exact.
"""

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
    reach = 0.5 * h * abs(rate) + TOUCH
    if p >= reach:
        return 1.0, p
    if p <= -reach:
        return 0.0, 0.0
    part = 0.5 * (p + reach) / reach
    return part * part * (3.0 - 2.0 * part), reach / (3.0 - 2.0 * part)


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
def forces_over_period(
    items: Items, h: float, q: FloatArray, v: FloatArray, force: FloatArray, by_q: FloatArray, by_v: FloatArray
) -> None:
    """Fill in the forces at the ports and their slopes.

    Args:
        items: laws and contacts that do not change with time.
        h: time between samples, s.
        q: (n_ports, N) m, gravity's sag included.
        v: (n_ports, N) m/s.
        force: (n_ports, N) on the structure, N, filled in.
        by_q: (n_ports, N) its slope over q, N/m, filled in.
        by_v: (n_ports, N) its slope over v, N s/m, filled in.
    """
    force[:], by_q[:], by_v[:] = 0.0, 0.0, 0.0
    values = items.values
    for j in range(items.port.shape[0]):
        i, law, first = items.port[j], items.law[j], items.first[j]
        is_contact, bilateral = items.contact[j, IS_CONTACT] > 0.0, items.contact[j, BILATERAL] > 0.0
        clearance, offset = items.contact[j, CLEARANCE], items.contact[j, OFFSET]
        for k in range(q.shape[1]):
            nudge, here = NUDGE_Q * (1.0 + abs(q[i, k])), 0.0
            for probe in range(3):
                place, speed = q[i, k] + nudge * (probe == 1), v[i, k] + NUDGE_V * (probe == 2)
                if not is_contact:
                    now = call_law(law, 0.0, place, speed, 0.0, values, first)
                else:
                    side = 1.0 if place >= offset else -1.0
                    p, rate = side * (place - offset) - clearance, side * speed
                    if bilateral:
                        now = -side * call_law(law, 0.0, p, rate, 0.0, values, first)
                    else:
                        now = -side * contact_force(law, values, first, p, rate, h)
                if probe == 0:
                    here = now
                    force[i, k] += now
                elif probe == 1:
                    by_q[i, k] += (now - here) / nudge
                else:
                    by_v[i, k] += (now - here) / NUDGE_V
