"""A stretch of motion along the beam is the motion that its sensors see, from where it rests."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.plant import build_plant
from models.rig import Sensor
from models.rig_file import read_rig
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial
from testbed.film.take import STATIONS, Stretch, stretch_that_matters, take

PLANT = build_plant(read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml"))
FS = 2048.0
PULSE = 40.0 * np.exp(-0.5 * ((np.arange(1024) / FS - 0.2) / 0.004) ** 2)
TRIAL = Trial(FS, PULSE)
STRETCH = Stretch(0.18, 0.26)


@pytest.fixture(scope="module")
def taken():
    return take(PLANT, TRIAL, STRETCH, "modal", Resolution())[0]


def test_the_tip_moves_as_a_sensor_there_sees_it(taken):
    tip = Sensor(name="tip", position=PLANT.structure.length, quantity="displacement")
    motion = simulator("modal").run(replace(PLANT, sensors=(tip,)), TRIAL)
    n = np.arange(len(PULSE)) / FS
    seen = motion.channels[0][(n >= STRETCH.first) & (n <= STRETCH.last)]
    assert taken.deflection[-1] - taken.deflection[-1, 0] == pytest.approx(seen - seen[0], abs=2e-6)


def test_the_clamp_holds_and_the_stretch_is_the_one_asked_for(taken):
    assert taken.deflection.shape == (STATIONS, len(taken.time))
    assert np.abs(taken.deflection[0]).max() < 1e-12
    assert taken.time[0] >= STRETCH.first
    assert taken.time[-1] <= STRETCH.last
    assert taken.force_time[0] >= STRETCH.first


def test_simulators_show_the_same_film(taken):
    """Bending, contact and rest agree; what remains is the chain's 0.1 % of frequency over the stretch."""
    other = take(PLANT, TRIAL, STRETCH, "mujoco", Resolution())[0]
    assert other.deflection == pytest.approx(taken.deflection, abs=0.01 * np.abs(taken.deflection).max())


def test_frames_are_evenly_spaced_and_pass_through_the_samples(taken):
    times, shapes = taken.frames(len(taken.time))
    assert times == pytest.approx(taken.time)
    np.testing.assert_allclose(shapes.T, taken.deflection, atol=1e-12)


def test_the_stretch_that_matters_holds_the_hardest_push():
    stretch = stretch_that_matters(PLANT, TRIAL)
    motion = simulator("modal").run(PLANT, TRIAL)
    peak = np.argmax(np.abs(motion.contact_forces).max(axis=0)) / motion.fs
    assert 0.0 <= stretch.first < peak < stretch.last <= len(PULSE) / FS


def test_a_beam_without_sleeves_is_filmed_where_it_goes_farthest():
    stretch = stretch_that_matters(replace(PLANT, contacts=(), laws=()), TRIAL)
    assert stretch.first < 0.22 < stretch.last
