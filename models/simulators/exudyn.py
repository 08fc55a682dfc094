"""Exudyn: the rig as planar ANCF cable elements, with generalised-alpha in time."""

from math import ceil
from typing import ClassVar

from models.arrays import FloatArray
from models.cable.accounts import accounted
from models.cable.course import Course
from models.cable.moving import march, natural_freqs, settle
from models.cable.rig_cable import build_cable
from models.plant import Plant
from models.simulators.driving import at_place, driven
from models.simulators.protocol import Motion, Resolution, Simulator, Trial, beam_limits
from models.simulators.recorded import recorded

STEP = 5e-5
"""s; the first four frequencies are then within 0.013 %."""

LEAST_ELEMENTS = 12


class Exudyn(Simulator):
    """Absolute nodal coordinates: thin rods that may bend and stretch as far as they like."""

    name: ClassVar[str] = "exudyn"
    source: ClassVar[str] = "J. Gerstmayr, Multibody Syst. Dyn. 60 (2024) 135; J. Gerstmayr, A. A. Shabana (2006)"

    def cannot_carry(self, plant: Plant) -> tuple[str, ...]:
        """An oscillator, an axial load, hinges of damage, one loss factor for all modes, laws on curvature."""
        return beam_limits(plant)

    def natural_freqs(self, plant: Plant, n: int, resolution: Resolution) -> FloatArray:
        """(n,) Hz."""
        cable = build_cable(plant, resolution.n_parts or 2 * LEAST_ELEMENTS, Course())
        settle(cable)
        return natural_freqs(cable, n)

    def carry_out(self, plant: Plant, trial: Trial, resolution: Resolution) -> Motion:
        """One test."""
        plant = at_place(plant, trial)
        n = resolution.n_parts or LEAST_ELEMENTS
        factor = resolution.steps_per_sample or ceil(1.0 / (trial.fs * STEP))
        step = 1.0 / (trial.fs * factor)
        course = Course(step, *driven(plant, trial, factor))
        cable = build_cable(plant, n, course, None if trial.hold is None else trial.hold.position)
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


AUTO_ELEMENTS = ": twelve, and a node on every port and at the excitation"
AUTO_STEP = ": 50 us or less, where the first four frequencies are within 0.013 %"
