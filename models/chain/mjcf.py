"""The rig as a MuJoCo model: a chain of segments with sprung hinges, masses and absorbers on it, sleeves around it."""

import re
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import mujoco
import numpy as np

from models.chain.native_contact import add_stops, weigh_stops
from models.chain.segments import Segments
from models.chain.sleeve_mesh import sleeve_mesh
from models.plant import Plant
from models.structure import Structure

UPWARDS, SIDEWAYS = (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)
"""Axes of the hinges: a positive angle lifts what comes after, or turns it towards y."""

ANY_STEP = 0.25
"""Newmark's beta at which a spring is stable at any step, for a clamp that is all but built in."""

THIN = 1e-9
"""Moment of inertia, kg m^2, about the beam's own axis, which no planar motion asks for but the engine does."""

BEAM_COLOUR, SLEEVE_COLOUR, MASS_COLOUR = (0.45, 0.5, 0.56, 1.0), (0.8, 0.55, 0.2, 0.45), (0.2, 0.35, 0.6, 1.0)


@dataclass(frozen=True)
class ChainSettings:
    """How the chain is integrated.

    Attributes:
        step: s.
        newmark: beta of Newmark's method that the armature of the hinges makes of the engine's own step.
        rotary_inertia: whether the sections' own rotary inertia is counted.
        native_contact: whether the engine's own contacts act in the sleeves, instead of our laws.
        spatial: whether every hinge bends across the rig's plane too.
    """

    step: float
    newmark: float
    rotary_inertia: bool
    native_contact: bool = False
    spatial: bool = False


def build_spec(plant: Plant, segments: Segments, settings: ChainSettings) -> Any:
    """The MjSpec of a plant; forces at points are not in it, and those in sleeves only where they are the engine's own.

    Args:
        plant: a beam with its sleeves.
        segments: the chain.
        settings: step and inertia.
    """
    structure = plant.structure
    spec = mujoco.MjSpec()
    spec.modelname = "clearance testbed"
    spec.option.timestep = settings.step
    spec.option.gravity = [0.0, 0.0, -structure.gravity]
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    if not settings.native_contact:
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    spec.compiler.degree = False
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.worldbody.add_light(pos=[0.5 * structure.length, -2.0, 2.0], dir=[0.0, 0.7, -0.7])
    for contact in plant.contacts:
        _add_sleeve(spec, contact.sleeve, contact.position or 0.0, structure.diameter / 2 + contact.clearance)
    body, at, eta2 = spec.worldbody, 0.0, structure.rayleigh[1] * structure.damping_scale
    if structure.clamp_stiffness < inf:
        body = body.add_body(name="clamp")
        stiff = is_stiff(structure.clamp_stiffness, structure, segments)
        of_clamp = replace(settings, newmark=ANY_STEP) if stiff and settings.newmark else settings
        _add_hinge(body, "clamp", structure.clamp_stiffness, eta2 * structure.clamp_stiffness, of_clamp)
        _give_mass(body, structure, (0.0, 0.5 * segments.h), 0.0, settings)
    else:
        _draw(body, structure, 0.0, 0.5 * segments.h)
    spring = structure.bending_stiffness / segments.h
    for i, (hinge, span) in enumerate(zip(segments.hinges, segments.spans, strict=True)):
        body = body.add_body(name=f"segment {i + 1}", pos=[hinge - at, 0.0, 0.0])
        at = float(hinge)
        _add_hinge(body, f"hinge {i + 1}", spring, eta2 * spring, settings)
        _give_mass(body, structure, (float(span[0]) - at, float(span[1]) - at), at, settings)
        _add_what_it_carries(spec, body, plant, segments, i, settings)
    if settings.native_contact:
        weigh_stops(spec, plant, segments)
    return spec


def _add_what_it_carries(
    spec: Any, body: Any, plant: Plant, segments: Segments, i: int, settings: ChainSettings
) -> None:
    """Masses and absorbers on segment i, and what it meets in a sleeve."""
    structure, at = plant.structure, float(segments.hinges[i])
    for number, (position, mass) in enumerate(structure.masses):
        if segments.segment_at(position or 0.0) == i:
            _add_mass(body, f"mass {number + 1}", (position or 0.0) - at, mass, structure)
    for number, absorber in enumerate(structure.absorbers):
        if segments.segment_at(absorber.position or 0.0) == i:
            hung = _add_mass(body, f"absorber {number + 1}", (absorber.position or 0.0) - at, absorber.mass, structure)
            slide = hung.add_joint(name=f"absorber {number + 1}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1])
            slide.stiffness[0], slide.damping[0] = absorber.coefficients
    for contact in plant.contacts if settings.native_contact else ():
        if segments.segment_at(contact.position or 0.0) == i:
            add_stops(spec, body, contact, (contact.position or 0.0) - at, structure.diameter / 2)


def to_xml(spec: Any) -> str:
    """The model as a file for any MuJoCo viewer, with words in it."""
    bounces = not spec.option.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    head = (
        "<!-- A cantilever that rests in sleeves with clearance, as a chain of rigid segments with sprung hinges.\n"
        "     SI units, x along the beam from the clamp, z up. Gravity bends it; the forces of grease and other\n"
        "     effects are computed outside of this file, and so are those of the sleeves"
        + (
            " in the testbed's own runs;\n     here a ball on the beam meets a plane on each side. -->\n"
            if bounces
            else ",\n     so that here the beam falls through them. -->\n"
        )
    )
    text = re.sub(r"(<mujoco[^>]*>\n)", lambda found: found.group(1) + head, spec.to_xml(), count=1)
    return text.replace(
        "  <worldbody>", "  <!-- Sleeves stand still; each segment hangs on the one before. -->\n  <worldbody>"
    )


def is_stiff(clamp_stiffness: float, structure: Structure, segments: Segments) -> bool:
    """Whether a clamp that turns is stiffer than the chain's own hinges, and would shorten the stable step."""
    return structure.bending_stiffness / segments.h < clamp_stiffness < inf


def _add_hinge(body: Any, name: str, stiffness: float, damping: float, settings: ChainSettings) -> None:
    """A sprung hinge; the engine damps implicitly, half a step late, which the armature makes good (docs/theory.md)."""
    axes = {name: UPWARDS, sway_of(name): SIDEWAYS} if settings.spatial else {name: UPWARDS}
    for joint, axis in axes.items():
        hinge = body.add_joint(name=joint, type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis)
        hinge.stiffness[0], hinge.damping[0] = stiffness, damping
        hinge.armature = max(0.0, settings.newmark * settings.step**2 * stiffness - 0.5 * settings.step * damping)


def sway_of(hinge: str) -> str:
    """Name of the joint that turns sideways what a hinge lifts."""
    return f"{hinge} sideways"


def _give_mass(
    body: Any, structure: Structure, span: tuple[float, float], hinge: float, settings: ChainSettings
) -> None:
    """The inertia of a stretch of beam, from and to in m beyond the body's hinge, and its look."""
    length = span[1] - span[0]
    mass = structure.line_mass * length
    across = mass * length**2 / 12.0
    if settings.rotary_inertia:
        across += mass * structure.diameter**2 / 16.0
    body.mass, body.ipos = mass, [0.5 * sum(span), 0.0, 0.0]
    about = max(THIN, mass * structure.diameter**2 / 8.0) if settings.rotary_inertia else THIN
    body.inertia = [min(about, 2.0 * across), across, across]  # no body has more about one axis than about two others
    body.explicitinertial = True
    _draw(body, structure, span[0] if hinge else 0.0, span[1])


def _draw(body: Any, structure: Structure, start: float, end: float) -> None:
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        fromto=[start, 0.0, 0.0, end, 0.0, 0.0],
        size=[0.5 * structure.diameter, 0.0, 0.0],
        mass=0.0,
        contype=0,
        conaffinity=0,
        rgba=BEAM_COLOUR,
    )


def _add_mass(body: Any, name: str, place: float, mass: float, structure: Structure) -> Any:
    hung = body.add_body(name=name, pos=[place, 0.0, 0.0])
    hung.mass, hung.ipos, hung.inertia, hung.explicitinertial = mass, [0.0, 0.0, 0.0], [THIN, THIN, THIN], True
    size = 0.8 * structure.diameter
    hung.add_geom(
        type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[size, 0, 0], mass=0.0, contype=0, conaffinity=0, rgba=MASS_COLOUR
    )
    return hung


def _add_sleeve(spec: Any, name: str, position: float, inner: float) -> None:
    ring = sleeve_mesh(inner)
    mesh = spec.add_mesh(name=name)
    mesh.uservert, mesh.userface = np.asarray(ring.vertices).ravel(), np.asarray(ring.faces).ravel()
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_EXACT
    body = spec.worldbody.add_body(name=name, pos=[position, 0.0, 0.0])
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        contype=0,
        conaffinity=0,
        density=SLEEVE_DENSITY,
        rgba=SLEEVE_COLOUR,
    )


SLEEVE_DENSITY = 7850.0
"""kg/m^3, steel."""
