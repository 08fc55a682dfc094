"""A plant as ANCF cable elements in Exudyn: nodes on every port, forces of laws and sleeves there, gravity, clamp."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    LoadCoordinate,
    LoadMassProportional,
    MarkerBodiesRelativeTranslationCoordinate,
    MarkerBodyMass,
    MarkerNodeCoordinate,
    Mass1D,
    Node1D,
    NodePoint2DSlope1,
    NodePointGround,
    ObjectANCFCable2D,
    ObjectConnectorCoordinate,
    ObjectConnectorCoordinateSpringDamper,
    ObjectGenericODE2,
    ObjectGround,
)

from models.arrays import FloatArray
from models.cable.port_law import PortLaw
from models.fine.finite_elements import TOUCH, hermite
from models.fine.mesh import place_nodes
from models.plant import Plant
from models.point_forces import PointForce, Stretch, point_forces
from models.ports import Port
from models.structure import Structure

OWN = 4
"""Coordinates of a node: displacements x and y, and changes of the slope vector's x and y."""

UPWARDS = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
"""An element's coordinates in a unit displacement upwards."""

Motion = Callable[[float], float]


@dataclass(eq=False)
class Course:
    """What drives the cable while it moves; while the state at rest is sought, only what holds it acts.

    Attributes:
        force, base: N and m/s^2 at a time, s.
        held: N at ``held_at`` until the motion begins.
        settling: whether the state at rest is sought.
    """

    force: Motion
    base: Motion
    held: float = 0.0
    settling: bool = True


@dataclass(frozen=True, eq=False)
class RigCable:
    """A plant in Exudyn, not yet at rest.

    Attributes:
        plant: what was built.
        system: Exudyn's own.
        container: keeps ``system`` alive.
        nodes: (n_nodes,) m from the clamp.
        forces: all point forces, those of the sleeves last.
        ports: of the point forces.
        laws: of each port.
        course: read by loads and laws at every step.
        mass, damping: (n, n) of small motion about the straight beam, absorbers' coordinates last.
        attached: (n, n) stiffness of the clamp's and the absorbers' springs.
        carried: (n,) inertia against an acceleration of the base, kg.
    """

    plant: Plant
    system: Any
    container: Any
    nodes: FloatArray
    forces: tuple[PointForce, ...]
    ports: tuple[Port, ...]
    laws: tuple[PortLaw, ...]
    course: Course
    mass: FloatArray
    damping: FloatArray
    attached: FloatArray
    carried: FloatArray

    @cached_property
    def port_of(self) -> tuple[int, ...]:
        """Number of each force's port."""
        return tuple(self.ports.index(force.port) for force in self.forces if isinstance(force.port, Port))

    def row(self, position: float, derivative: int = 0) -> FloatArray:
        """(n,) weights of the coordinates in the deflection or the slope at a place, m from the clamp."""
        row = np.zeros(len(self.carried))
        k, shape = _shape(self.nodes, position, derivative)
        row[OWN * k + np.array([1, 3, 5, 7])] = shape
        return row


def build_cable(plant: Plant, n_elements: int, course: Course, held_at: float | None = None) -> RigCable:
    """Put a plant into Exudyn.

    Args:
        plant: a beam with effects that the cable carries.
        n_elements: at least; there is a node at every port and at the excitation besides.
        course: what drives it.
        held_at: where a static force holds it until the motion begins, m from the clamp, or None.
    """
    container = exu.SystemContainer()
    system, structure = container.AddSystem(), plant.structure
    forces = tuple(force for force in point_forces(plant) if not isinstance(force.port, Stretch))
    ports = tuple(port for port in dict.fromkeys(force.port for force in forces) if isinstance(port, Port))
    laws = tuple(PortLaw([force for force in forces if force.port == port]) for port in ports)
    driven_at = None if plant.excitation is None else plant.excitation.position
    named = [*(port.position for port in ports), driven_at, *(a.position for a in structure.absorbers)]
    nodes = place_nodes(structure.length, [place for place in named if place is not None], n_elements)
    cable = RigCable(plant, system, container, nodes, forces, ports, laws, course, *_matrices(structure, nodes))
    build = _Builder(cable)
    build.beam()
    build.clamp(structure.clamp_stiffness)
    for port, law in zip(ports, laws, strict=True):
        build.law(port, law)
    for absorber in structure.absorbers:
        build.absorber(absorber.position or 0.0, absorber.mass, absorber.coefficients)
    if driven_at is not None:
        build.load(driven_at, lambda t: 0.0 if course.settling else course.force(t))
    if held_at is not None:
        build.load(held_at, lambda t: course.held if course.settling else 0.0)  # noqa: ARG005
    system.Assemble()
    return cable


class _Builder:
    """Adds the parts of a cable to its system."""

    def __init__(self, cable: RigCable) -> None:
        self.cable, self.system, self.nodes = cable, cable.system, cable.nodes
        ground = self.system.AddNode(NodePointGround(referenceCoordinates=[0.0, 0.0, 0.0]))
        self.still = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        self.ground = self.system.AddObject(ObjectGround())
        self.numbers = [
            self.system.AddNode(NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0])) for x in self.nodes
        ]
        self.elements: list[Any] = []

    def beam(self) -> None:
        """The elements with their weight, what damps them in proportion to mass, and the masses on them."""
        structure, course = self.cable.plant.structure, self.cable.course
        eta1, eta2 = (structure.damping_scale * eta for eta in structure.rayleigh)
        axial = axial_stiffness(structure)
        for k, length in enumerate(np.diff(self.nodes)):
            both = [self.numbers[k], self.numbers[k + 1]]
            element = self.system.AddObject(
                ObjectANCFCable2D(
                    physicsLength=length,
                    physicsMassPerLength=structure.line_mass,
                    physicsBendingStiffness=structure.bending_stiffness,
                    physicsAxialStiffness=axial,
                    physicsBendingDamping=eta2 * structure.bending_stiffness,
                    physicsAxialDamping=eta2 * axial,
                    nodeNumbers=both,
                )
            )
            self.elements.append(element)
            weight = self.system.AddMarker(MarkerBodyMass(bodyNumber=element))
            self.system.AddLoad(LoadMassProportional(markerNumber=weight, loadVector=[0.0, -structure.gravity, 0.0]))
            attached = attached_mass(structure, self.nodes, k)
            if eta1 or attached.any():
                self.system.AddObject(
                    ObjectGenericODE2(
                        nodeNumbers=both,
                        massMatrix=attached,
                        dampingMatrix=eta1 * (element_mass(structure, length) + attached),
                        forceVector=-structure.gravity * (attached @ UPWARDS),
                    )
                )
        carried = self.cable.carried[: OWN * len(self.nodes)]
        self.system.AddObject(
            ObjectGenericODE2(
                nodeNumbers=self.numbers,
                forceUserFunction=lambda mbs, t, item, q, v: -course.base(t) * carried,  # noqa: ARG005
            )
        )

    def clamp(self, stiffness: float) -> None:
        """No displacement at the clamp, and no slope or a spring against it."""
        for coordinate in (0, 1, 3):
            marker = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=self.numbers[0], coordinate=coordinate))
            markers = [self.still, marker]
            if coordinate == 3 and stiffness < inf:
                self.system.AddObject(ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, stiffness=stiffness))
            else:
                self.system.AddObject(ObjectConnectorCoordinate(markerNumbers=markers))

    def law(self, port: Port, law: PortLaw) -> None:
        """All forces of a port, between the ground and the beam."""
        markers = [self.still, self._marker(port.position or 0.0, port.derivative)]
        course = self.cable.course

        def felt(mbs: Any, t: float, item: int, q: float, v: float, *rest: float) -> float:  # noqa: ARG001
            return -law(0.0 if course.settling else t, q, v)

        self.system.AddObject(ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, springForceUserFunction=felt))

    def absorber(self, position: float, mass: float, coefficients: tuple[float, float]) -> None:
        """A small oscillator hanging on the beam."""
        own = self.system.AddNode(Node1D(referenceCoordinates=[0.0]))
        self.system.AddObject(Mass1D(physicsMass=mass, nodeNumber=own))
        marker = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=own, coordinate=0))
        markers = [self._marker(position, 0), marker]
        self.system.AddObject(
            ObjectConnectorCoordinateSpringDamper(
                markerNumbers=markers, stiffness=coefficients[0], damping=coefficients[1]
            )
        )
        course, gravity = self.cable.course, self.cable.plant.structure.gravity
        load = LoadCoordinate(markerNumber=marker, loadUserFunction=lambda mbs, t, load: -mass * (gravity + course.base(t)))  # noqa: ARG005
        self.system.AddLoad(load)

    def load(self, position: float, force: Motion) -> None:
        """A force upwards."""
        marker = self._marker(position, 0)
        self.system.AddLoad(LoadCoordinate(markerNumber=marker, loadUserFunction=lambda mbs, t, load: force(t)))  # noqa: ARG005

    def _marker(self, position: float, derivative: int) -> Any:
        """A node's coordinate where there is a node, else the displacement of a place within an element."""
        k = int(np.argmin(np.abs(self.nodes - position)))
        if abs(self.nodes[k] - position) < TOUCH * self.nodes[-1]:
            coordinate = 3 if derivative else 1
            return self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=self.numbers[k], coordinate=coordinate))
        k, _ = _shape(self.nodes, position, 0)
        return self.system.AddMarker(
            MarkerBodiesRelativeTranslationCoordinate(
                bodyNumbers=[self.ground, self.elements[k]],
                localPosition0=[position, 0.0, 0.0],
                localPosition1=[position - self.nodes[k], 0.0, 0.0],
                axis0=[0.0, 1.0, 0.0],
            )
        )


def axial_stiffness(structure: Structure) -> float:
    """E A of a solid round section, N."""
    return 16.0 * structure.bending_stiffness / structure.diameter**2


def _shape(nodes: FloatArray, position: float, derivative: int) -> tuple[int, FloatArray]:
    """Number of the element at a place, and its four cubic shapes, or their derivatives, there."""
    k = int(np.clip(np.searchsorted(nodes, position, side="right") - 1, 0, len(nodes) - 2))
    h = nodes[k + 1] - nodes[k]
    return k, hermite((position - nodes[k]) / h, h, derivative)


def both_ways(shape: FloatArray) -> FloatArray:
    """(2, 8) displacements x and y of an element by its coordinates, from its four cubic shapes."""
    rows = np.zeros((2, 2 * OWN))
    rows[0, [0, 2, 4, 6]] = rows[1, [1, 3, 5, 7]] = shape
    return rows


def element_mass(structure: Structure, h: float) -> FloatArray:
    """(8, 8) mass of an element of length h, m; kg."""
    places, weights = np.polynomial.legendre.leggauss(OWN)
    rows = [both_ways(hermite(0.5 * (s + 1.0), h, 0)) for s in places]
    return np.asarray(0.5 * h * structure.line_mass * sum(w * r.T @ r for w, r in zip(weights, rows, strict=True)))


def attached_mass(structure: Structure, nodes: FloatArray, k: int) -> FloatArray:
    """(8, 8) mass of the points attached to element k, kg."""
    total = np.zeros((2 * OWN, 2 * OWN))
    for position, mass in structure.masses:
        number, shape = _shape(nodes, position or 0.0, 0)
        if number == k:
            rows = both_ways(shape)
            total += mass * rows.T @ rows
    return total


def _matrices(structure: Structure, nodes: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Mass, damping, stiffness of attached springs, and inertia against a moving base, of small motion."""
    n, hung = OWN * len(nodes), structure.absorbers
    mass, damping, attached = np.zeros((3, n + len(hung), n + len(hung)))
    eta1, eta2 = (structure.damping_scale * eta for eta in structure.rayleigh)
    places, weights = np.polynomial.legendre.leggauss(OWN)
    for k, h in enumerate(np.diff(nodes)):
        own = slice(OWN * k, OWN * (k + 2))
        mass[own, own] += element_mass(structure, h) + attached_mass(structure, nodes, k)
        for s, weight in zip(0.5 * (places + 1.0), 0.5 * h * weights, strict=True):
            stretch, bend = both_ways(hermite(s, h, 1))[0], both_ways(hermite(s, h, 2))[1]
            damping[own, own] += eta2 * weight * axial_stiffness(structure) * np.outer(stretch, stretch)
            damping[own, own] += eta2 * weight * structure.bending_stiffness * np.outer(bend, bend)
    damping += eta1 * mass
    if structure.clamp_stiffness < inf:
        attached[3, 3] = structure.clamp_stiffness
    for number, absorber in enumerate(hung, start=n):
        k, shape = _shape(nodes, absorber.position or 0.0, 0)
        stretch = np.zeros(n + len(hung))
        stretch[OWN * k + np.array([1, 3, 5, 7])], stretch[number] = -shape, 1.0
        mass[number, number] = absorber.mass
        spring, dashpot = absorber.coefficients
        attached += spring * np.outer(stretch, stretch)
        damping += dashpot * np.outer(stretch, stretch)
    upwards = np.append(np.tile([0.0, 1.0, 0.0, 0.0], len(nodes)), np.ones(len(hung)))
    return mass, damping, attached, mass @ upwards
