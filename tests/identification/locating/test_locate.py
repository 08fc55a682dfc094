"""One missing force: its place, its course in time, and what is told where there is none or where it is no force."""

from dataclasses import replace

import numpy as np
import pytest

from identification.hypothesis import Hypothesis
from identification.locating.beside import runs_beside
from identification.locating.locate import locate
from models.band_limit import record_channels
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.local_damage import LocalDamage
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm
from models.simulate import Settings
from tests.identification.trial_records import FS, REFERENCE, evaluator_of, measured, moved, multisine, oscillator

LENGTH, N = REFERENCE.structure.length, 8192
SLEEVE_1, SLEEVE_2 = Place(sleeve="sleeve 1", position=0.45), Place(sleeve="sleeve 2", position=1.0)
DB_45 = 10.0 ** (-45.0 / 20.0)


def records_of(truth, levels=(6.0, 20.0), seed=0, noise=0.005):
    return [
        measured(truth, multisine(N, rms=rms, high=300.0, seed=seed + i), noise=noise, name=f"test {i}", seed=seed + i)
        for i, rms in enumerate(levels)
    ]


def located(*effects, seed=0, **changes):
    evaluator = evaluator_of(*records_of(Hypothesis(REFERENCE, effects=effects), seed=seed, **changes))
    return locate(evaluator, Hypothesis(REFERENCE))


def test_on_a_linear_beam_a_known_force_is_found_and_followed():
    rig = REFERENCE.model_copy(update={"sleeves": ()})
    rubbing = CoulombFriction(Place(position=0.62), 2.0, 1e-3)
    truth = Hypothesis(rig, effects=(rubbing,))
    pairs = records_of(truth, noise=DB_45)

    found = locate(evaluator_of(*pairs), Hypothesis(rig))

    assert found.enough
    assert found.place == pytest.approx(0.62, abs=LENGTH / 30)
    for (record, _), force in zip(pairs, found.forces, strict=True):
        response = truth.simulated(record, Settings(trace=True))
        true = record_channels(response.trace.law_forces, response.steps_per_sample, N, FS)[0]
        # Accelerometers tell no slow force: both are compared above the beam's first frequency and below 0.35 fs.
        spectra = [np.fft.rfft(row)[60 : int(0.35 * N)] for row in (force.force, true)]
        assert abs(np.vdot(*spectra)) / np.prod([np.linalg.norm(row) for row in spectra]) > 0.99


def test_records_of_some_sensors_in_another_order_tell_the_place_by_those_in_common():
    pairs = records_of(Hypothesis(REFERENCE, effects=(CoulombFriction(SLEEVE_2, 2.0, 1e-3),)))
    first, second = evaluator_of(*pairs).timed
    names = first.record.sensors
    evaluator = evaluator_of(*pairs).with_targets([first.without(names[0]), second.only([*names[::-1]][:-2])])

    found = locate(evaluator, Hypothesis(REFERENCE))

    assert found.sleeve == "sleeve 2"
    assert tuple(channel.sensor for channel in found.channels) == names[2:]


CASES = {
    "rubbing at a sleeve": (CoulombFriction(SLEEVE_2, 2.0, 1e-3), "velocity", "odd, of the same size"),
    "rubbing elsewhere": (CoulombFriction(Place(position=0.8), 2.0, 1e-3), "velocity", "odd, of the same size"),
    "a hardening spring at a sleeve": (CubicStiffness(SLEEVE_2, 1e11), "displacement", "hardening"),
    "a resistance at a sleeve": (SqueezeFilm(SLEEVE_1, 18.5), "velocity", "against it, odd"),
    "a mass": (PointMass(Place(position=1.2), 0.05), "acceleration", "odd, in proportion"),
}


@pytest.mark.parametrize("case", CASES)
def test_place_and_shape_of_what_is_missing(case):
    effect, quantity, words = CASES[case]

    found = located(effect)

    assert found.place == pytest.approx(effect.place.position, abs=0.05 * LENGTH)
    assert found.sleeve == effect.place.sleeve
    # A spring moves the beam at rest against the other sleeve, which no accelerometer tells: a little is left.
    assert found.enough or (found.share > 0.9 and isinstance(effect, CubicStiffness))
    assert found.shape.words[0].startswith(f"it follows the {quantity} (")
    assert words in next(text for text in found.shape.words if text.startswith(f"over the {quantity}:"))


@pytest.mark.parametrize(("sensor", "gain"), [("P6", 1.2), ("P4", -1.0)])
def test_a_wrong_channel_is_told_as_one(sensor, gain):
    found = located(SensorGain(Place(sensor=sensor), gain))

    assert (found.sensor, found.place, found.enough) == (sensor, None, True)
    assert found.words.startswith(f"in the measurement: without {sensor}")


def test_a_loss_of_stiffness_is_not_one_point_force_but_lies_near():
    found = located(LocalDamage(Place(position=0.6), loss=0.3))

    assert not found.enough
    assert found.words.startswith("not one point force")
    assert found.place == pytest.approx(0.6, abs=0.05 * LENGTH)


def test_two_places_are_not_one():
    found = located(CoulombFriction(Place(position=0.3), 4.0, 1e-3), CoulombFriction(Place(position=1.2), 4.0, 1e-3))

    assert not found.enough


@pytest.mark.parametrize("seed", range(4))
def test_where_nothing_is_missing_no_place_is_told(seed):
    found = located(seed=10 * seed)

    assert (found.place, found.sensor, found.shape) == (None, None, None)
    assert found.words.startswith("no force is missing")


def test_what_the_tolerances_allow_is_no_missing_force():
    # Small enough that the response changes in proportion; it still is eight times the noise.
    evaluator = evaluator_of(*records_of(moved(REFERENCE, 0.1, 0.0, 1.0, *[0.0] * 6)))

    found = locate(evaluator, Hypothesis(REFERENCE))

    plain = [np.mean(np.abs(run.gap.T) ** 2 / run.variance) for run in runs_beside(evaluator, Hypothesis(REFERENCE))]
    assert np.sqrt(np.mean(plain)) > 5.0
    assert found.place is None
    assert found.words.startswith("no place is told: the model misses the records by ")


def test_without_a_beam_or_a_second_channel_no_place_is_looked_for():
    rig = oscillator()
    pair = measured(Hypothesis(rig), multisine(2048))
    assert locate(evaluator_of(pair), Hypothesis(rig)) is None

    record, noise = measured(Hypothesis(REFERENCE), multisine(2048))
    one = replace(record, sensors=record.sensors[:1], responses=record.responses[:1])
    single = replace(noise, sensors=noise.sensors[:1])
    assert locate(evaluator_of((one, single)), Hypothesis(REFERENCE)) is None


def test_given_runs_are_used():
    pair = measured(Hypothesis(REFERENCE), multisine(2048))
    evaluator = evaluator_of(pair)

    found = locate(evaluator, Hypothesis(REFERENCE), runs_beside(evaluator, Hypothesis(REFERENCE)))

    # The noise of the laws' forces is taken a little too large: it knows nothing of the channels'.
    assert found.nothing == pytest.approx(1.0, abs=0.1)
