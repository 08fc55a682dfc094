"""Exudyn: the rig as ANCF cable elements, with generalised-alpha in time."""

from math import ceil, sqrt
from typing import ClassVar

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE
from models.cable.accounts import accounted
from models.cable.build import build_cable, compliance_at
from models.cable.course import Course
from models.cable.matrices import PLANE, SPACE, Layout
from models.cable.moving import march, natural_freqs, settle
from models.plant import Plant
from models.simulators.driving import driven
from models.simulators.protocol import Motion, Resolution, Simulator, Trial, beam_limits, of_the_chain
from models.simulators.recorded import recorded
from models.structure import Structure

STEP = 5e-5
"""s; impacts of the reference rig are then within 1 % over a second, its first four frequencies within 0.05 %."""

LEAST_ELEMENTS = 12

OF_BAND, OF_CONTACT = 1.8, 0.7
"""Longest element in 1 / k, the wave number at the upper edge of the band and at the frequency of a closed contact."""

STIFF = 0.005
"""Largest product of a contact's stiffness, the compliance that it meets and step^2."""

LOAD = 1e3
"""N at which a contact's stiffness is asked for."""


class Exudyn(Simulator):
    """Absolute nodal coordinates: thin rods that may bend and stretch as far as they like."""

    name: ClassVar[str] = "exudyn"
    source: ClassVar[str] = "J. Gerstmayr, Multibody Syst. Dyn. 60 (2024) 135; J. Gerstmayr, A. A. Shabana (2006)"

    def cannot_carry(self, plant: Plant, resolution: Resolution) -> tuple[str, ...]:
        """An oscillator, an axial load, hinges, one loss factor for all modes, a drift of stiffness, laws on curvature.

        Nor rotary inertia, which cables do not have, nor a contact of its own.
        """
        return (*beam_limits(plant, resolution), *of_the_chain(resolution))

    def natural_freqs(self, plant: Plant, n: int, resolution: Resolution) -> FloatArray:
        """(n,) Hz; by default with twice as many elements as for a record."""
        cable = build_cable(plant, resolution.n_parts or 2 * LEAST_ELEMENTS, Course(), layout=_layout(resolution))
        settle(cable)
        return natural_freqs(cable, n)

    def carry_out(self, plant: Plant, trial: Trial, resolution: Resolution) -> Motion:
        """One test."""
        plant = plant.driven_at(trial.position)
        fastest = _contact_rate(plant)
        n = resolution.n_parts or n_elements(plant.structure, STOP_EDGE * trial.fs, fastest)
        factor = resolution.steps_per_sample or ceil(max(1.0 / STEP, fastest / sqrt(STIFF)) / trial.fs)
        step = 1.0 / (trial.fs * factor)
        course = Course(step, *driven(plant, trial, factor), angle=trial.angle)
        held_at = None if trial.hold is None else trial.hold.position
        cable = build_cable(plant, n, course, held_at, _layout(resolution))
        rest = settle(cable)
        if trial.hold is not None:
            course.held = trial.hold.force
            settle(cable)
        moved = march(cable, len(course.force) - 1, step)
        choices = (
            f"{len(cable.nodes) - 1} elements" + ("" if resolution.n_parts else AUTO_ELEMENTS),
            f"steps of {1e6 * step:.3g} us, {factor} per sample" + ("" if resolution.steps_per_sample else AUTO_STEP),
        )
        return recorded(plant, trial, factor, accounted(cable, moved, rest, factor), cable.ports, choices)


AUTO_ELEMENTS = ": what the waves in the band and in a closed contact ask for, and a node at ports and excitation"
AUTO_STEP = ": 50 us, less where a contact is stiff for the mass that it meets"


def n_elements(structure: Structure, band: float, contact_rate: float) -> int:
    """Elements that carry the waves of a band, Hz, and of a closed contact, rad/s."""
    omega = np.array([2.0 * np.pi * band / OF_BAND**2, contact_rate / OF_CONTACT**2])
    wave_number = np.sqrt(omega * sqrt(structure.line_mass / structure.bending_stiffness))
    return max(LEAST_ELEMENTS, ceil(structure.length * float(wave_number.max())))


def _layout(resolution: Resolution) -> Layout:
    return SPACE if resolution.spatial else PLANE


def _contact_rate(plant: Plant) -> float:
    """Rad/s of the fastest closed contact on the mass that it meets at once."""
    squares = [
        c.law.slope_under(LOAD) * compliance_at(plant, LEAST_ELEMENTS, c.position or 0.0) for c in plant.contacts
    ]
    return sqrt(max(squares, default=0.0))
