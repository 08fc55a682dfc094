"""A stretch of a rig's motion, seen along the whole beam."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from models.arrays import FloatArray
from models.modal import build_modal
from models.plant import Plant
from models.rig import Sensor
from models.simulators import simulator
from models.simulators.protocol import Motion, Resolution, Trial

STATIONS = 41
"""Points of the beam that are followed."""

PERIODS = 6.0
"""Of the first natural frequency at rest on the sleeves: the length of a stretch that nobody chose."""

BEFORE = 0.2
"""Share of it that lies before the moment that matters most."""


@dataclass(frozen=True, eq=False)
class Take:
    """A stretch of motion, with the base held still.

    Attributes:
        plant: what moves.
        x: (n,) points of the beam, m from the clamp.
        time: (M,) s from the start of the record.
        deflection: (n, M) m, from the unloaded axis.
        force_time: (K,) s.
        contact_forces: (n_contacts, K) N on the beam, positive upwards.
    """

    plant: Plant
    x: FloatArray
    time: FloatArray
    deflection: FloatArray
    force_time: FloatArray
    contact_forces: FloatArray

    def frames(self, n: int) -> tuple[FloatArray, FloatArray]:
        """(n,) evenly spaced times, s, and (n, n_points) deflections then, m.

        Args:
            n: frames.
        """
        times = np.linspace(self.time[0], self.time[-1], n)
        return times, np.asarray(CubicSpline(self.time, self.deflection, axis=1)(times).T)


@dataclass(frozen=True)
class Stretch:
    """A part of a record.

    Attributes:
        first: s.
        last: s.
    """

    first: float
    last: float


def stretch_that_matters(plant: Plant, trial: Trial) -> Stretch:
    """Some periods about the hardest push of a sleeve, or the farthest motion where none pushes, by the modal model.

    Args:
        plant: a beam.
        trial: what is done to it.

    Raises:
        DivergenceError: the motion was lost.
        InputError: no state at rest.
    """
    modal = simulator("modal")
    motion = modal.run(_seen_along(plant, np.array([plant.structure.length])), trial)
    pushes = motion.pushes
    if pushes.size and np.ptp(pushes) > 0.0:
        peak = float(np.argmax(pushes.max(axis=0)) / motion.fs)
    else:
        peak = float(np.argmax(np.abs(motion.channels).max(axis=0)) / trial.fs)
    length = min(length_of_stretch(plant), trial.n_samples / trial.fs)
    first = min(max(0.0, peak - BEFORE * length), trial.n_samples / trial.fs - length)
    return Stretch(first, first + length)


def length_of_stretch(plant: Plant) -> float:
    """Seconds of a stretch that nobody chose."""
    return PERIODS / float(simulator("modal").natural_freqs(plant, 1, Resolution())[0])


def take(plant: Plant, trial: Trial, stretch: Stretch, name: str, resolution: Resolution) -> tuple[Take, Motion]:
    """A stretch of a test, moved by a simulator from the start of the record on.

    Args:
        plant: a beam.
        trial: what is done to it.
        stretch: of the record.
        name: of the simulator.
        resolution: how finely.

    Raises:
        InputError: something that the simulator cannot carry, or no state at rest.
        DivergenceError: the motion was lost.
    """
    x = np.linspace(0.0, plant.structure.length, STATIONS)
    end = min(trial.n_samples, round(stretch.last * trial.fs) + SPARE)
    shorter = replace(trial, excitation=trial.excitation[:end])
    motion = simulator(name).run(_seen_along(plant, x), shorter, resolution)
    relative = motion.channels - motion.channels[:1]  # the first station is the base
    rest = build_modal(plant, 0.0).rest_deflection(x)
    time = np.arange(end) / trial.fs
    shown = (time >= stretch.first) & (time <= stretch.last)
    force_time = np.arange(motion.contact_forces.shape[1]) / motion.fs
    felt = (force_time >= stretch.first) & (force_time <= stretch.last)
    deflection = relative[:, shown] + rest[:, None]
    return Take(plant, x, time[shown], deflection, force_time[felt], motion.contact_forces[:, felt]), motion


SPARE = 16
"""Samples after the stretch: a recorder's filter rings at the end of what it is given."""


def _seen_along(plant: Plant, x: FloatArray) -> Plant:
    """The plant with nothing but displacements along the beam to be read."""
    sensors = tuple(
        Sensor(name=f"{position:.6g} m", position=float(position), quantity="displacement") for position in x
    )
    return replace(plant, sensors=sensors)
