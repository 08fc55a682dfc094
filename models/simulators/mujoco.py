"""MuJoCo: the rig as a chain of rigid segments with sprung hinges."""

from math import ceil, pi, sqrt
from typing import ClassVar

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE
from models.chain.mjcf import ChainSettings, build_spec, is_stiff, sway_of, to_xml
from models.chain.moving import move_chain
from models.chain.native_contact import cannot_stop
from models.chain.rig_chain import RigChain, build_chain
from models.chain.segments import Segments
from models.plant import Plant
from models.ports import Port
from models.simulators.driving import driven
from models.simulators.protocol import Motion, Resolution, Simulator, Trial, beam_limits
from models.simulators.recorded import recorded

SHARE_OF_WAVE = 0.9
"""Of a segment in 1 / k, the wave number at the upper edge of the recorder's band."""

LEAST_SEGMENTS = 16

SPARE_SEGMENTS = 10
"""More that may be taken to put attached masses where a segment speaks true."""

LIGHT = 1e-3
"""Share of the beam's mass, times its distance in h^2 from where a segment speaks true, that changes f4 by 0.02 %."""

NEWMARK = 1.0 / 12.0
"""Beta at which leapfrog's first error in time cancels (Fox and Goodwin)."""

STABLE = 2.2
"""Largest product of the step and the highest frequency, of 2.45 at this beta."""

STIFF, DAMPED = 0.05, 0.3
"""Largest products of a contact's stiffness and step^2, and of a law's damping and step, with the compliance 1 / m."""


class Mujoco(Simulator):
    """A chain of segments, stepped by the engine, with our own laws at the ports."""

    name: ClassVar[str] = "mujoco"
    source: ClassVar[str] = "E. Todorov, T. Erez, Y. Tassa, IROS (2012) 5026; docs/theory.md, section 7"

    def cannot_carry(self, plant: Plant, resolution: Resolution) -> tuple[str, ...]:
        """An oscillator, an axial load, hinges, one loss factor for all modes, a drift of stiffness, laws on curvature.

        In space, neither laws that know the plane only nor the engine's own contact between planes.
        """
        flat = ("native contact in space",) if resolution.spatial and resolution.native_contact else ()
        return (*beam_limits(plant, resolution), *flat)

    def natural_freqs(self, plant: Plant, n: int, resolution: Resolution) -> FloatArray:
        """(n,) Hz; by default the segments are those for a record at 2,048 Hz."""
        segments = resolution.n_parts or n_segments(plant, 2048.0)
        return _still(plant, segments, resolution).natural_freqs(n)

    def carry_out(self, plant: Plant, trial: Trial, resolution: Resolution) -> Motion:
        """One test."""
        plant = plant.driven_at(trial.position)
        n = resolution.n_parts or n_segments(plant, trial.fs)
        factor = resolution.steps_per_sample or ceil(1.0 / (trial.fs * largest_step(_still(plant, n, resolution))))
        step = 1.0 / (trial.fs * factor)
        settings = ChainSettings(
            step, NEWMARK, resolution.rotary_inertia, resolution.native_contact, resolution.spatial
        )
        chain = build_chain(plant, n, settings)
        force, base = driven(plant, trial, factor, bend=NEWMARK)
        hold = None if trial.hold is None else (trial.hold.position, trial.hold.force)
        motion = move_chain(chain, force, base, factor, hold, trial.angle)
        choices = (
            f"{n} segments of {1e3 * chain.segments.h:.3g} mm" + ("" if resolution.n_parts else AUTO_SEGMENTS),
            f"steps of {1e6 * step:.3g} us, {factor} per sample" + ("" if resolution.steps_per_sample else AUTO_STEP),
        )
        return recorded(plant, trial, factor, motion, chain.ports, choices)

    def viewer_file(self, plant: Plant, fs: float = 2048.0) -> str:
        """The plant as XML for any MuJoCo viewer, bouncing in its sleeves where the engine has such a contact.

        Args:
            plant: a beam with effects.
            fs: rate of the record that the segments would be chosen for, Hz.
        """
        n, native = n_segments(plant, fs), cannot_stop(plant) is None
        step = largest_step(_still(plant, n, Resolution()))
        settings = ChainSettings(step, NEWMARK, rotary_inertia=False, native_contact=native)
        return to_xml(build_spec(plant, Segments(plant.structure.length, n), settings))


def _still(plant: Plant, n: int, resolution: Resolution) -> RigChain:
    """The chain at rest on our own contacts, of which matrices are asked before a step is known."""
    return build_chain(plant, n, ChainSettings(1e-4, 0.0, resolution.rotary_inertia, spatial=resolution.spatial))


AUTO_SEGMENTS = (
    ": short enough for the shortest wave of the record's band, and so that attached masses move as they do on the beam"
)
AUTO_STEP = ": as long as the engine is stable with the chain's highest frequency and resolves laws and contacts"


def n_segments(plant: Plant, fs: float) -> int:
    """Segments that resolve the band of a record at fs, Hz, and speak true where masses are attached.

    A mass moves with its rigid segment, whose height is the beam's at 0.289 h from the segment's centre only.
    """
    structure = plant.structure
    wave_number = (2.0 * pi * STOP_EDGE * fs * sqrt(structure.line_mass / structure.bending_stiffness)) ** 0.5
    least = max(LEAST_SEGMENTS, ceil(structure.length * wave_number / SHARE_OF_WAVE))
    carried = [(at or 0.0, mass) for at, mass in structure.masses]
    carried += [(absorber.position or 0.0, absorber.mass) for absorber in structure.absorbers]

    beam = structure.line_mass * structure.length

    def fault(n: int) -> float:
        segments = Segments(structure.length, n)
        away = [(at - segments.centres[segments.segment_at(at)]) / segments.h for at, _ in carried]
        return float(sum(mass * abs(x**2 - 1.0 / 12.0) for x, (_, mass) in zip(away, carried, strict=True))) / beam

    trials = range(least, least + SPARE_SEGMENTS + 1)
    return next((n for n in trials if fault(n) < LIGHT), min(trials, key=fault))


def largest_step(chain: RigChain) -> float:
    """Longest step, s, at which the chain is stable and its laws and contacts are resolved."""
    tangent, clamp = chain.tangent, chain.plant.structure.clamp_stiffness
    if is_stiff(clamp, chain.plant.structure, chain.segments):
        tangent = tangent.copy()
        for joint in ("clamp", sway_of("clamp")) if chain.spatial else ("clamp",):
            dof = chain.model.joint(joint).dofadr[0]
            tangent[dof, dof] -= clamp  # it cannot make the step unstable
    highest = sqrt(float(np.linalg.eigvals(np.linalg.solve(chain.mass, tangent)).real.max()))
    steps = [STABLE / highest]
    for contact in chain.plant.contacts:
        port = chain.ports[chain.ports.index(Port(contact.position))]
        slope = contact.law.slope_under(1e3) * chain.compliance_of(port)
        steps.append(sqrt(STIFF / slope))
    nudge = 1e-6
    for force in chain.forces:
        assert isinstance(force.port, Port)
        at = chain.port_rest[chain.ports.index(force.port)]
        if force.contact is not None:
            dashpot = force.law(0.0, nudge, nudge, 0.0, force.values) - force.law(0.0, nudge, 0.0, 0.0, force.values)
        else:
            edges = [at, *(c.offset + s * c.clearance for c in chain.plant.contacts for s in (-1.0, 0.0, 1.0))]
            dashpot = max(
                abs(force.law(0.0, q, nudge, 0.0, force.values) - force.law(0.0, q, 0.0, 0.0, force.values))
                for q in edges
            )
        if dashpot > 0.0:
            steps.append(DAMPED * nudge / (dashpot * chain.compliance_of(force.port)))
    return min(steps)
