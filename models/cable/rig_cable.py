"""A plant as ANCF cable elements in Exudyn: its nodes, its forces, and its matrices of small motion."""

from dataclasses import dataclass
from functools import cached_property
from math import cos, sin
from typing import Any

import numpy as np

from models.arrays import FloatArray
from models.cable.course import Course
from models.cable.matrices import (
    ACROSS,
    SPACE,
    UP,
    Layout,
    shape_at,
)
from models.cable.port_law import PortLaw, RoundLaw
from models.plant import Plant
from models.point_forces import PointForce
from models.ports import Port


@dataclass(frozen=True, eq=False)
class RigCable:
    """A plant in Exudyn, not yet at rest.

    Attributes:
        plant: what was built.
        system: Exudyn's own.
        container: keeps ``system`` alive.
        layout: of the nodes' coordinates, in the plane or in space.
        nodes: (n_nodes,) m from the clamp.
        forces: all point forces, those of the sleeves last.
        ports: of the point forces.
        laws: of each port, but for round contacts.
        rounds: round contacts.
        course: read by loads and laws at every step.
        mass, damping: (n, n) of small motion about the straight beam, absorbers' coordinates last.
        attached: (n, n) stiffness of the clamp's and the absorbers' springs.
        carried: (n,) inertia against an acceleration of the base, kg.
    """

    plant: Plant
    system: Any
    container: Any
    layout: Layout
    nodes: FloatArray
    forces: tuple[PointForce, ...]
    ports: tuple[Port, ...]
    laws: tuple[PortLaw, ...]
    rounds: tuple[RoundLaw, ...]
    course: Course
    mass: FloatArray
    damping: FloatArray
    attached: FloatArray
    carried: FloatArray

    @cached_property
    def port_rows(self) -> FloatArray:
        """(n_ports, n) motion of the ports by coordinate."""
        rows = [self.row(port.position or 0.0, port.derivative, ACROSS if port.across else UP) for port in self.ports]
        return np.array(rows).reshape(-1, len(self.carried))

    def row(self, position: float, derivative: int = 0, way: int = UP) -> FloatArray:
        """(n,) weights of the coordinates in the deflection or the slope at a place, m from the clamp."""
        row = np.zeros(len(self.carried))
        k, shape = shape_at(self.nodes, position, derivative)
        row[self.layout.own * k + np.array(self.layout.of_element(way))] = shape
        return row

    def row_of_drive(self, position: float) -> FloatArray:
        """(n,) motion along the force that drives the cable, by coordinate."""
        row = cos(self.course.angle) * self.row(position)
        return row + sin(self.course.angle) * self.row(position, way=ACROSS) if self.in_space else row

    @property
    def in_space(self) -> bool:
        """Whether the cable can leave the plane."""
        return self.layout == SPACE

    def of_port(self, number: int) -> list[int]:
        """Numbers of the forces at a port; those of round contacts across the plane come after all others."""
        port, n = self.ports[number], len(self.forces)
        across = [n + i for i, law in enumerate(self.rounds) if law.ports[1] == port]
        return [k for k, force in enumerate(self.forces) if force.port == port] + across

    @cached_property
    def columns(self) -> list[int]:
        """Numbers of the forces in the order of the laws and the round contacts, as each tells them."""
        n = len(self.forces)
        plain = [
            k
            for port in self.ports
            for k, force in enumerate(self.forces)
            if force.port == port and force.partner is None
        ]
        first = n - len(self.rounds)  # contacts come last
        return plain + [k for i in range(len(self.rounds)) for k in (first + i, n + i)]
