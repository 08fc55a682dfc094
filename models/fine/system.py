"""The plant in the modes of its finite elements, none left out, with a port for every point force."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import sqrt

import numpy as np

from models.arrays import FloatArray
from models.equilibrium import find_rest, forces_at
from models.fine.finite_elements import FiniteElements, assemble
from models.fine.mesh import place_nodes
from models.plant import Plant
from models.point_forces import PointForce, Stretch, point_forces
from models.ports import Port


@dataclass(frozen=True, eq=False)
class FineSystem:
    """Equations q'' + damping q' + omega^2 q = ports' F + ... of the whole plant.

    Attributes:
        omega, damping: (n,) rad/s and 1/s; an absorber's mass is a coordinate of its own, held only by its port.
        carried: (n,) inertia against an acceleration of the base, sqrt(kg).
        ports: what the point forces act through.
        port_rows: (n_ports, n) motion of each port by coordinate.
        forces: all point forces.
        rest: (n,) coordinates at rest under gravity.
        elements: of the beam; None for an oscillator.
    """

    omega: FloatArray
    damping: FloatArray
    carried: FloatArray
    ports: tuple[Port | Stretch, ...]
    port_rows: FloatArray
    forces: tuple[PointForce, ...]
    rest: FloatArray
    elements: FiniteElements | None

    def row(self, position: float | None, derivative: int = 0) -> FloatArray:
        """(n,) deflection, slope or curvature at a place, m from the clamp, by coordinate."""
        return _row(self.elements, self.carried, position, derivative)

    @cached_property
    def bending(self) -> FloatArray:
        """(n_beam, n_beam) share of the beam's own bending in omega^2, without the absorbers' masses."""
        assert self.elements is not None
        shapes = self.elements.modes[1]
        return np.asarray(shapes.T @ self.elements.bending @ shapes)

    @property
    def bending_at_rest(self) -> FloatArray:
        """(n,) generalised force with which the beam's own bending resists the deflection at rest."""
        force, n = np.zeros(len(self.omega)), len(self.bending)
        force[:n] = self.bending @ self.rest[:n]
        return force

    def forces_at_rest(self) -> FloatArray:
        """(n_ports,) forces on the structure at rest, N."""
        return forces_at(self.port_rows @ self.rest, self.ports, self.forces)


def build_system(plant: Plant, n_elements: int) -> FineSystem:
    """Discretise a plant and find where it rests.

    Args:
        plant: the rig with its effects.
        n_elements: finite elements along the beam at least; there is a node at every named place besides.

    Raises:
        InputError: no state at rest is found, or an axial load buckles the beam.
    """
    structure, forces = plant.structure, point_forces(plant)
    ports = tuple(dict.fromkeys(force.port for force in forces))
    if structure.is_beam:
        elements = assemble(structure, _mesh(plant, ports, n_elements))
        (omega, shapes), damping = elements.modes, elements.damping()
        carried = shapes.T @ elements.carried
    else:
        elements = None
        mass = structure.line_mass + sum(mass for _, mass in structure.masses)
        own = structure.rayleigh[0] * structure.line_mass * structure.damping_scale
        omega, damping = np.array([sqrt(structure.bending_stiffness / mass)]), np.array([own / mass])
        carried = np.array([sqrt(mass)])
    hung = [sqrt(absorber.mass) for absorber in structure.absorbers]
    omega, damping = np.append(omega, np.zeros(len(hung))), np.append(damping, np.zeros(len(hung)))
    carried = np.append(carried, hung)
    rows = np.array([_port_row(elements, carried, port, len(hung)) for port in ports]).reshape(-1, len(omega))
    forces = _yielding(plant, omega, dict(zip(ports, rows, strict=True)))
    rest = find_rest(omega, -structure.gravity * carried, rows, ports, forces)
    return FineSystem(omega, damping, carried, ports, rows, forces, rest, elements)


def _yielding(plant: Plant, omega: FloatArray, rows: dict[Port | Stretch, FloatArray]) -> tuple[PointForce, ...]:
    """The point forces, those that ask for it with what their port yields to a unit force."""
    square = np.where(omega > 0.0, omega**2, np.inf)
    laws = tuple(law.yielding(float(np.sum(rows[law.port] ** 2 / square))) for law in plant.laws)
    return point_forces(replace(plant, laws=laws))


def _mesh(plant: Plant, ports: tuple[Port | Stretch, ...], n_elements: int) -> FloatArray:
    structure = plant.structure
    named: list[float | None] = [hinge.position for hinge in structure.hinges]
    named += [port.absorber.position for port in ports if isinstance(port, Stretch)]
    named += [port.position for port in ports if isinstance(port, Port) and port.is_concentrated]
    named += [position for position, _ in structure.masses]
    named += [plant.excitation.position if plant.excitation is not None else None]
    named += [sensor.position for sensor in plant.sensors]
    return place_nodes(structure.length, [place for place in named if place is not None], n_elements)


def _row(
    elements: FiniteElements | None, carried: FloatArray, position: float | None, derivative: int = 0
) -> FloatArray:
    row = np.zeros(len(carried))
    if elements is None:
        row[0] = 1.0 / carried[0]
    else:
        shape = elements.row(position or 0.0, derivative) @ elements.modes[1]
        row[: len(shape)] = shape
    return row


def _port_row(elements: FiniteElements | None, carried: FloatArray, port: Port | Stretch, n_hung: int) -> FloatArray:
    if isinstance(port, Port):
        return _row(elements, carried, port.position, port.derivative)
    row = -_row(elements, carried, port.absorber.position)
    own = len(carried) - n_hung + port.number
    row[own] = 1.0 / carried[own]
    return row
