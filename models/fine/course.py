"""What drives the plant between the samples: force and base motion with their slopes at every whole step."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from models.arrays import FloatArray
from models.band_limit import raise_rate
from models.plant import Plant
from models.rig import ExcitationQuantity

DERIVATIVES: dict[ExcitationQuantity, int] = {"base_displacement": 0, "base_velocity": 1, "base_acceleration": 2}
"""How often the base's displacement has been differentiated in the excitation."""

JERK = 3


class Course(NamedTuple):
    """What the compiled stepper knows beforehand, at every whole step where it has M columns.

    Attributes:
        inputs: (n_inputs, M) known inputs.
        slopes: (n_inputs, M) their time derivatives.
        base: (4, M) of ``base_motion``, or (4, 0).
        absolute: (n_ports,) 1 where the port reads absolute motion.
        at_rest: (n_ports,) q at rest.
        held: (n_ports,) port forces at rest, already balanced.
        force_tolerance: N, where Newton's iteration ends.
        bend_tolerance: N, how far a force may leave the straight line through the stages.
    """

    inputs: FloatArray
    slopes: FloatArray
    base: FloatArray
    absolute: FloatArray
    at_rest: FloatArray
    held: FloatArray
    force_tolerance: float
    bend_tolerance: float


def applied_force(plant: Plant, excitation: FloatArray, fs: float, factor: int) -> FloatArray:
    """(2, N factor) force and its time derivative, N and N/s; 0 where something else drives the plant.

    Args:
        plant: whose excitation says what the signal is.
        excitation: (N,) at fs.
        fs: Hz.
        factor: whole steps per sample.
    """
    if plant.excitation is None or plant.excitation.quantity != "force":
        return np.zeros((2, len(excitation) * factor))
    return np.stack([raise_rate(excitation, factor), raise_rate(excitation, factor, derivative=1) * fs])


def base_motion(plant: Plant, excitation: FloatArray, fs: float, factor: int, free: Mapping[str, float]) -> FloatArray:
    """(4, N factor) displacement, velocity, acceleration and jerk of the base; (4, 0) where it stands still.

    Args:
        plant: whose excitation or effects move the base.
        excitation: (N,) at fs.
        fs: Hz.
        factor: whole steps per sample.
        free: the record's own parameters of the effects.
    """
    h = 1.0 / (fs * factor)
    time = h * np.arange(len(excitation) * factor, dtype=float)
    motions = []
    if plant.excitation is not None and plant.excitation.quantity != "force":
        known = DERIVATIVES[plant.excitation.quantity]
        rows = [raise_rate(excitation, factor, derivative=k) * fs**k for k in range(JERK - known + 1)]
        motions.append(_integrated(rows, h))
    for effect in plant.effects:
        acceleration = effect.base_acceleration(time, free)
        if acceleration is not None:
            motions.append(_integrated([acceleration, CubicSpline(time, acceleration)(time, 1)], h))
    return np.sum(motions, axis=0) if motions else np.zeros((JERK + 1, 0))


def _integrated(rows: list[FloatArray], h: float) -> FloatArray:
    """(4, M) with what lies below the lowest known derivative integrated from rest, each by the cubic of its slope."""
    while len(rows) <= JERK:
        values, slopes = rows[0], rows[1]
        pieces = 0.5 * h * (values[:-1] + values[1:]) + h**2 / 12.0 * (slopes[:-1] - slopes[1:])
        rows = [np.concatenate([[0.0], np.cumsum(pieces)]), *rows]
    return np.stack(rows)
