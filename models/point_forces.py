"""Every force at a point, one kind of thing: laws of effects, springs, dashpots, absorbers and contacts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray, IntArray
from models.law import LawFunction, law_address
from models.plant import Plant
from models.ports import Port
from models.rest import is_bilateral
from models.structure import Absorber


@dataclass(frozen=True)
class Stretch:
    """The port of an absorber: how far its mass is ahead of the structure."""

    number: int
    absorber: Absorber


@dataclass(frozen=True)
class PointForce:
    """One law behind one port.

    Attributes:
        port: where it reads the motion and acts.
        law: F(t, q, v, z, p), or the normal force N(t, p, dp/dt, 0, c) of a contact.
        values: its numbers.
        rate: dz/dt of an internal state, or None.
        contact: (clearance, offset, growth of the clearance) of a contact, None for a plain law.
        bilateral: a contact that acts in both directions.
        partner: the other direction's port of a round contact, which pushes towards its centre; None in the plane.
    """

    port: Port | Stretch
    law: LawFunction
    values: tuple[float, ...]
    rate: LawFunction | None = None
    contact: tuple[float, float, float] | None = None
    bilateral: bool = False
    partner: Port | None = None

    def at_rest(self, q: float) -> float:
        """Force on the structure at the start, N, without motion."""
        if self.contact is None:
            return self.law(0.0, q, 0.0, 0.0, self.values)
        clearance, offset, _ = self.contact
        side = 1.0 if q >= offset else -1.0
        penetration = abs(q - offset) - clearance
        if penetration <= 0.0:
            return 0.0
        normal = self.law(0.0, penetration, 0.0, 0.0, self.values)
        return -side * (normal if self.bilateral else max(0.0, normal))


IS_CONTACT, BILATERAL, CLEARANCE, OFFSET, GROWTH = range(5)
"""Columns of ``Items.contact``; the first two are 1 or 0."""


class Items(NamedTuple):
    """The point forces as the compiled stepper reads them.

    Attributes:
        port: (n,) row among the ports.
        law: (n,) address of the compiled law.
        rate: (n,) address of the compiled rate of the internal state, 0 where there is none.
        first: (n,) where each one's numbers begin in ``values``.
        values: all numbers in a row.
        contact: (n, 5) ``IS_CONTACT`` to ``GROWTH``.
        partner: (n,) row of the other direction of a round contact, -1 where there is none.
    """

    port: IntArray
    law: IntArray
    rate: IntArray
    first: IntArray
    values: FloatArray
    contact: FloatArray
    partner: IntArray


def spring_and_dashpot(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG001
    """Linear force with p = (stiffness, damping)."""
    return -p[0] * q - p[1] * v


def closed_part(p: float, rate: float, h: float) -> tuple[float, float]:
    """Share of a step h about now in which a contact is closed, and the mean penetration, m, in that part.

    Args:
        p: penetration now, m, negative where there is room.
        rate: dp/dt, m/s, taken to stay.
        h: s.
    """
    reach = 0.5 * h * abs(rate)
    if p >= reach:
        return 1.0, p
    if p <= -reach:
        return 0.0, 0.0
    return 0.5 * (p + reach) / reach, 0.5 * (p + reach)


def about_centre(u: float, y: float, v: float, w: float) -> tuple[float, float, float]:
    """Distance from the centre of a round sleeve, m, and the direction of the beam from it, in the plane and across.

    At the centre itself it is the direction of the motion.

    Args:
        u: place in the plane, from the centre, m.
        y: across it, m.
        v: du/dt, m/s.
        w: dy/dt, m/s.
    """
    r, speed = sqrt(u * u + y * y), sqrt(v * v + w * w)
    if r > 0.0:
        return r, u / r, y / r
    if speed > 0.0:
        return r, v / speed, w / speed
    return r, 1.0, 0.0


def point_forces(plant: Plant) -> tuple[PointForce, ...]:
    """All point forces of a plant."""
    structure = plant.structure
    forces = [PointForce(law.port, law.force, law.parameters, law.rate) for law in plant.laws]
    forces += [PointForce(Port(at), spring_and_dashpot, (stiffness, 0.0)) for at, stiffness in structure.springs]
    forces += [PointForce(Port(at), spring_and_dashpot, (0.0, damping)) for at, damping in structure.dashpots]
    for number, absorber in enumerate(structure.absorbers):
        omega = 2.0 * pi * absorber.frequency
        numbers = (absorber.mass * omega**2, 2.0 * absorber.damping_ratio * omega * absorber.mass)
        forces.append(PointForce(Stretch(number, absorber), spring_and_dashpot, numbers))
    for contact in plant.contacts:
        gap = (contact.clearance, contact.offset, contact.clearance_rate)
        law = contact.law
        port = Port(contact.position)
        forces.append(PointForce(port, law.normal_force, law.values, contact=gap, bilateral=is_bilateral(contact)))
    return tuple(forces)


def ports_of(forces: Sequence[PointForce]) -> tuple[Port, ...]:
    """The places on the structure through which forces act, each once.

    Args:
        forces: what acts.
    """
    named = [*(force.port for force in forces), *(force.partner for force in forces)]
    return tuple(port for port in dict.fromkeys(named) if isinstance(port, Port))


def forces_on_structure(plant: Plant) -> tuple[PointForce, ...]:
    """All point forces of a plant but those inside its absorbers, which an engine that has them moves by itself."""
    return tuple(force for force in point_forces(plant) if isinstance(force.port, Port))


def round_contacts(forces: Sequence[PointForce]) -> tuple[PointForce, ...]:
    """The same forces with contacts that are round in space.

    Args:
        forces: as they act in the plane.
    """
    return tuple(
        replace(force, partner=replace(force.port, across=True))
        if force.contact is not None and isinstance(force.port, Port)
        else force
        for force in forces
    )


def compile_items(forces: Sequence[PointForce], ports: Sequence[Port | Stretch]) -> Items:
    """The point forces for the stepper.

    Args:
        forces: what acts.
        ports: in the order of the system's rows.
    """
    index = {port: i for i, port in enumerate(ports)}
    sizes = [len(force.values) for force in forces]
    contact = np.zeros((len(forces), 5))
    for row, force in zip(contact, forces, strict=True):
        if force.contact is not None:
            row[:] = 1.0, float(force.bilateral), *force.contact
    return Items(
        port=np.array([index[force.port] for force in forces], np.int64),
        law=np.array([law_address(force.law) for force in forces], np.int64),
        rate=np.array([0 if force.rate is None else law_address(force.rate) for force in forces], np.int64),
        first=np.cumsum([0, *sizes], dtype=np.int64)[:-1],
        values=np.array([value for force in forces for value in force.values], float),
        contact=contact,
        partner=np.array([-1 if force.partner is None else index[force.partner] for force in forces], np.int64),
    )
