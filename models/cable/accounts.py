"""What a cable's motion says: the sensors' readings, and where the energy went."""

import numpy as np
from scipy.integrate import cumulative_simpson

from models.arrays import FloatArray
from models.cable.matrices import axial_stiffness, gauss_points
from models.cable.moving import March
from models.cable.rig_cable import RigCable
from models.fine.finite_elements import hermite
from models.simulators.protocol import EnergyBalance
from models.simulators.recorded import Steps


def accounted(cable: RigCable, moved: March, rest: FloatArray, every: int) -> Steps:
    """What was read, the forces at the ports and where the energy went.

    Args:
        cable: that moved.
        moved: at whole steps.
        rest: (n,) coordinates at rest.
        every: steps per sample.
    """
    plant, course, q, v = cable.plant, cable.course, moved.q, moved.v
    sensors = [cable.row(s.position or 0.0, int(s.quantity == "angular_velocity")) for s in plant.sensors]
    place = q @ cable.port_rows.T
    taken = np.zeros(len(q) - 1)
    for number, way in enumerate(place.T):
        force = moved.forces[:, cable.of_port(number)].sum(axis=1)
        taken -= 0.5 * (force[1:] + force[:-1]) * np.diff(way)
    power = np.zeros(len(q))
    if plant.excitation is not None and plant.excitation.position is not None:
        power += course.force * (v @ cable.row_of_drive(plant.excitation.position))
    if course.base_moves:
        power -= course.base[2] * (v @ cable.carried)
    lost = np.sum((v @ cable.damping) * v, axis=1)
    at = slice(None, None, every)
    return Steps(
        read=np.array(sensors).reshape(-1, len(rest)) @ (q - rest).T,
        motion=np.ascontiguousarray(place.T),
        forces=np.ascontiguousarray(moved.forces[:, : len(cable.forces)].T),
        across=np.ascontiguousarray(moved.forces[:, len(cable.forces) :].T) if cable.in_space else None,
        energy=EnergyBalance(
            stored=stored_energy(cable, q[at], v[at]),
            supplied=cumulative_simpson(power, dx=course.step, initial=0.0)[at],
            damped=cumulative_simpson(lost, dx=course.step, initial=0.0)[at],
            taken=np.concatenate([[0.0], np.cumsum(taken)])[at],
        ),
    )


def stored_energy(cable: RigCable, q: FloatArray, v: FloatArray) -> FloatArray:
    """(M,) energy of motion, of stretching and bending, and of height, J.

    Stretch is |r'| - 1 and curvature (r' x r'') / |r'|^2, as Exudyn's cable has them.
    Source: J. Gerstmayr, H. Irschik, J. Sound Vib. 318 (2008) 461, equations 16 and 22.
    """
    structure, nodes = cable.plant.structure, cable.nodes
    points = [(k, h, s, weight) for k, h in enumerate(np.diff(nodes)) for s, weight in gauss_points(h)]
    weights = np.array([weight for *_, weight in points])
    layout = cable.layout
    first, second = np.zeros((2, layout.ways, len(points), q.shape[1]))
    for number, (k, h, s, _) in enumerate(points):
        for way in range(layout.ways):
            own = layout.own * k + np.array(layout.of_element(way))
            first[way, number, own] = hermite(s, h, 1)
            second[way, number, own] = hermite(s, h, 2)
    slope, bend = [q @ rows.T for rows in first], [q @ rows.T for rows in second]
    slope[0] = slope[0] + 1.0
    square = np.sum(np.square(slope), axis=0)
    pairs = [(i, j) for j in range(layout.ways) for i in range(j)]
    turned = np.sum([(slope[i] * bend[j] - slope[j] * bend[i]) ** 2 for i, j in pairs], axis=0)
    strain = axial_stiffness(structure) * ((np.sqrt(square) - 1.0) ** 2 @ weights)
    strain += structure.bending_stiffness * ((turned / square**2) @ weights)
    moving = np.sum((v @ cable.mass) * v, axis=1) + np.sum((q @ cable.attached) * q, axis=1)
    return np.asarray(0.5 * (strain + moving) + structure.gravity * (q @ cable.carried))
