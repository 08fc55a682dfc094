from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.beam.clamped_free import clamped_free_modes, wave_numbers
from models.effects import EFFECTS, Place
from models.errors import DivergenceError
from models.fine import FineSettings, fine_response
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Excitation, Sensor
from models.rig_file import read_rig
from models.simulate import Settings, simulate
from models.structure import Structure

FS = 2048.0
BEAM = Structure(1.469, 0.02, 1649.3, 2.466, (30.0, 4e-6), 9.81)
QUANTITIES = ("acceleration", "velocity", "displacement", "angular_velocity")


@pytest.fixture(scope="module")
def rig():
    return read_rig(Path(__file__).parents[2] / "data/reference_rig.toml")


def noise_force(n, rms, low, high, seed=0):
    """Random force between two frequencies that begins and ends at 0."""
    rng = np.random.default_rng(seed)
    freq = np.fft.rfftfreq(n, 1 / FS)
    lines = (freq >= low) & (freq <= high)
    force = np.fft.irfft(lines * np.exp(2j * np.pi * rng.random(len(freq))), n)
    force *= np.clip(np.minimum(np.arange(n), n - 1 - np.arange(n)) / 200.0, 0.0, 1.0)
    return rms * force / force.std()


def relative_error(channels, others):
    return np.linalg.norm(channels - others) / np.linalg.norm(others)


def sensors_at(position, quantities=QUANTITIES):
    return tuple(Sensor(name=quantity, position=position, quantity=quantity) for quantity in quantities)


def test_a_beam_without_sleeves_answers_with_its_frequency_response():
    excitation = Excitation(position=1.3, quantity="force")
    plant = Plant(BEAM, (), (), excitation, sensors_at(0.83), ())
    n = 4096
    force = np.zeros(n)
    force[:800] = np.sin(np.pi * np.arange(800) / 800) ** 4 * noise_force(800, 5.0, 5, 600)
    channels = fine_response(plant, force, FS, FineSettings(n_elements=80))
    n_modes, length = 60, BEAM.length
    freq = np.fft.rfftfreq(n, 1 / FS)
    omega = 2 * np.pi * freq
    shapes = [
        clamped_free_modes(np.array([x / length]), n_modes, d)[0] / length**d
        for x, d in ((1.3, 0), (0.83, 0), (0.83, 1))
    ]
    square = (wave_numbers(n_modes) / length) ** 4 * BEAM.bending_stiffness / BEAM.line_mass
    damping = BEAM.rayleigh[0] + BEAM.rayleigh[1] * square
    receptance = 1.0 / (square - omega[:, None] ** 2 + 1j * omega[:, None] * damping) / (BEAM.line_mass * length)
    deflection, slope = ((shapes[0] * shape * receptance).sum(axis=1) for shape in shapes[1:])
    spectra = [(1j * omega) ** 2 * deflection, 1j * omega * deflection, deflection, 1j * omega * slope]
    spectrum = np.fft.rfft(force)
    for channel, response in zip(channels, spectra, strict=True):
        exact = np.fft.irfft(response * spectrum, n)
        # What 80 elements and 16 steps a sample leave.
        assert relative_error(channel, exact) < 1e-4


def test_halving_the_step_and_doubling_the_mesh_changes_impacts_by_less_than_half_a_thousandth(rig):
    plant, force = build_plant(rig), noise_force(2048, 8.0, 5, 300)
    usual = fine_response(plant, force, FS)
    finer = fine_response(plant, force, FS, FineSettings(n_elements=80, steps_per_sample=32, bend_tolerance=1e-3))
    assert relative_error(usual, finer) < 5e-4


def test_the_modal_model_agrees_where_beam_and_sleeves_meet(rig):
    plant, force = build_plant(rig), noise_force(2048, 8.0, 5, 300, seed=3)
    names = tuple(sensor.name for sensor in plant.sensors)
    record = Record("virtual", FS, force, names, np.zeros((len(names), len(force))))
    modal = simulate(plant, record, Settings(n_modes=20, steps_per_sample=32)).channels
    # Two bases and two integrators; both are converged to some 3e-4 here.
    assert relative_error(modal, fine_response(plant, force, FS)) < 1e-3


@pytest.mark.parametrize("quantity", ["base_acceleration", "base_velocity", "base_displacement"])
def test_a_driven_base_is_the_weight_of_the_beam_turned_round(quantity):
    time = np.arange(2048) / FS
    freq = 2 * np.pi * 11.0
    window = np.where(time < 0.5, np.sin(2 * np.pi * time) ** 4, 0.0)
    motion = {"base_displacement": 1e-4 * window * np.sin(freq * time)}
    spectrum, omega = np.fft.rfft(motion["base_displacement"]), 2j * np.pi * np.fft.rfftfreq(2048, 1 / FS)
    motion["base_velocity"], motion["base_acceleration"] = (np.fft.irfft(omega**k * spectrum) for k in (1, 2))
    sensors = sensors_at(1.1)
    plant = Plant(replace(BEAM, gravity=0.0), (), (), Excitation(quantity=quantity), sensors, ())
    channels = fine_response(plant, motion[quantity], FS)
    n_modes, length, square = 60, BEAM.length, (wave_numbers(60) / BEAM.length) ** 4
    square = square * BEAM.bending_stiffness / BEAM.line_mass
    place, mean = clamped_free_modes(np.array([1.1 / length]), n_modes)[0], mean_of_modes(n_modes)
    damping = BEAM.rayleigh[0] + BEAM.rayleigh[1] * square
    relative = (place * mean * -(omega[:, None] ** 2) / (square + omega[:, None] ** 2 + omega[:, None] * damping)).sum(
        axis=1
    )
    exact = [np.fft.irfft(omega**k * (1.0 + relative) * spectrum) for k in (2, 1, 0)]
    for channel, expected in zip(channels, exact, strict=False):
        # exp(-15 / 2) of the first mode's ringing is left when the record ends and wraps around.
        assert relative_error(channel, expected) < 1e-3


def mean_of_modes(n):
    x = (np.arange(20000) + 0.5) / 20000
    return clamped_free_modes(x, n).mean(axis=0)


def test_a_record_begins_at_rest_and_nothing_moves_without_a_force(rig):
    channels = fine_response(build_plant(rig), np.zeros(256), FS)
    assert np.abs(channels).max() < 1e-7  # m/s^2, from the rounding of the state at rest


def test_effects_of_the_measurement_change_channels_but_not_the_true_force(rig):
    force = noise_force(512, 8.0, 5, 300)
    plain = fine_response(build_plant(rig), force, FS)
    inverted = EFFECTS["sensor_gain"](Place(sensor="P3"), gain=-1.0)
    read_high = EFFECTS["force_gain"](Place(), gain=1.5)
    changed = fine_response(build_plant(rig, [inverted, read_high]), force, FS)
    np.testing.assert_array_equal(changed[2], -plain[2])
    np.testing.assert_array_equal(np.delete(changed, 2, axis=0), np.delete(plain, 2, axis=0))


def test_a_structure_that_feeds_itself_is_told_when_it_flew_apart(rig):
    plant = build_plant(rig)
    plant = replace(plant, contacts=(), structure=plant.structure.with_dashpot(1.0, -5000.0))
    with pytest.raises(DivergenceError, match=r"grew without bound 0\.\d+ s after the start; .*negative stiffness"):
        fine_response(plant, noise_force(512, 8.0, 5, 300), FS)
