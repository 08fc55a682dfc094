"""Putting a plant into Exudyn: the parts of its cable, one after the other."""

from math import cos, inf, sin
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    LoadCoordinate,
    MarkerBodiesRelativeTranslationCoordinate,
    MarkerBodyPosition,
    MarkerNodeCoordinate,
    MarkerNodePosition,
    Mass1D,
    Node1D,
    NodePoint2DSlope1,
    NodePointGround,
    NodePointSlope1,
    ObjectANCFCable,
    ObjectANCFCable2D,
    ObjectConnectorCartesianSpringDamper,
    ObjectConnectorCoordinate,
    ObjectConnectorCoordinateSpringDamper,
    ObjectGenericODE2,
    ObjectGround,
)

from models.arrays import FloatArray
from models.cable.course import Course
from models.cable.matrices import (
    ACROSS,
    PLANE,
    SPACE,
    UP,
    Layout,
    attached_mass,
    axial_stiffness,
    shape_at,
    small_motion,
)
from models.cable.port_law import PortLaw, RoundLaw
from models.cable.rig_cable import RigCable
from models.fine.finite_elements import TOUCH
from models.fine.mesh import place_nodes
from models.plant import Plant
from models.point_forces import forces_on_structure, ports_of, round_contacts
from models.ports import Port


def build_cable(
    plant: Plant, n_elements: int, course: Course, held_at: float | None = None, layout: Layout = PLANE
) -> RigCable:
    """Put a plant into Exudyn.

    Args:
        plant: a beam with effects that the cable carries.
        n_elements: at least; there is a node at every port and where forces act besides.
        course: what drives it.
        held_at: where a static force holds it until the motion begins, m from the clamp, or None.
        layout: whether it moves in the plane or in space, in round sleeves.
    """
    container = exu.SystemContainer()
    system, structure = container.AddSystem(), plant.structure
    forces = forces_on_structure(plant)
    if layout == SPACE:
        forces = round_contacts(forces)
    ports = ports_of(forces)
    laws = tuple(
        PortLaw([force for force in forces if force.port == port and force.partner is None], course.step)
        for port in ports
    )
    rounds = tuple(RoundLaw(force, course.step) for force in forces if force.partner is not None)
    driven_at = None if plant.excitation is None else plant.excitation.position
    named = [*(port.position for port in ports), driven_at, *(a.position for a in structure.absorbers), held_at]
    nodes = place_nodes(structure.length, [place for place in named if place is not None], n_elements)
    cable = RigCable(
        plant, system, container, layout, nodes, forces, ports, laws, rounds, course,
        *small_motion(structure, nodes, layout),
    )  # fmt: skip
    build = _Builder(cable)
    build.beam()
    build.clamp()
    for port, law in zip(ports, laws, strict=True):
        if law.forces:
            build.law(port, law)
    for contact, around in zip(plant.contacts, rounds, strict=False):
        build.round_sleeve(contact.position or 0.0, around)
    for absorber in structure.absorbers:
        build.absorber(absorber.position or 0.0, absorber.mass, absorber.coefficients)
    if driven_at is not None:
        build.drive(driven_at)
    if held_at is not None:
        build.load(held_at, UP, lambda mbs, t, load: course.held if course.settling else 0.0)  # noqa: ARG005
    if course.base_moves:
        build.base_motion()
    system.Assemble()
    return cable


def compliance_at(plant: Plant, n_elements: int, position: float) -> float:
    """1 / mass that a sudden force at a place meets in a mesh with a node there, 1/kg."""
    nodes = place_nodes(plant.structure.length, [position], n_elements)
    mass, *_ = small_motion(plant.structure, nodes, PLANE)
    k, shape = shape_at(nodes, position, 0)
    row = np.zeros(len(mass))
    row[PLANE.own * k + np.array(PLANE.of_element(UP))] = shape
    free = np.delete(np.arange(len(mass)), [*PLANE.fixed, *PLANE.turning])
    return float(row[free] @ np.linalg.solve(mass[np.ix_(free, free)], row[free]))


class _Builder:
    """Adds the parts of a cable to its system."""

    def __init__(self, cable: RigCable) -> None:
        self.cable, self.system, self.nodes, self.layout = cable, cable.system, cable.nodes, cable.layout
        ground = self.system.AddNode(NodePointGround(referenceCoordinates=[0.0, 0.0, 0.0]))
        self.still = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        self.ground = self.system.AddObject(ObjectGround())
        self.numbers = [
            self.system.AddNode(
                NodePointSlope1(referenceCoordinates=[x, 0.0, 0.0, 1.0, 0.0, 0.0])
                if cable.in_space
                else NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0])
            )
            for x in self.nodes
        ]
        self.elements: list[Any] = []

    def beam(self) -> None:
        """The elements; in one object with all nodes what damps them by mass, the points on them, and all weight."""
        structure = self.cable.plant.structure
        eta1, eta2 = (structure.damping_scale * eta for eta in structure.rayleigh)
        axial = axial_stiffness(structure)
        for k, length in enumerate(np.diff(self.nodes)):
            element = (ObjectANCFCable if self.cable.in_space else ObjectANCFCable2D)(
                length=length,
                massPerLength=structure.line_mass,
                bendingStiffness=structure.bending_stiffness,
                axialStiffness=axial,
                bendingDamping=eta2 * structure.bending_stiffness,
                axialDamping=eta2 * axial,
                nodeNumbers=[self.numbers[k], self.numbers[k + 1]],
            )
            self.elements.append(self.system.AddObject(element))
        own = self.layout.own * len(self.nodes)
        self.system.AddObject(
            ObjectGenericODE2(
                nodeNumbers=self.numbers,
                massMatrix=_sparse(attached_mass(structure, self.nodes, self.layout)),
                dampingMatrix=_sparse(eta1 * self.cable.mass[:own, :own]),
                forceVector=-structure.gravity * self.cable.carried[:own],
            )
        )

    def base_motion(self) -> None:
        """Inertia against the base's acceleration: the coordinates are relative to the base."""
        course, carried = self.cable.course, self.cable.carried[: self.layout.own * len(self.nodes)]
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
        for coordinate in (*self.layout.fixed, *self.layout.turning):
            marker = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=self.numbers[0], coordinate=coordinate))
            markers = [self.still, marker]
            if coordinate in self.layout.turning and spring < inf:
                self.system.AddObject(
                    ObjectConnectorCoordinateSpringDamper(
                        markerNumbers=markers, stiffness=spring, damping=eta2 * spring
                    )
                )
            else:
                self.system.AddObject(ObjectConnectorCoordinate(markerNumbers=markers))

    def law(self, port: Port, law: PortLaw) -> None:
        """All forces of a port, between the ground and the beam."""
        markers = [self.still, self._marker(port.position or 0.0, port.derivative, UP)]
        course, force = self.cable.course, law.asked()

        def absolute(mbs: Any, t: float, item: int, q: float, v: float, *rest: float) -> float:  # noqa: ARG001
            return -force(0.0 if course.settling else t, q + course.base_at(t, 0), v + course.base_at(t, 1))

        def relative(mbs: Any, t: float, item: int, q: float, v: float, *rest: float) -> float:  # noqa: ARG001
            return -force(0.0 if course.settling else t, q, v)

        asked: Any = absolute if port.frame == "ground" else relative
        self.system.AddObject(
            ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, springForceUserFunction=asked)
        )

    def round_sleeve(self, position: float, law: RoundLaw) -> None:
        """A contact that pushes towards the sleeve's centre, whichever way the beam leans."""
        node = self.numbers[int(np.argmin(np.abs(self.nodes - position)))]
        centre = self.system.AddMarker(MarkerBodyPosition(bodyNumber=self.ground, localPosition=[position, 0.0, 0.0]))
        markers = [centre, self.system.AddMarker(MarkerNodePosition(nodeNumber=node))]
        course = self.cable.course

        def felt(mbs: Any, t: float, item: int, place: Any, speed: Any, *rest: Any) -> list[float]:  # noqa: ARG001
            up, aside = law(0.0 if course.settling else t, (place[UP], place[ACROSS]), (speed[UP], speed[ACROSS]))
            return [0.0, -up, -aside]

        asked: Any = felt
        self.system.AddObject(
            ObjectConnectorCartesianSpringDamper(markerNumbers=markers, springForceUserFunction=asked)
        )

    def absorber(self, position: float, mass: float, coefficients: tuple[float, float]) -> None:
        """A small oscillator hanging on the beam."""
        own = self.system.AddNode(Node1D(referenceCoordinates=[0.0]))
        self.system.AddObject(Mass1D(mass=mass, nodeNumber=own))
        marker = self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=own, coordinate=0))
        markers = [self._marker(position, 0, UP), marker]
        spring, dashpot = coefficients
        self.system.AddObject(
            ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, stiffness=spring, damping=dashpot)
        )
        course, gravity = self.cable.course, self.cable.plant.structure.gravity

        def weight(mbs: Any, t: float, load: float) -> float:  # noqa: ARG001
            return -mass * (gravity + course.base_at(t, 2))

        self.system.AddLoad(LoadCoordinate(markerNumber=marker, loadUserFunction=weight))

    def drive(self, position: float) -> None:
        """The force that drives the cable, at its angle."""
        course = self.cable.course
        for way, share in ((UP, cos(course.angle)), (ACROSS, sin(course.angle))):
            if share:
                self.load(position, way, course.force_as_load(share))

    def load(self, position: float, way: int, force: Any) -> None:
        """A force one way, as Exudyn asks for it."""
        self.system.AddLoad(LoadCoordinate(markerNumber=self._marker(position, 0, way), loadUserFunction=force))

    def _marker(self, position: float, derivative: int, way: int) -> Any:
        """A node's coordinate where there is a node, else the displacement of a place within an element."""
        k = int(np.argmin(np.abs(self.nodes - position)))
        if abs(self.nodes[k] - position) < TOUCH * self.nodes[-1]:
            coordinate = self.layout.ways + way if derivative else way
            return self.system.AddMarker(MarkerNodeCoordinate(nodeNumber=self.numbers[k], coordinate=coordinate))
        k, _ = shape_at(self.nodes, position, 0)
        return self.system.AddMarker(
            MarkerBodiesRelativeTranslationCoordinate(
                bodyNumbers=[self.ground, self.elements[k]],
                localPosition0=[position, 0.0, 0.0],
                localPosition1=[position - self.nodes[k], 0.0, 0.0],
                axis0=[float(other == way) for other in range(3)],
            )
        )


def _sparse(matrix: FloatArray) -> Any:
    """As Exudyn keeps it."""
    kept = exu.MatrixContainer()
    kept.SetWithDenseMatrix(matrix, useDenseMatrix=False)
    return kept
