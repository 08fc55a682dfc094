"""What drives the simulators between the samples of a record."""

import numpy as np

from models.arrays import FloatArray
from models.band_limit import raise_rate
from models.fine.course import base_motion
from models.plant import Plant
from models.simulators.protocol import Trial


def driven(plant: Plant, trial: Trial, factor: int, bend: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """(M,) force, N, and (3, M) displacement, velocity and acceleration of the base, or (3, 0), at every step.

    Args:
        plant: whose excitation says what the signal is.
        trial: with the true excitation.
        factor: steps per sample.
        bend: share of h^2 times the second derivative that is added to what drives an integrator of Newmark's kind,
            its beta, so that the response is as exact in amplitude as it is in frequency.
    """
    h = 1.0 / (trial.fs * factor)
    base = base_motion(plant, trial.excitation, trial.fs, factor, trial.free)[:3]
    if plant.excitation is None or plant.excitation.quantity != "force":
        force = np.zeros(trial.n_samples * factor)
    else:
        force = raise_rate(trial.excitation, factor)
        if bend:
            force = force + bend * (h * trial.fs) ** 2 * raise_rate(trial.excitation, factor, derivative=2)
    if bend and base.shape[1]:
        base = base.copy()
        base[2] += bend * np.gradient(np.gradient(base[2]))
    return np.ascontiguousarray(force), np.ascontiguousarray(base)
