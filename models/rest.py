"""The state at rest: where gravity and the sleeves put the structure, and what touches."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.errors import NoRestError
from models.plant import Plant
from models.ports import Contact, PointLaw, Port

REST_TOLERANCE = 1e-13
"""Largest change of a port's position in the last iteration, m."""

MAX_ITERATIONS = 200

ForceFunction = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class RestState:
    """Ports at rest.

    Attributes:
        position: (n_ports,) q at rest, gravity's sag included, m.
        law_forces: (n_laws,) force of each point law on the structure at rest, N.
        contact_forces: (n_contacts,) force of each sleeve on the structure at rest, N, positive upwards.
        penetration: (n_contacts,) m, negative where the sleeve does not touch.
    """

    position: FloatArray
    law_forces: FloatArray
    contact_forces: FloatArray
    penetration: FloatArray


def find_rest(plant: Plant, ports: tuple[Port, ...], sag: FloatArray, flexibility: FloatArray) -> RestState:
    """Equilibrium of q = sag + flexibility F(q), by Newton's method with step control.

    Args:
        plant: laws and contacts.
        ports: the model's ports.
        sag: (n_ports,) deflection under gravity without laws and contacts, m.
        flexibility: (n_ports, n_ports) m/N.

    Raises:
        NoRestError: no equilibrium is found (laws that push a structure without stiffness away).
    """
    index = {port: i for i, port in enumerate(ports)}
    law_at = [index[law.port] for law in plant.laws]
    contact_at = [index[Port(contact.position)] for contact in plant.contacts]

    def forces(q: FloatArray) -> FloatArray:
        total = np.zeros(len(ports))
        for law, i in zip(plant.laws, law_at, strict=True):
            total[i] += law_force(law, float(q[i]))
        for contact, i in zip(plant.contacts, contact_at, strict=True):
            total[i] += contact_force(contact, float(q[i]))
        return total

    q = _newton(sag, flexibility, forces)
    return RestState(
        position=q,
        law_forces=np.array([law_force(law, float(q[i])) for law, i in zip(plant.laws, law_at, strict=True)]),
        contact_forces=np.array(
            [contact_force(c, float(q[i])) for c, i in zip(plant.contacts, contact_at, strict=True)]
        ),
        penetration=np.array(
            [abs(q[i] - c.offset) - c.clearance for c, i in zip(plant.contacts, contact_at, strict=True)]
        ),
    )


def law_force(law: PointLaw, q: float, v: float = 0.0) -> float:
    """Force of a point law at the record's start with its internal state at 0, N."""
    return law.force(0.0, q, v, 0.0, law.parameters)


def contact_force(contact: Contact, q: float, v: float = 0.0) -> float:
    """Force of a sleeve on the structure at the record's start, N; never pulling unless it has no clearance."""
    u = q - contact.offset
    side = 1.0 if u >= 0 else -1.0
    penetration = abs(u) - contact.clearance
    if penetration <= 0 and not is_bilateral(contact):
        return 0.0
    normal = contact.law.normal_force(0.0, penetration, side * v, 0.0, contact.law.values)
    return -side * (normal if is_bilateral(contact) else max(0.0, normal))


def is_bilateral(contact: Contact) -> bool:
    """A sleeve without clearance is a spring and dashpot in both directions."""
    return contact.clearance == 0 and contact.clearance_rate == 0


def _newton(sag: FloatArray, flexibility: FloatArray, forces: ForceFunction) -> FloatArray:
    q = sag.copy()
    residual = sag + flexibility @ forces(q) - q
    for _ in range(MAX_ITERATIONS):
        if len(q) == 0 or np.abs(residual).max() < REST_TOLERANCE:
            return q
        step = np.linalg.solve(np.eye(len(q)) - flexibility @ _slope(forces, q), residual)
        for halving in range(40):
            trial = q + step / 2**halving
            new = sag + flexibility @ forces(trial) - trial
            if np.linalg.norm(new) < np.linalg.norm(residual) or np.abs(step).max() / 2**halving < REST_TOLERANCE:
                break
        if np.abs(trial - q).max() < REST_TOLERANCE:
            return np.asarray(trial)
        q, residual = trial, new
    raise NoRestError(
        "the state at rest: no equilibrium was found",
        "the structure rests where gravity, sleeves and effects balance",
        "look for a stiffness that is negative or an offset larger than the structure can reach",
    )


def _slope(forces: ForceFunction, q: FloatArray) -> FloatArray:
    """(n_ports,)*2 diagonal derivative of the forces, by a one-sided difference small beside any clearance."""
    slope, here = np.zeros((len(q), len(q))), forces(q)
    for i in range(len(q)):
        nudge = 1e-9 if abs(q[i]) < 1e-3 else 1e-6 * abs(q[i])
        moved = q.copy()
        moved[i] += nudge
        slope[:, i] = (forces(moved) - here) / nudge
    return slope
