"""Motion by the modal model, which is fast: for the search of sizes and levels, never for a record."""

from collections.abc import Iterable, Mapping

import numpy as np

from identification.metrics import nrmse
from models.arrays import FloatArray
from models.effects import Effect
from models.plant import build_plant
from models.record import Record
from models.rig import Beam, Rig, Sensor
from models.simulate import Settings, simulate

NUDGE = 1e-6
"""Relative change of Young's modulus by whose growth a motion is called hard to predict."""


SHAKEN = 0.007
"""Of the force's rms."""


def blank_record(rig: Rig, force: FloatArray, fs: float) -> Record:
    """A record of which only the force's channel is known.

    Args:
        rig: whose sensors it has.
        force: (N,) as read, N.
        fs: Hz.
    """
    names = tuple(sensor.name for sensor in rig.sensors)
    return Record("to be predicted", fs, force, names, np.zeros((len(names), len(force))))


def channels_of(
    rig: Rig,
    force: FloatArray,
    fs: float,
    effects: Iterable[Effect] = (),
    free: Mapping[str, float] | None = None,
) -> FloatArray:
    """(n_sensors, N) what the channels read.

    Args:
        rig: as built.
        force: (N,) as its channel reads it, N.
        fs: Hz.
        effects: besides those of the rig.
        free: numbers that the record has for itself (a phase).

    Raises:
        DivergenceError: the motion left the finite numbers.
    """
    return simulate(build_plant(rig, effects), blank_record(rig, force, fs), free=free).channels


def impacts(rig: Rig, force: FloatArray, fs: float) -> int:
    """How often a sleeve is met.

    Args:
        rig: as its owner describes it.
        force: (N,) N.
        fs: Hz.
    """
    traced = simulate(build_plant(rig), blank_record(rig, force, fs), Settings(trace=True))
    assert traced.trace is not None
    touching = traced.trace.contact_forces != 0.0
    return int(np.count_nonzero(touching[:, 1:] & ~touching[:, :-1]))


def growth(rig: Rig, force: FloatArray, fs: float) -> float:
    """Relative change of the channels per relative change of Young's modulus.

    Args:
        rig: as its owner describes it.
        force: (N,) N.
        fs: Hz.
    """
    assert isinstance(rig.structure, Beam)
    near = rig.with_values({"youngs_modulus": rig.structure.youngs_modulus * (1.0 + NUDGE)})
    return _changed(rig, channels_of(near, force, fs), channels_of(rig, force, fs)) / NUDGE


def amplification(rig: Rig, force: FloatArray, fs: float, rng: np.random.Generator) -> float:
    """Relative change of the channels per relative change of the force by white noise as loud as a sensor's.

    Unlike ``growth`` it sees what a finite change does: a motion that settles in another sleeve, a sleeve just missed.

    Args:
        rig: as its owner describes it.
        force: (N,) N.
        fs: Hz.
        rng: draws the noise.
    """
    shaken = force + SHAKEN * float(np.std(force)) * rng.standard_normal(len(force))
    return _changed(rig, channels_of(rig, shaken, fs), channels_of(rig, force, fs)) / SHAKEN


def _changed(rig: Rig, channels: FloatArray, before: FloatArray) -> float:
    """Relative change of all channels."""
    return nrmse(channels, before, [sensor.quantity for sensor in rig.sensors])


def watched(rig: Rig, position: float) -> Rig:
    """The rig with displacement and velocity sensors at a place in place of its own.

    Args:
        rig: a beam.
        position: m from the clamp.
    """
    pair = [Sensor(name=quantity, position=position, quantity=quantity) for quantity in ("displacement", "velocity")]
    return rig.model_copy(update={"sensors": tuple(pair)})
