"""The missing force: found where it acts, as its law says, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from identification.evaluate import Evaluator, TimeTarget
from identification.hypothesis import Hypothesis
from identification.law_history import contact_along
from identification.missing_force import missing_forces
from identification.noise import estimate_noise
from models.band_limit import record_channels
from models.effects import Place
from models.effects.bouc_wen import BoucWen
from models.effects.clearance import Clearance
from models.effects.coulomb_friction import CoulombFriction
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm
from models.plant import build_plant
from models.ports import Port
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.rig_file import read_rig
from models.simulate import Settings, simulate

FS, N = 2048.0, 8192
SLEEVE_1, SLEEVE_2 = Place(sleeve="sleeve 1", position=0.45), Place(sleeve="sleeve 2", position=1.0)
NOISE = 0.005


@pytest.fixture(scope="module")
def rig():
    return read_rig("tests/data/reference_rig.toml")


def random_force(rms, low=5.0, high=400.0):
    """Sines of random phase that fill the record once: nothing repeats, and the record ends in motion."""
    freq = np.fft.rfftfreq(N, 1 / FS)
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, len(freq))
    force = np.fft.irfft(np.where((freq > low) & (freq < high), np.exp(1j * phase), 0.0), N)
    return rms * force / force.std()


def sweep_force(amplitude, low=5.0, high=400.0):
    time, length = np.arange(N) / FS, N / FS
    ratio = np.log(high / low)
    fade = np.minimum(1.0, np.minimum(time, length - time) / 0.2)
    return amplitude * fade * np.sin(2 * np.pi * low * length / ratio * np.expm1(time / length * ratio))


def trial(rig, effects, force):
    """What a test of the rig with these effects records, and the trace of what happened."""
    silent = Record("test", FS, force, tuple(s.name for s in rig.sensors), np.zeros((len(rig.sensors), N)))
    true = simulate(build_plant(rig, effects), silent, Settings(trace=True))
    sigma = NOISE * np.sqrt(np.mean(true.channels**2))
    noisy = true.channels + sigma * np.random.default_rng(2).standard_normal(true.channels.shape)
    return replace(silent, responses=noisy), true


def found_in(rig, record, effects=()):
    evaluator = Evaluator([TimeTarget.of(record, estimate_noise(record))], jobs=1)
    return {force.place: force for force in missing_forces(evaluator, Hypothesis(rig, effects=effects))}


def lacking(rig, true, place):
    """The force at a sleeve of what happened, less what the rig as given says for the same motion, as recorded."""
    trace, plant = true.trace, true.model.plant
    i = trace.ports.index(Port(place.position))
    total = -contact_along(
        next(c for c in build_plant(rig).contacts if c.position == place.position), trace.q[i], trace.v[i], trace.fs
    )
    for law, force in zip(plant.laws, trace.law_forces, strict=True):
        total += force if law.port.position == place.position else 0.0
    for contact, force in zip(plant.contacts, trace.contact_forces, strict=True):
        total += force if contact.position == place.position else 0.0
    return record_channels(total[None], true.steps_per_sample, N, FS)[0]


CASES = {
    "squeeze film, sweep": (SqueezeFilm(SLEEVE_2, damping=18.5), sweep_force(14.0)),
    "squeeze film, random": (SqueezeFilm(SLEEVE_2, damping=18.5), random_force(10.0)),
    "bouc_wen, random": (BoucWen(Place(position=1.0), 3.0, 2e-5, 1.0), random_force(10.0)),
    "friction at sleeve 1, random": (CoulombFriction(SLEEVE_1, 2.0, 1e-3), random_force(10.0)),
    "wider gap, beam off the wall": (Clearance(SLEEVE_2, clearance=2.5e-4), random_force(40.0)),
}


@pytest.mark.parametrize("case", CASES)
def test_it_follows_its_law_and_stays_away_from_the_other_sleeve(rig, case):
    effect, force = CASES[case]
    record, true = trial(rig, (effect,), force)

    found = found_in(rig, record)

    here = next(name for name, place in (("sleeve 1", 0.45), ("sleeve 2", 1.0)) if place == effect.place.position)
    other = found["sleeve 1" if here == "sleeve 2" else "sleeve 2"]
    truth = lacking(rig, true, Place(sleeve=here, position=effect.place.position))
    assert np.corrcoef(found[here].force, truth)[0, 1] > 0.9
    assert found[here].force.std() == pytest.approx(truth.std(), rel=0.15)
    assert other.force.std() < 0.15 * truth.std()


def test_the_curve_of_dry_friction_over_speed_is_its_law(rig):
    friction = CoulombFriction(SLEEVE_2, 2.0, 1e-3)
    record, _ = trial(rig, (friction,), sweep_force(14.0))

    found = found_in(rig, record)["sleeve 2"]

    sliding = np.abs(found.v) > 10 * friction.slip_velocity
    assert np.mean(found.force[sliding & (found.v > 0)]) == pytest.approx(-2.0, rel=0.1)
    assert np.mean(found.force[sliding & (found.v < 0)]) == pytest.approx(2.0, rel=0.1)


def test_nothing_is_missing_from_the_true_model(rig):
    film = SqueezeFilm(SLEEVE_2, damping=18.5)
    record, true = trial(rig, (film,), random_force(10.0))

    found = found_in(rig, record, (film,))

    truth = lacking(rig, true, SLEEVE_2)
    assert all(force.force.std() < 0.02 * truth.std() for force in found.values())


def test_an_inverted_sensor_that_the_model_knows_spoils_nothing(rig):
    film, turned = SqueezeFilm(SLEEVE_2, damping=18.5), SensorGain(Place(sensor="P6"), gain=-1.0)
    record, true = trial(rig, (film, turned), sweep_force(14.0))

    found = found_in(rig, record, (turned,))["sleeve 2"]

    assert np.corrcoef(found.force, lacking(rig, true, SLEEVE_2))[0, 1] > 0.9


def test_a_free_decay_shows_its_force_too(rig):
    friction = CoulombFriction(SLEEVE_2, 2.0, 1e-3)
    blow = np.where(np.arange(N) < 12, 400.0 * np.sin(np.pi * np.arange(N) / 12), 0.0)
    record, true = trial(rig, (friction,), blow)

    found = found_in(rig, record)["sleeve 2"]

    assert np.corrcoef(found.force, lacking(rig, true, SLEEVE_2))[0, 1] > 0.9


@pytest.mark.parametrize("stiffness", [1191.0, 0.0], ids=["sprung", "loose"])
@pytest.mark.parametrize("quantity", ["acceleration", "velocity"])
def test_an_oscillator_with_one_sensor_shows_friction_at_its_mass(stiffness, quantity):
    rig = Rig(
        structure=Oscillator(kind="oscillator", mass=3.08, stiffness=stiffness, damping=0.67),
        excitation=Excitation(quantity="force"),
        sensors=(Sensor(name="mass", quantity=quantity),),
    )
    friction = CoulombFriction(Place(), friction_force=1.0, slip_velocity=1e-3)
    record, true = trial(rig, (friction,), random_force(10.0, low=2.0, high=60.0))

    found = found_in(rig, record)["mass"]

    truth = record_channels(true.trace.law_forces, true.steps_per_sample, N, FS)[0]
    assert np.corrcoef(found.force, truth)[0, 1] > 0.9


def test_a_bare_beam_has_no_place_to_show(rig):
    bare = rig.model_copy(update={"sleeves": ()})
    record, _ = trial(bare, (), random_force(10.0))

    assert found_in(bare, record) == {}
