"""The engine's own contact in a sleeve: a ball on the beam between two planes, set to a spring and a dashpot.

With ``solref = (-S, -B)`` and a constant impedance d the engine's soft constraint pushes with
(S p + B dp/dt) / ((1 - d) A), where A is the inverse mass it has noted for the ball's body, and never pulls.
Source: MuJoCo documentation, Computation, "Constraint model"; k and c were measured in a drop (the tests).
"""

from typing import Any

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.chain.segments import Segments
from models.errors import InputError
from models.plant import Plant
from models.ports import Contact
from models.rest import is_bilateral

IMPEDANCE = 0.001
"""Small, so that the contact adds no inertia: at 0.9 it triples the time of an impact."""

SIDES = {"below": 1.0, "above": -1.0}


def cannot_stop(plant: Plant) -> str | None:
    """What of the plant's contacts the engine's own cannot be, in words, or None."""
    for contact in plant.contacts:
        if contact.law.name != "kelvin_voigt":
            return f"{contact.sleeve}: a {contact.law.name} contact"
        if is_bilateral(contact) or contact.clearance_rate:
            return f"{contact.sleeve}: a contact without clearance, or with one that grows"
    return None


def has_stops(model: Any) -> bool:
    """Whether the engine's own contacts act in a model."""
    return not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)


def check_stops(plant: Plant) -> None:
    """Refuse contacts that the engine does not have.

    Raises:
        InputError: there is one.
    """
    words = cannot_stop(plant)
    if words is not None:
        raise InputError(
            f"mujoco, native contact: {words}",
            "the engine's own contact is a spring and a dashpot that push",
            "take our own contact (native_contact = False), which carries every law",
        )


def add_stops(spec: Any, body: Any, contact: Contact, place: float, radius: float) -> None:
    """A ball on a body, at a place from its hinge, m, and the two planes that it meets."""
    ball = body.add_geom(
        name=f"{contact.sleeve} ball", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0.0, 0.0],
        pos=[place, 0.0, 0.0], mass=0.0, contype=0, conaffinity=0, rgba=UNSEEN,
    )  # fmt: skip
    for side, up in SIDES.items():
        height = contact.offset - up * (contact.clearance + radius)
        plane = spec.worldbody.add_geom(
            name=f"{contact.sleeve} {side}", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[radius, radius, 1.0],
            pos=[contact.position, 0.0, height], zaxis=[0.0, 0.0, up], contype=0, conaffinity=0, rgba=UNSEEN,
        )  # fmt: skip
        pair = spec.add_pair(name=plane.name, geomname1=plane.name, geomname2=ball.name)
        pair.condim, pair.solimp = 1, [IMPEDANCE, IMPEDANCE, 1.0, 0.5, 2.0]


def weigh_stops(spec: Any, plant: Plant, segments: Segments) -> None:
    """Give the pairs their stiffness and damping, for the inverse masses that the engine notes when it compiles."""
    model = spec.compile()
    for contact in plant.contacts:
        body = model.body(f"segment {segments.segment_at(contact.position or 0.0) + 1}").id
        share = (1.0 - IMPEDANCE) * float(model.body_invweight0[body, 0])
        stiffness, damping = contact.law.values
        for side in SIDES:
            spec.pair(f"{contact.sleeve} {side}").solref = [-stiffness * share, -damping * share]


def forces_of_stops(model: Any, data: Any, plant: Plant, constrained: FloatArray) -> FloatArray:
    """(n_contacts, M) forces of the sleeves, N upwards, from the torques of all constraints, (M, n_dofs)."""
    levers = np.zeros((len(plant.contacts), model.nv))
    jacobian = np.zeros((3, model.nv))
    for row, contact in zip(levers, plant.contacts, strict=True):
        ball = model.geom(f"{contact.sleeve} ball").id
        mujoco.mj_jac(model, data, jacobian, None, data.geom_xpos[ball], int(model.geom_bodyid[ball]))
        row[:] = jacobian[2]
    return np.asarray(np.linalg.lstsq(levers.T, constrained.T, rcond=None)[0])


UNSEEN = (0.0, 0.0, 0.0, 0.0)
