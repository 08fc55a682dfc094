"""Records of what is really there: finite elements, Exudyn or MuJoCo, never the modal model, and noise."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from identification.evaluate import nrmse, scored_spectrum
from models.arrays import FloatArray
from models.band_limit import record_channels
from models.effects import Effect
from models.fine import FineSettings, fine_response
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Rig, quantities_of
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial
from testbed.hidden_effects.motion import channels_of
from testbed.virtual.noise import Noise
from testbed.virtual.virtual_record import as_read, drawn

FINE = "fine"
ENGINES = (FINE, "exudyn", "mujoco")
"""In the order in which the cases take turns."""

MODEL = "modal"
"""What is diagnosed, and so never the truth of a case: with it a case is looked at before it is made."""

FINE_RATE = 16384.0
"""Steps per second of the finite elements, quartered further where a force is not smooth: impacts within 0.003 %."""


@dataclass(frozen=True)
class Truth:
    """What is really there.

    Attributes:
        built: the rig as built.
        hidden: effects that its description lacks.
        engine: of ``ENGINES``, or ``MODEL``.
        noise: of the measurement chain.
        resolution: of an engine that is asked for one.
    """

    built: Rig
    hidden: tuple[Effect, ...]
    engine: str
    noise: Noise
    resolution: Resolution = field(default_factory=Resolution)

    @property
    def plant(self) -> Plant:
        """What moves."""
        return build_plant(self.built, self.hidden)

    def by(self, engine: str, resolution: Resolution) -> "Truth":
        """The same, moved by another engine."""
        return replace(self, engine=engine, resolution=resolution)


def moved(engine: str, resolution: Resolution, plant: Plant, trial: Trial) -> FloatArray:
    """(n_sensors, N) the channels without noise.

    Args:
        engine: of ``ENGINES``, or ``MODEL``.
        resolution: where the engine is none of our finite elements, which have their own.
        plant: what moves.
        trial: what is done; what is held first, our finite elements do not let go.

    Raises:
        DivergenceError: the engine lost the motion.
        InputError: no state at rest is found.
    """
    if engine != FINE:
        return simulator(engine).run(plant, trial, resolution).channels
    settings = FineSettings(steps_per_sample=round(FINE_RATE / trial.fs), free=trial.free)
    return fine_response(plant.driven_at(trial.position), trial.excitation, trial.fs, settings)


def measure(truth: Truth, name: str, force: FloatArray, fs: float, rng: np.random.Generator) -> tuple[Record, float]:
    """A record, and the error that a perfect model driven by its measured force has on it.

    Args:
        truth: what is there.
        name: of the record.
        force: (N,) true, N.
        fs: Hz.
        rng: draws noise and what the record has for itself.
    """
    plant = truth.plant
    free = drawn(plant, rng)
    clean = moved(truth.engine, truth.resolution, plant, Trial(fs, force, free=free))
    reading = record_channels(as_read(plant, force)[None], 1, len(force), fs)[0]
    record = Record(
        name=name,
        fs=fs,
        excitation=truth.noise.on_excitation(reading, fs, rng),
        sensors=tuple(sensor.name for sensor in plant.sensors),
        responses=truth.noise.on_channels(clean, plant.sensors, fs, rng),
    )
    return record, _noise_nrmse(truth, record, clean, reading, free)


def _noise_nrmse(
    truth: Truth, record: Record, clean: FloatArray, reading: FloatArray, free: Mapping[str, float]
) -> float:
    """NRMSE that this very noise of sensors and force leaves; what the force's does, the modal model carries."""
    assert record.excitation is not None
    felt, still = (
        channels_of(truth.built, force, record.fs, truth.hidden, free) for force in (record.excitation, reading)
    )
    measured = scored_spectrum(record.responses)
    residual = scored_spectrum(felt - still) - (measured - scored_spectrum(clean))
    return nrmse(residual, measured, quantities_of(truth.built.sensors, record.sensors))
