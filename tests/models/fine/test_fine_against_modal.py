from dataclasses import dataclass, replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from models.effects import EFFECTS, Place
from models.effects.protocol import Effect
from models.fine import FineSettings, fine_response
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Excitation, Sensor
from models.rig_file import read_rig
from models.simulate import Settings, simulate
from models.structure import Absorber, Hinge, Structure
from testbed.virtual import random_phase_multisine

FS, N = 2048.0, 2048
FORCE = random_phase_multisine(np.random.default_rng(2), FS, N, 1, 5.0, 300.0, 8.0)
MANY_MODES = Settings(n_modes=24, steps_per_sample=32)

STRUCTURES = {
    "a clamp that turns": {"clamp_stiffness": 4e4},
    "tension": {"axial_force": 2000.0},
    "compression": {"axial_force": -400.0},
    "a hinge": {"hinges": (Hinge(0.7, 3e-5),)},
    "a mass": {"masses": ((0.8, 0.4),)},
    "a spring": {"springs": ((0.6, 3e3),)},
    "a dashpot": {"dashpots": ((1.2, 15.0),)},
    "an absorber": {"absorbers": (Absorber(1.2, 0.3, 25.0, 0.05),)},
    "a loss factor": {"loss_factor": 0.01},
    "more damping": {"damping_scale": 2.5},
}

EFFECTS_AT_A_SLEEVE = {
    "squeeze_film": {"damping": 2.0},
    "gap_offset": {"offset": 2e-4},
    "hunt_crossley": {"dissipation": 5.0},
    "coulomb_friction": {"friction_force": 2.0, "slip_velocity": 2e-3},
    "cubic_stiffness": {"stiffness": 1e11},
    "time_varying_damping": {"times": (0.0, 0.5, 1.0), "values": (80.0, 400.0, 20.0)},
}


@dataclass(frozen=True)
class Floor(Effect):
    """A floor that shakes."""

    kind = "floor"
    family = "measurement"
    source = "this test"

    def base_acceleration(self, time, free):
        return 3.0 * np.sin(2 * pi * 17.0 * time + free["phase"])


@pytest.fixture(scope="module")
def plant():
    return build_plant(read_rig(Path(__file__).parents[2] / "data/reference_rig.toml"))


def disagreement(plant, excitation=FORCE, free=None):
    names = tuple(sensor.name for sensor in plant.sensors)
    record = Record("virtual", FS, excitation, names, np.zeros((len(names), N)))
    modal = simulate(plant, record, MANY_MODES, free=free).channels
    fine = fine_response(plant, excitation, FS, FineSettings(free=free or {}))
    return np.linalg.norm(modal - fine, axis=1) / np.linalg.norm(fine, axis=1)


@pytest.mark.parametrize("changes", STRUCTURES.values(), ids=STRUCTURES)
def test_a_changed_structure_in_sleeves_is_the_same_for_both(plant, changes):
    # Two bases and two integrators, each converged to some 3e-4; resonances and impacts spread what differs.
    assert disagreement(replace(plant, structure=replace(plant.structure, **changes))).max() < 2e-3


@pytest.mark.parametrize("kind", EFFECTS_AT_A_SLEEVE)
def test_a_law_at_a_sleeve_is_the_same_for_both(kind):
    place = Place(sleeve="sleeve 2", position=1.0)
    effect = EFFECTS[kind](place, **EFFECTS_AT_A_SLEEVE[kind])
    rig = read_rig(Path(__file__).parents[2] / "data/reference_rig.toml")
    assert disagreement(build_plant(rig, [effect])).max() < 2e-3


def test_a_hysteretic_spring_is_the_same_for_both():
    effect = EFFECTS["bouc_wen"](Place(position=0.9), force=5.0, yield_displacement=5e-5, exponent=1.5)
    rig = read_rig(Path(__file__).parents[2] / "data/reference_rig.toml")
    assert disagreement(build_plant(rig, [effect])).max() < 2e-3


def test_a_floor_that_shakes_is_the_same_for_both_and_is_in_what_the_sensors_read(plant):
    sensors = tuple(
        Sensor(name=quantity, position=0.9, quantity=quantity)
        for quantity in ("acceleration", "velocity", "displacement", "angular_velocity")
    )
    shaken = replace(plant, effects=(Floor(Place()),), sensors=sensors)
    assert disagreement(shaken, free={"phase": 0.7}).max() < 2e-3
    still = fine_response(replace(plant, sensors=sensors), FORCE, FS)
    moved = fine_response(shaken, FORCE, FS, FineSettings(free={"phase": 0.7}))
    assert np.linalg.norm(moved - still) > 0.05 * np.linalg.norm(still)


def test_an_oscillator_with_an_absorber_is_the_same_for_both():
    structure = Structure(0.0, 0.0, 2e4, 3.0, (1.5, 0.0), 9.81, absorbers=(Absorber(None, 0.3, 13.0, 0.03),))
    sensors = (Sensor(name="top", quantity="acceleration"), Sensor(name="moved", quantity="displacement"))
    plant = Plant(structure, (), (), Excitation(quantity="force"), sensors, ())
    assert disagreement(plant).max() < 1e-5  # linear and resolved: only the hold of the force differs
