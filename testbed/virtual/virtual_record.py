"""One virtual test: the rig as built, moved by the fine model, measured with noise and recorded."""

from collections.abc import Iterable

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.effects import Effect
from models.effects.protocol import Parameter
from models.fine import FineSettings, fine_response
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Rig
from testbed.virtual.noise import Noise

READING_TOLERANCE = 1e-12


def virtual_record(
    rig: Rig,
    effects: Iterable[Effect],
    excitation: FloatArray,
    fs: float,
    noise: Noise,
    rng: np.random.Generator,
    name: str,
    settings: FineSettings | None = None,
) -> Record:
    """Carry out one virtual test from rest.

    Args:
        rig: as built (``perturbed``), with the effects its owner knows.
        effects: what is hidden besides; ``position`` of a sleeve's effect filled in, as ``build_effect`` does.
        excitation: (N,) the true excitation in its SI unit, band-limited between the samples.
        fs: sampling rate, Hz.
        noise: of the measurement chain.
        rng: draws the noise and the numbers that every record has for itself (the phase of a hum).
        name: of the record.
        settings: resolution of the truth; ``free`` numbers that it does not name are drawn.

    Raises:
        DivergenceError, InputError: see ``models.fine.fine_response``.
    """
    plant, settings = build_plant(rig, effects), settings or FineSettings()
    free = {**drawn(plant, rng), **settings.free}
    settings = FineSettings(settings.n_elements, settings.steps_per_sample, settings.bend_tolerance, free)
    channels = fine_response(plant, excitation, fs, settings)
    reading = record_channels(as_read(plant, excitation)[None], 1, len(excitation), fs)[0]
    return Record(
        name=name,
        fs=fs,
        excitation=noise.on_excitation(reading, fs, rng),
        sensors=tuple(sensor.name for sensor in plant.sensors),
        responses=noise.on_channels(channels, plant.sensors, fs, rng),
    )


def as_read(plant: Plant, excitation: FloatArray) -> FloatArray:
    """(N,) what the excitation's channel reads while the true excitation is the one given.

    Effects say the opposite, the true excitation from the channel. That relation is linear, so the reading is the
    solution of a linear equation whose matrix is never formed; for a factor it takes one iteration.

    Args:
        plant: whose effects change the channel.
        excitation: (N,) true.

    Raises:
        ArithmeticError: a channel from which the truth cannot be told.
    """

    def truth(reading: FloatArray) -> FloatArray:
        for effect in plant.effects:
            reading = effect.change_excitation(reading)
        return reading

    n = len(excitation)
    if np.array_equal(truth(excitation), excitation):
        return excitation
    reading, fault = gmres(LinearOperator((n, n), matvec=truth), excitation, rtol=READING_TOLERANCE)
    if fault:
        message = "the reading of the excitation's channel was not found from its true value"
        raise ArithmeticError(message)
    return np.asarray(reading)


def drawn(plant: Plant, rng: np.random.Generator) -> dict[str, float]:
    """A value for each of the record's own parameters, even over its bounds, or normal where it has none."""
    return {name: _draw(about, rng) for effect in plant.effects for name, about in effect.record_parameters.items()}


def _draw(about: Parameter, rng: np.random.Generator) -> float:
    if np.isfinite(about.lower) and np.isfinite(about.upper):
        return float(rng.uniform(about.lower, about.upper))
    return float(about.spread * rng.standard_normal())
