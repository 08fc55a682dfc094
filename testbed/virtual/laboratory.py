"""Carrying out the runs of an experiment: the rig as built, a simulator, sensors as bought, and records of it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.effects import EFFECTS, Effect, build_effect
from models.effects.point_mass import PointMass
from models.effects.protocol import Place
from models.errors import InputError
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Beam, Excitation, Rig, Sensor
from models.rig_checks import nearest
from models.simulators import simulator
from models.simulators.protocol import Motion, Resolution, Trial
from testbed.quantities import unit_of
from testbed.virtual.as_built import perturbed
from testbed.virtual.bought import Bought, bought
from testbed.virtual.campaign import Run, excitation_seen
from testbed.virtual.experiment import Experiment, SensorTable
from testbed.virtual.virtual_record import as_read, drawn


@dataclass(frozen=True)
class Laboratory:
    """What is really there.

    Attributes:
        rig: as its owner describes it.
        built: with its true numbers and its sensors where they really sit.
        hidden: effects that nobody mentioned, the masses of sensors among them.
        sensors: as bought, by name.
        force: the excitation's own sensor.
        seed: of noise and of what every record has for itself.
    """

    rig: Rig
    built: Rig
    hidden: tuple[Effect, ...]
    sensors: dict[str, Bought]
    force: Bought
    seed: int

    @cached_property
    def plant(self) -> Plant:
        """What moves."""
        return build_plant(self.built, self.hidden)

    def dice_of(self, number: int) -> np.random.Generator:
        """What is left to chance in the run with this number."""
        return np.random.default_rng([self.seed, 2, number])

    def at_their_ends(self, record: Record) -> list[dict[str, str | float]]:
        """The channels of a record that left their sensors' range: name, the range with its unit, the share clipped."""
        channels = [
            (self.sensors[name], self.rig.sensor(name), row)
            for name, row in zip(record.sensors, record.responses, strict=True)
        ]
        parts: list[tuple[Bought, Sensor | Excitation, FloatArray]] = [*channels]
        if record.excitation is not None and self.rig.excitation is not None:
            parts.append((self.force, self.rig.excitation, record.excitation))
        return [
            {"channel": part.name, "range": own.range, "unit": unit_of(part.quantity), "share": share}
            for own, part, row in parts
            if (share := own.share_at_end(row))
        ]

    def trial_of(self, run: Run, rng: np.random.Generator) -> Trial:
        """What is done in a run, with what every record has for itself drawn."""
        return replace(run.trial, free=drawn(self.plant, rng))


def laboratory_of(experiment: Experiment, rig: Rig) -> Laboratory:
    """The truth of an experiment.

    Args:
        experiment: as its file describes it.
        rig: as its owner describes it.

    Raises:
        InputError: a sensor or an effect that the rig does not have, or a sensor that would sit beside the beam.
    """
    rng = np.random.default_rng([experiment.seed, 1])
    tables = dict(experiment.sensors)
    common, force = tables.pop("all", None), tables.pop("excitation", None)
    _check_names(tables, rig)
    named = {s.name: s.name if s.name in tables else "all" for s in rig.sensors}
    sensors = {name: bought(tables.get(name, common), f"sensors.{table}") for name, table in named.items()}
    built = perturbed(rig, rng) if experiment.truth.perturbed else rig
    moved = [_moved(s, sensors[s.name].position_error, rig, named[s.name]) for s in rig.sensors]
    entries = enumerate(experiment.truth.effects)
    hidden = [build_effect(entry, rig, EFFECTS, f"truth.effects[{i}]") for i, entry in entries]
    if isinstance(rig.structure, Beam):
        hidden += [
            PointMass(Place(position=s.position), mass=sensors[s.name].mass)
            for s in moved
            if sensors[s.name].mass > 0.0 and s.position
        ]
    built = built.model_copy(update={"sensors": tuple(moved)})
    return Laboratory(rig, built, tuple(hidden), sensors, bought(force, "sensors.excitation"), experiment.seed)


def _moved(sensor: Sensor, error: float, rig: Rig, table: str) -> Sensor:
    """The sensor where it really sits."""
    if sensor.position is None or not isinstance(rig.structure, Beam):
        return sensor
    position = sensor.position + error
    if not 0.0 <= position <= rig.structure.length:
        raise InputError(
            f"sensors.{table}.position_error = {error:g} m puts {sensor.name} at {position:g} m",
            f"a sensor sits on the beam, 0 to {rig.structure.length:g} m",
            f"{sensor.name} is said to be at {sensor.position:g} m: make the error smaller",
        )
    return sensor.model_copy(update={"position": position})


def _check_names(tables: Mapping[str, SensorTable], rig: Rig) -> None:
    known = [sensor.name for sensor in rig.sensors]
    for name in tables:
        if name not in known:
            near = nearest(name, known)
            raise InputError(
                f"sensors.{name}",
                f"the rig's sensors are {', '.join(known)}; all is the rest of them, excitation the force's own",
                f"did you mean {near}?" if near else "name one of them, or remove it",
            )


def carry_out(
    laboratory: Laboratory, run: Run, number: int, name: str, resolution: Resolution
) -> tuple[Record, Motion]:
    """One run and its record.

    Args:
        laboratory: the truth.
        run: what is done.
        number: of the run, which its noise depends on.
        name: of the simulator.
        resolution: how finely.

    Raises:
        InputError: something that the simulator cannot carry.
        DivergenceError: the motion was lost.
    """
    rng = laboratory.dice_of(number)
    trial = laboratory.trial_of(run, rng)
    motion = simulator(name).run(laboratory.plant, trial, resolution)
    return read_by_sensors(laboratory, run, trial, motion.channels, rng), motion


def read_by_sensors(
    laboratory: Laboratory, run: Run, trial: Trial, channels: FloatArray, rng: np.random.Generator
) -> Record:
    """The record that the sensors as bought make of a run.

    Args:
        laboratory: the truth.
        run: what is done.
        trial: the same, with what every record has for itself.
        channels: (n_sensors, N) what moves, SI.
        rng: for the noise.
    """
    fs, plant = trial.fs, laboratory.plant
    responses = np.stack(
        [
            laboratory.sensors[sensor.name].reads(channel, fs, rng)
            for sensor, channel in zip(plant.sensors, excitation_seen(run, channels), strict=True)
        ]
    )
    excitation = None
    if run.driven:
        felt = record_channels(as_read(plant, trial.excitation)[None], 1, trial.n_samples, fs)[0]
        excitation = laboratory.force.reads(excitation_seen(run, felt), fs, rng)
    return Record(
        name=run.name,
        fs=fs,
        excitation=excitation,
        sensors=tuple(sensor.name for sensor in plant.sensors),
        responses=responses,
        excitation_position=trial.position,
        moving_start=not run.driven,
    )
