"""The structure without sleeves: the same motion as the time stepper's, and closed forms on one degree of freedom."""

from dataclasses import replace

import numpy as np
import pytest

from identification.free_beam import FreeBeam, sensor_rows
from models.modal import build_modal
from models.plant import build_plant
from models.record import Record
from models.rig import Oscillator, Rig
from models.rig_file import read_rig
from models.simulate import Settings, simulate

FS, N = 2048.0, 4096
MASS, STIFFNESS, DAMPING = 2.0, 5000.0, 3.0


@pytest.fixture(scope="module")
def oscillator():
    rig = Rig(structure=Oscillator(kind="oscillator", mass=MASS, stiffness=STIFFNESS, damping=DAMPING))
    return build_modal(build_plant(rig), 0.43 * FS)


def band_limited_force():
    freq = np.fft.rfftfreq(N, 1 / FS)
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, len(freq))
    force = np.fft.irfft(np.where(freq < 400.0, np.exp(1j * phase), 0.0), N)
    return 10.0 * np.minimum(1.0, np.arange(N) / 200.0) ** 2 * force / force.std()


def test_an_oscillators_frf_is_the_textbooks_with_a_spring_added(oscillator):
    spring = 700.0
    beam = FreeBeam.of(oscillator, (None,), np.array([spring]), N, FS)

    found = beam.frf(np.vstack([beam.shapes, beam.shapes]), np.array([0.0, 2.0]), 500)[:, :, 0]

    s = 2j * np.pi * np.arange(500) * FS / N
    exact = 1.0 / (MASS * s**2 + DAMPING * s + STIFFNESS + spring)
    np.testing.assert_allclose(found[:, 0], exact, rtol=1e-9)
    np.testing.assert_allclose(found[:, 1], s**2 * exact, rtol=1e-9, atol=1e-15)


def test_free_decays_span_those_of_the_equation_of_motion(oscillator):
    beam = FreeBeam.of(oscillator, (None,), np.zeros(1), N, FS)

    decays = beam.decays(beam.shapes, np.zeros(1))[:, 0]

    rate, time = DAMPING / (2 * MASS), np.arange(N) / FS
    omega = np.sqrt(STIFFNESS / MASS - rate**2)
    exact = np.exp(-rate * time) * np.cos(omega * time + 0.3)
    fitted = decays.T @ np.linalg.lstsq(decays.T, exact, rcond=None)[0]
    np.testing.assert_allclose(fitted, exact, atol=1e-9)


@pytest.mark.parametrize("springs", [0.0, 2e4], ids=["free", "held by a spring"])
def test_a_record_from_rest_is_the_steppers(springs):
    rig = read_rig("tests/data/reference_rig.toml").model_copy(update={"sleeves": ()})
    plant = build_plant(rig)
    place = rig.excitation.position
    held = plant if springs == 0 else _with_spring(plant, place, springs)
    force = band_limited_force()
    record = Record("test", FS, force, tuple(s.name for s in rig.sensors), np.zeros((8, N)))

    expected = simulate(held, record, Settings(steps_per_sample=16)).channels
    model = build_modal(plant, 0.43 * FS)
    found = FreeBeam.of(model, (place,), np.array([springs]), N, FS).response(
        *sensor_rows(model, rig.sensors), force[None]
    )

    # The ends: the force repeated forever jumps there, and the recorder's filter sees nothing beyond.
    inside = slice(50, -50)
    error = np.linalg.norm((found - expected)[:, inside], axis=1) / np.linalg.norm(expected[:, inside], axis=1)
    assert error.max() < 2e-3


def _with_spring(plant, place, stiffness):
    return replace(plant, structure=plant.structure.with_spring(place, stiffness))
