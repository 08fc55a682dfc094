"""Random rigs and tests for the hidden-effect benchmark: all numbers differ, yet a laboratory could build each."""

from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.plant import build_plant
from models.record import Record
from models.rig import Beam, Excitation, Rig, Sensor, Sleeve
from models.simulate import Response, Settings, simulate
from testbed.virtual import random_phase_multisine

FS, N_SAMPLES, N_PERIODS = 2048.0, 16384, 4
LOW = 5.0

MATERIALS = {
    "steel": (210e9, 7850.0),
    "aluminium": (70e9, 2700.0),
    "brass": (100e9, 8500.0),
    "titanium": (114e9, 4430.0),
}
"""Young's modulus, Pa, and density, kg/m^3."""

TOLERANCES = {
    "youngs_modulus": 0.01,
    "rayleigh_damping": 0.05,
    "sleeves.clearance": 0.03,
    "sleeves.stiffness": 0.05,
    "sleeves.damping": 0.10,
}
"""Those of the reference rig."""

FEWEST_IMPACTS, MOST_IMPACTS = 30, 1200
"""Contacts made at all sleeves in a record of the higher level, 8 s."""

NUDGE, MOST_GROWTH = 1e-6, 300.0
"""A change of Young's modulus by the first may change the channels by at most the second times as much: a linear
resonance gives about 30, a chaotic record thousands."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A rig as its owner describes it and the forces of its tests.

    Attributes:
        rig: the description.
        forces: (N,) N of each record by name: two levels to learn from, a third one held out.
    """

    rig: Rig
    forces: dict[str, FloatArray]

    @property
    def training(self) -> list[str]:
        """Names of the records to learn from."""
        return [name for name in self.forces if "holdout" not in name]


def blank_record(rig: Rig, force: FloatArray) -> Record:
    """A record of which only the force is known."""
    names = tuple(sensor.name for sensor in rig.sensors)
    return Record("to be predicted", FS, force, names, np.zeros((len(names), len(force))))


def channels_of(rig: Rig, force: FloatArray, effects: tuple = ()) -> FloatArray:
    """(n_sensors, N) by the modal model, which is fast."""
    return simulate(build_plant(rig, effects), blank_record(rig, force)).channels


def draw_trial(rng: np.random.Generator) -> Trial:
    """The next random rig whose sleeves are hit and whose records can be predicted."""
    while True:
        rig = draw_rig(rng)
        high = float(rng.uniform(120.0, 350.0))
        level = find_level(rig, rng, high)
        if level is None:
            continue
        low = level * rng.uniform(0.35, 0.7)
        held = float(rng.uniform(low, level))
        forces = {name: draw_force(rng, high, rms) for name, rms in (("low", low), ("high", level), ("holdout", held))}
        if max(growth(rig, force) for force in forces.values()) <= MOST_GROWTH:
            return Trial(rig, forces)


def draw_force(rng: np.random.Generator, high: float, rms: float) -> FloatArray:
    """(N,) a multisine that repeats."""
    return random_phase_multisine(rng, FS, N_SAMPLES, N_PERIODS, LOW, high, rms)


def draw_rig(rng: np.random.Generator) -> Rig:
    """A cantilever in one or two sleeves with five to eight accelerometers."""
    beam = draw_beam(rng)
    mass = beam.density * np.pi * beam.diameter**2 / 4 * beam.length
    places = [rng.uniform(0.22, 0.45), rng.uniform(0.55, 0.8)] if rng.random() < 0.8 else [rng.uniform(0.35, 0.75)]
    sleeves = []
    for number, place in enumerate(places, start=1):
        stiffness = float(np.exp(rng.uniform(np.log(4e4), np.log(3e5))))
        ratio = float(np.exp(rng.uniform(np.log(0.03), np.log(0.25))))
        sleeves.append(
            Sleeve(
                name=f"sleeve {number}",
                position=round(place * beam.length, 3),
                clearance=round(float(np.exp(rng.uniform(np.log(5e-5), np.log(3e-4)))), 7),
                stiffness=round(stiffness, -2),
                damping=round(2.0 * ratio * float(np.sqrt(stiffness * mass / 4.0)), 1),
            )
        )
    n_sensors = int(rng.integers(5, 9))
    edges = np.linspace(0.08, 0.99, n_sensors + 1)
    at = rng.uniform(edges[:-1] + 0.1 * np.diff(edges), edges[1:] - 0.1 * np.diff(edges)) * beam.length
    sensors = [Sensor(name=f"P{i}", node=i, position=round(float(x), 3)) for i, x in enumerate(at, start=1)]
    force_at = round(float(rng.uniform(0.3, 0.97)) * beam.length, 3)
    return Rig(
        structure=beam,
        tolerances=dict(TOLERANCES),
        sleeves=tuple(sleeves),
        excitation=Excitation(name="shaker", node=100, position=force_at, quantity="force"),
        sensors=tuple(sensors),
    )


def draw_beam(rng: np.random.Generator) -> Beam:
    """A rod whose first frequency lies between 4 and 20 Hz, with modal damping from 0.4 to 2 % at the band's ends."""
    while True:
        modulus, density = MATERIALS[str(rng.choice(list(MATERIALS)))]
        length, diameter = float(rng.uniform(0.7, 2.0)), float(rng.uniform(0.01, 0.03))
        first = 1.8751**2 / length**2 * diameter / 4 * np.sqrt(modulus / density)
        if 4.0 <= first / (2 * np.pi) <= 20.0:
            break
    ratios = np.exp(rng.uniform(np.log(0.004), np.log(0.02), 2))
    top = 2 * np.pi * 600.0
    return Beam(
        kind="beam",
        length=round(length, 3),
        diameter=round(diameter, 4),
        youngs_modulus=modulus,
        density=density,
        rayleigh_damping=(round(float(2 * ratios[0] * first), 3), float(f"{2 * ratios[1] / top:.3g}")),
        gravity=9.81 if rng.random() < 0.7 else 0.0,
    )


def find_level(rig: Rig, rng: np.random.Generator, high: float) -> float | None:
    """An rms of the force, N, at which the sleeves are hit often, if there is one."""
    shape = draw_force(rng, high, 1.0)
    levels = [float(level) for level in np.geomspace(0.5, 60.0, 8)]
    for level in rng.permutation(levels)[:5]:
        if FEWEST_IMPACTS <= impacts(rig, level * shape) <= MOST_IMPACTS:
            return float(level)
    return None


def impacts(rig: Rig, force: FloatArray) -> int:
    """How often a sleeve is met."""
    traced: Response = simulate(build_plant(rig), blank_record(rig, force), Settings(trace=True))
    assert traced.trace is not None
    touching = traced.trace.contact_forces != 0.0
    return int(np.count_nonzero(touching[:, 1:] & ~touching[:, :-1]))


def growth(rig: Rig, force: FloatArray) -> float:
    """Relative change of the channels per relative change of Young's modulus."""
    modulus = rig.structure.youngs_modulus
    near = rig.with_values({"youngs_modulus": modulus * (1.0 + NUDGE)})
    channels = channels_of(rig, force)
    return float(np.linalg.norm(channels_of(near, force) - channels) / np.linalg.norm(channels) / NUDGE)


def watched(rig: Rig, position: float) -> Rig:
    """The rig with displacement and velocity sensors at a place in place of its own."""
    pair = [Sensor(name=quantity, position=position, quantity=quantity) for quantity in ("displacement", "velocity")]
    return rig.model_copy(update={"sensors": tuple(pair)})
