"""A plant as ANCF cable elements in Exudyn: nodes on every port, forces of laws and sleeves there, gravity, clamp."""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    LoadCoordinate,
    MarkerBodiesRelativeTranslationCoordinate,
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
from models.cable.course import Course
from models.cable.matrices import OWN, UP, attached_mass, axial_stiffness, shape_at, small_motion
from models.cable.port_law import PortLaw
from models.fine.finite_elements import TOUCH
from models.fine.mesh import place_nodes
from models.plant import Plant
from models.point_forces import PointForce, forces_on_structure, ports_of
from models.ports import Port


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
    def port_rows(self) -> FloatArray:
        """(n_ports, n) motion of the ports by coordinate."""
        rows = [self.row(port.position or 0.0, port.derivative) for port in self.ports]
        return np.array(rows).reshape(-1, len(self.carried))

    def row(self, position: float, derivative: int = 0) -> FloatArray:
        """(n,) weights of the coordinates in the deflection or the slope at a place, m from the clamp."""
        row = np.zeros(len(self.carried))
        k, shape = shape_at(self.nodes, position, derivative)
        row[OWN * k + np.array(UP)] = shape
        return row

    def of_port(self, number: int) -> list[int]:
        """Numbers of the forces at a port."""
        return [k for k, force in enumerate(self.forces) if force.port == self.ports[number]]


def build_cable(plant: Plant, n_elements: int, course: Course, held_at: float | None = None) -> RigCable:
    """Put a plant into Exudyn.

    Args:
        plant: a beam with effects that the cable carries.
        n_elements: at least; there is a node at every port and where forces act besides.
        course: what drives it.
        held_at: where a static force holds it until the motion begins, m from the clamp, or None.
    """
    container = exu.SystemContainer()
    system, structure = container.AddSystem(), plant.structure
    forces = forces_on_structure(plant)
    ports = ports_of(forces)
    laws = tuple(PortLaw([force for force in forces if force.port == port], course.step) for port in ports)
    driven_at = None if plant.excitation is None else plant.excitation.position
    named = [*(port.position for port in ports), driven_at, *(a.position for a in structure.absorbers), held_at]
    nodes = place_nodes(structure.length, [place for place in named if place is not None], n_elements)
    cable = RigCable(plant, system, container, nodes, forces, ports, laws, course, *small_motion(structure, nodes))
    build = _Builder(cable)
    build.beam()
    build.clamp()
    for port, law in zip(ports, laws, strict=True):
        build.law(port, law)
    for absorber in structure.absorbers:
        build.absorber(absorber.position or 0.0, absorber.mass, absorber.coefficients)
    if driven_at is not None:
        build.load(driven_at, lambda mbs, t, load: course.force_at(t))  # noqa: ARG005
    if held_at is not None:
        build.load(held_at, lambda mbs, t, load: course.held if course.settling else 0.0)  # noqa: ARG005
    if course.base_moves:
        build.base_motion()
    system.Assemble()
    return cable


def compliance_at(plant: Plant, n_elements: int, position: float) -> float:
    """1 / mass that a sudden force at a place meets in a mesh with a node there, 1/kg."""
    nodes = place_nodes(plant.structure.length, [position], n_elements)
    mass, *_ = small_motion(plant.structure, nodes)
    k, shape = shape_at(nodes, position, 0)
    row = np.zeros(len(mass))
    row[OWN * k + np.array(UP)] = shape
    free = np.delete(np.arange(len(mass)), [0, 1, OWN - 1])
    return float(row[free] @ np.linalg.solve(mass[np.ix_(free, free)], row[free]))


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
        """The elements; in one object with all nodes what damps them by mass, the points on them, and all weight."""
        structure = self.cable.plant.structure
        eta1, eta2 = (structure.damping_scale * eta for eta in structure.rayleigh)
        axial = axial_stiffness(structure)
        for k, length in enumerate(np.diff(self.nodes)):
            element = ObjectANCFCable2D(
                length=length,
                massPerLength=structure.line_mass,
                bendingStiffness=structure.bending_stiffness,
                axialStiffness=axial,
                bendingDamping=eta2 * structure.bending_stiffness,
                axialDamping=eta2 * axial,
                nodeNumbers=[self.numbers[k], self.numbers[k + 1]],
            )
            self.elements.append(self.system.AddObject(element))
        own = OWN * len(self.nodes)
        self.system.AddObject(
            ObjectGenericODE2(
                nodeNumbers=self.numbers,
                massMatrix=_sparse(attached_mass(structure, self.nodes)),
                dampingMatrix=_sparse(eta1 * self.cable.mass[:own, :own]),
                forceVector=-structure.gravity * self.cable.carried[:own],
            )
        )

    def base_motion(self) -> None:
        """Inertia against the base's acceleration: the coordinates are relative to the base."""
        course, carried = self.cable.course, self.cable.carried[: OWN * len(self.nodes)]
        self.system.AddObject(
            ObjectGenericODE2(
                nodeNumbers=self.numbers,
                forceUserFunction=lambda mbs, t, item, q, v: -course.base_at(t, 2) * carried,  # noqa: ARG005
            )
        )

    def clamp(self) -> None:
        """No displacement at the clamp, and no slope or a spring against it, which is damped like the beam's own."""
        structure = self.cable.plant.structure
        spring, eta2 = structure.clamp_stiffness, structure.damping_scale * structure.rayleigh[1]
        for coordinate in (0, 1, OWN - 1):
            marker = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=self.numbers[0], coordinate=coordinate))
            markers = [self.still, marker]
            if coordinate == OWN - 1 and spring < inf:
                self.system.AddObject(
                    ObjectConnectorCoordinateSpringDamper(
                        markerNumbers=markers, stiffness=spring, damping=eta2 * spring
                    )
                )
            else:
                self.system.AddObject(ObjectConnectorCoordinate(markerNumbers=markers))

    def law(self, port: Port, law: PortLaw) -> None:
        """All forces of a port, between the ground and the beam."""
        markers = [self.still, self._marker(port.position or 0.0, port.derivative)]
        course, absolute = self.cable.course, port.frame == "ground"

        def felt(mbs: Any, t: float, item: int, q: float, v: float, *rest: float) -> float:  # noqa: ARG001
            if absolute:
                q, v = q + course.base_at(t, 0), v + course.base_at(t, 1)
            return -law(0.0 if course.settling else t, q, v)

        asked: Any = felt
        self.system.AddObject(
            ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, springForceUserFunction=asked)
        )

    def absorber(self, position: float, mass: float, coefficients: tuple[float, float]) -> None:
        """A small oscillator hanging on the beam."""
        own = self.system.AddNode(Node1D(referenceCoordinates=[0.0]))
        self.system.AddObject(Mass1D(mass=mass, nodeNumber=own))
        marker = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=own, coordinate=0))
        markers = [self._marker(position, 0), marker]
        spring, dashpot = coefficients
        self.system.AddObject(
            ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, stiffness=spring, damping=dashpot)
        )
        course, gravity = self.cable.course, self.cable.plant.structure.gravity

        def weight(mbs: Any, t: float, load: float) -> float:  # noqa: ARG001
            return -mass * (gravity + course.base_at(t, 2))

        self.system.AddLoad(LoadCoordinate(markerNumber=marker, loadUserFunction=weight))

    def load(self, position: float, force: Any) -> None:
        """A force upwards, as Exudyn asks for it."""
        self.system.AddLoad(LoadCoordinate(markerNumber=self._marker(position, 0), loadUserFunction=force))

    def _marker(self, position: float, derivative: int) -> Any:
        """A node's coordinate where there is a node, else the displacement of a place within an element."""
        k = int(np.argmin(np.abs(self.nodes - position)))
        if abs(self.nodes[k] - position) < TOUCH * self.nodes[-1]:
            coordinate = OWN - 1 if derivative else 1
            return self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=self.numbers[k], coordinate=coordinate))
        k, _ = shape_at(self.nodes, position, 0)
        return self.system.AddMarker(
            MarkerBodiesRelativeTranslationCoordinate(
                bodyNumbers=[self.ground, self.elements[k]],
                localPosition0=[position, 0.0, 0.0],
                localPosition1=[position - self.nodes[k], 0.0, 0.0],
                axis0=[0.0, 1.0, 0.0],
            )
        )


def _sparse(matrix: FloatArray) -> Any:
    """As Exudyn keeps it."""
    kept = exu.MatrixContainer()
    kept.SetWithDenseMatrix(matrix, useDenseMatrix=False)
    return kept
