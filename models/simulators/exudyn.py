"""Exudyn: the rig as planar ANCF cable elements, with generalised-alpha in time."""

from math import ceil
from typing import ClassVar

import numpy as np

from models.arrays import FloatArray
from models.cable.moving import accounted, march, natural_freqs, settle
from models.cable.rig_cable import Course, build_cable
from models.cable.rig_cable import Motion as Signal
from models.plant import Plant
from models.simulators.driving import at_place, driven
from models.simulators.protocol import Motion, Resolution, Simulator, Trial, beam_limits
from models.simulators.recorded import recorded

STEP = 5e-5
"""s; the first four frequencies are then within 0.013 %."""

ELEMENTS_PER_WAVE = 0.9
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
        still = Course(lambda t: 0.0, lambda t: 0.0)  # noqa: ARG005
        cable = build_cable(plant, resolution.n_parts or 2 * LEAST_ELEMENTS, still)
        settle(cable)
        return natural_freqs(cable, n)

    def carry_out(self, plant: Plant, trial: Trial, resolution: Resolution) -> Motion:
        """One test."""
        plant = at_place(plant, trial)
        n = resolution.n_parts or LEAST_ELEMENTS
        factor = resolution.steps_per_sample or ceil(1.0 / (trial.fs * STEP))
        step = 1.0 / (trial.fs * factor)
        force, base = driven(plant, trial, factor)
        still = np.zeros(len(force)) if not base.shape[1] else base[2]
        course = Course(_signal(force, step), _signal(still, step))
        cable = build_cable(plant, n, course, None if trial.hold is None else trial.hold.position)
        rest = settle(cable)
        if trial.hold is not None:
            course.held = trial.hold.force
            settle(cable)
        q, v = march(cable, len(force) - 1, step)
        choices = (
            f"{len(cable.nodes) - 1} elements" + ("" if resolution.n_parts else AUTO_ELEMENTS),
            f"steps of {1e6 * step:.3g} us, {factor} per sample" + ("" if resolution.steps_per_sample else AUTO_STEP),
        )
        return recorded(plant, trial, factor, accounted(cable, q, v, rest, step), cable.ports, choices)


AUTO_ELEMENTS = ": twelve, and a node on every port and at the excitation"
AUTO_STEP = ": 50 us or less, where the first four frequencies are within 0.013 %"


def _signal(samples: FloatArray, step: float) -> Signal:
    """A function of time, s, through samples a step apart, straight in between."""
    values, last = samples.tolist(), len(samples) - 1

    def at(t: float) -> float:
        place = t / step
        k = min(max(int(place), 0), last - 1)
        return float(values[k] + (place - k) * (values[k + 1] - values[k]))

    return at
