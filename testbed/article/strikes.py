"""Whether the rod strikes both sleeves in every test: a model of contact says nothing where none is made and broken."""

from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.excitations import random_phase_multisine
from models.plant import build_plant
from models.record import Record
from models.simulate import Settings, simulate
from testbed.article.rig import Drive, Geometry

FS, PERIOD, PERIODS = 2048.0, 4.0, 2
"""Hz; s; the second period is free of the start."""

EXCITED = (5.0, 250.0)
"""Hz, of the random-phase multisine: all four modes and what lies beyond them."""

LEVELS: dict[Drive, float] = {"table": 8.0, "force": 25.0}
"""Rms, m/s^2 and N, from which the rod is thrown off both sleeves at every clearance."""

SEED = 58
"""Of the phases."""


@dataclass(frozen=True)
class Strikes:
    """What one test does in the sleeves.

    Attributes:
        clearance: m.
        drive: which test.
        per_second: contacts that begin, at each sleeve.
        closed_share: of the time in contact, at each sleeve.
        largest_force: N, at each sleeve.
    """

    clearance: float
    drive: Drive
    per_second: tuple[float, float]
    closed_share: tuple[float, float]
    largest_force: tuple[float, float]


def strikes(geometry: Geometry, clearance: float, drive: Drive) -> Strikes:
    """One test by the modal model.

    Args:
        geometry: of the rig.
        clearance: of both sleeves, m.
        drive: which test.

    Raises:
        DivergenceError: the motion left the finite numbers.
    """
    n_samples = round(FS * PERIOD) * PERIODS
    rig, rng = geometry.rig(clearance, drive), np.random.default_rng(SEED)
    excitation = random_phase_multisine(rng, FS, n_samples, PERIODS, *EXCITED, rms=LEVELS[drive])
    names = tuple(sensor.name for sensor in rig.sensors)
    record = Record(f"{drive} {clearance:g} m", FS, excitation, names, np.zeros((len(names), n_samples)))
    trace = simulate(build_plant(rig), record, Settings(trace=True)).trace
    assert trace is not None
    forces = trace.contact_forces[:, round(PERIOD * trace.fs) :]
    closed = forces != 0.0
    begun = np.count_nonzero(closed[:, 1:] & ~closed[:, :-1], axis=1)
    seconds = forces.shape[1] / trace.fs
    return Strikes(
        clearance, drive, _pair(begun / seconds), _pair(closed.mean(axis=1)), _pair(np.abs(forces).max(axis=1))
    )


def _pair(values: FloatArray) -> tuple[float, float]:
    first, second = values.tolist()
    return first, second
