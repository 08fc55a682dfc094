import dataclasses

import numpy as np
import pytest
from a_rig_and_its_records import a_rig, noise, sensors
from scipy.signal import butter, sosfiltfilt

from models.band_limit import record_channels
from models.plant import build_plant
from models.record import Record
from models.simulate import simulate
from testbed.records.read import first_natural_freq
from testbed.records.start import starts_moving

FS = 2048.0
SECONDS = 3.0
SLEEVES = [
    {"name": "sleeve 1", "position": 0.45, "clearance": 1.5e-4, "stiffness": 1e5, "damping": 80.0},
    {"name": "sleeve 2", "position": 1.0, "clearance": 1.5e-4, "stiffness": 1e5, "damping": 80.0},
]
NOISE = 0.01
"""Of each channel's rms."""


def forces(seed):
    t = np.arange(int(SECONDS * FS)) / FS
    random = np.random.default_rng(seed)
    low_pass = butter(6, 0.6, output="sos")
    phases = random.uniform(0, 2 * np.pi, 600)
    return {
        "noise": 20 * sosfiltfilt(low_pass, random.standard_normal(len(t))),
        "multisine": sum(np.cos(2 * np.pi * f * t + phase) for f, phase in enumerate(phases, start=5)),
        "sine": 10 * np.cos(2 * np.pi * random.uniform(5, 200) * t + phases[0]),
        "sweep": 10 * np.cos(2 * np.pi * (5 + 30 * t) * t + phases[1]),
        "blow": np.where(t < 0.004, 100 * np.sin(np.pi * t / 0.004), 0.0) + 0.01 * noise(seed, len(t)),
        "late blow": np.where(np.abs(t - 0.1) < 0.002, 100 * np.cos(np.pi * (t - 0.1) / 0.004), 0.0),
        "blow after noise alone": np.where(np.abs(t - 1.5) < 0.002, 100 * np.cos(np.pi * (t - 1.5) / 0.004), 0.0),
    }


def responded(rig, excitation):
    """The rig's response from rest with noise on every channel."""
    names = tuple(sensor.name for sensor in rig.sensors)
    record = Record("run", FS, excitation, names, np.zeros((len(names), len(excitation))))
    clean = simulate(build_plant(rig), record).channels
    noisy = clean + NOISE * clean.std(axis=1)[:, None] * noise(7, *clean.shape[::-1]).reshape(clean.shape)
    return dataclasses.replace(record, responses=noisy)


def moves(rig, record, start=0):
    responses = {name: samples[start:] for name, samples in zip(record.sensors, record.responses, strict=True)}
    return starts_moving(record.excitation[start:], responses, rig, FS, first_natural_freq(rig))


@pytest.fixture(scope="module")
def records():
    rig = a_rig(sleeves=SLEEVES)
    return rig, {(kind, seed): responded(rig, force) for seed in range(2) for kind, force in forces(seed).items()}


def test_noise_that_the_recorder_filters_is_no_motion_at_the_start(records):
    rig, rows = records
    for (kind, seed), record in rows.items():
        size = record.responses.std(axis=1)
        quiet = simulate(build_plant(rig), record).channels
        heard = noise(9, *quiet.shape[::-1]).reshape(quiet.shape) * (NOISE * size)[:, None]
        filtered = quiet + record_channels(heard, 1, quiet.shape[1], FS)
        assert not moves(rig, dataclasses.replace(record, responses=filtered)), (kind, seed)


def test_records_from_rest_start_at_rest(records):
    rig, held = records
    assert [key for key, record in held.items() if moves(rig, record)] == []


def test_records_cut_out_of_others_move(records):
    """One in twenty may pass for rest: where the velocities of all four sensors happen to be small."""
    rig, held = records
    starts = np.random.default_rng(3).integers(int(0.3 * FS), int(1.5 * FS), 20)
    found = [moves(rig, record, start) for (kind, _), record in held.items() if "blow" not in kind for start in starts]
    assert np.mean(found) >= 0.95


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "angular_velocity"])
def test_displacements_and_velocities_tell_it_by_their_first_sample(quantity):
    rig = a_rig(sleeves=SLEEVES, sensors=sensors(quantity=quantity))
    record = responded(rig, forces(1)["noise"])
    assert not moves(rig, record)
    found = [moves(rig, record, start) for start in range(1000, 3000, 50)]
    # Four channels are rarely all within 5 % of their rms.
    assert np.mean(found) >= 0.9


def test_an_oscillator_hit_at_once_starts_at_rest_and_later_moves():
    rig = a_rig(
        structure={"kind": "oscillator", "mass": 3.0, "stiffness": 1200.0, "damping": 1.0},
        excitation={"name": "shaker"},
        sensors=[{"name": "P1"}],
    )
    record = responded(rig, forces(2)["sine"])
    assert not moves(rig, record)
    # One channel in one or two tones passes through rest more often than a beam's sensors do together.
    assert np.mean([moves(rig, record, start) for start in range(1000, 3000, 97)]) >= 0.7


def test_a_base_that_starts_off_its_place_moves():
    rig = a_rig(excitation={"name": "base", "quantity": "base_displacement"})
    t = np.arange(4096) / FS
    still = {name: np.zeros(4096) for name in ("P1", "P2", "P3", "P4")}
    assert starts_moving(np.cos(2 * np.pi * 5 * t), still, rig, FS, 6.7)
    assert not starts_moving(np.sin(2 * np.pi * 5 * t), still, rig, FS, 6.7)


def test_without_excitation_a_record_moves():
    rig = a_rig()
    assert starts_moving(None, {"P1": np.zeros(100)}, rig, FS, 6.7)
