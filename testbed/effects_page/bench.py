"""The test on which every effect is shown: the reference rig at a low and a high level of the same multisines."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.prepare import target_of
from identification.scene import scenes
from models.arrays import FloatArray
from models.effects import Effect, Place
from models.effects.protocol import Scene, StructureKind
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.rig_file import read_rig
from models.simulate import Response, Settings, simulate
from testbed.virtual import random_phase_multisine
from testbed.virtual.virtual_record import drawn

Level = Literal["low", "high"]
LEVELS: Mapping[Level, float] = {"low": 0.3, "high": 6.0}
"""N rms: at the low level the reference rig stays on the sleeve on which it rests, at the high one it strikes both."""

FS, PERIOD, PERIODS = 1024.0, 4.0, 2
"""Hz; s; the last period is free of what the start leaves."""

BAND = (10.0, 300.0)
"""Hz."""

REALISATIONS = 8
"""Multisines of other phases, over which powers are averaged."""

SHIPPED_RIG = Path(__file__).parents[1] / "demo" / "rig.toml"
OSCILLATOR = Rig(
    structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1.07e5, damping=11.3, gravity=0.0),
    excitation=Excitation(),
    sensors=(Sensor(name="mass"),),
)
"""30 Hz and a damping ratio of 1 %, for what cannot sit on a beam."""


@dataclass(frozen=True, eq=False)
class Bench:
    """A rig and its tests.

    Attributes:
        rig: without the effect that is shown.
        records: by level, one a realisation of the multisine; the channels are those of the rig as it is.
        answers: by level, (n_realisations, n_sensors, N) channels of the rig as it is, SI.
    """

    rig: Rig
    records: Mapping[Level, tuple[Record, ...]]
    answers: Mapping[Level, FloatArray]

    def plant(self, *effects: Effect) -> Plant:
        """The rig with effects."""
        return build_plant(self.rig, effects)

    def answers_with(self, effect: Effect, realisations: int = REALISATIONS) -> Mapping[Level, FloatArray]:
        """The channels with an effect, in the shape of ``answers``.

        Args:
            effect: that is shown.
            realisations: how many of the records.

        Raises:
            DivergenceError: the motion left the finite numbers.
        """
        plant = self.plant(effect)
        return {level: _answers(plant, rows[:realisations]) for level, rows in self.records.items()}

    def traced(self, *effects: Effect) -> Response:
        """The answer to the first record of the high level, with motion and forces at the ports."""
        return _simulated(self.plant(*effects), self.records["high"][0], 0, Settings(trace=True))

    def scene(self, place: Place) -> Scene:
        """What moves at a place at the high level."""
        evaluator = Evaluator([target_of(self.records["high"][0], self.plant())], jobs=1)
        return scenes(evaluator, Hypothesis(self.rig), (place,))[place]

    def position_of(self, place: Place) -> float | None:
        """Where a place is, m from the clamp, or None."""
        return place.position if place.sensor is None else self.rig.sensor(place.sensor).position


def bench_of(structure: StructureKind = "beam") -> Bench:
    """The bench with the reference rig that ships with the project, or with an oscillator.

    Args:
        structure: that the effects act on.
    """
    rig = read_rig(SHIPPED_RIG) if structure == "beam" else OSCILLATOR
    plant = build_plant(rig)
    driven = {level: [_driven(rig, level, number) for number in range(REALISATIONS)] for level in LEVELS}
    answers = {level: _answers(plant, rows) for level, rows in driven.items()}
    records = {
        level: tuple(replace(row, responses=answer) for row, answer in zip(rows, answers[level], strict=True))
        for level, rows in driven.items()
    }
    return Bench(rig, records, answers)


def _driven(rig: Rig, level: Level, number: int) -> Record:
    n_samples = round(FS * PERIOD) * PERIODS
    rng = np.random.default_rng(number)
    force = random_phase_multisine(rng, FS, n_samples, PERIODS, *BAND, rms=LEVELS[level])
    names = tuple(sensor.name for sensor in rig.sensors)
    return Record(f"{level}_{number}", FS, force, names, np.zeros((len(names), n_samples)))


def _answers(plant: Plant, records: Sequence[Record]) -> FloatArray:
    return np.stack([_simulated(plant, record, i, Settings()).channels for i, record in enumerate(records)])


def _simulated(plant: Plant, record: Record, number: int, settings: Settings) -> Response:
    """The model's answer; what every record has for itself (a phase) is drawn by the record's number."""
    return simulate(plant, record, settings, free=drawn(plant, np.random.default_rng(number)))
