"""The screening: what the rig's numbers explain gains nothing, and a linear effect is sized exactly."""

import numpy as np
import pytest
from test_fit import Number
from trial_records import FS, REFERENCE, evaluator_of, measured, multisine, oscillator

from identification import screen as screening
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.screen import LARGEST_FACTOR, PLACES_TO_SIZE, Projection, Suspect, promising, screen, survey
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_mass import PointMass
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_position import SensorPosition
from models.effects.youngs_modulus import YoungsModulus
from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant

RNG = np.random.default_rng(1)
ROWS, RESIDUAL = RNG.standard_normal((3, 60)), RNG.standard_normal(60)


def base_of(residual=RESIDUAL, *, prior=False):
    unknowns = tuple(Number(name, prior=prior) for name in "abc")
    chi2 = float(residual @ residual)
    return Fit(Hypothesis(oscillator()), unknowns, chi2, 0.0, len(residual), residual, ROWS, np.eye(3))


def test_what_the_fits_unknowns_could_do_gains_nothing():
    change = ROWS.T @ np.array([0.3, -1.0, 0.7])

    assert Projection(base_of()).gain(change) == (0.0, 1.0)


def test_what_the_prior_forbids_the_unknowns_gains_something():
    change = ROWS.T @ np.array([0.3, -1.0, 0.7])

    gain, _ = Projection(base_of(-change, prior=True)).gain(change)

    # The numbers themselves pay the prior for it; the effect does not.
    assert 0.0 < gain < 0.3**2 + 1.0 + 0.7**2


@pytest.mark.parametrize("prior", [False, True])
def test_the_gain_is_that_of_least_squares_with_one_more_column(prior):
    own = RNG.standard_normal(60)
    residual = -1.3 * own + ROWS.T @ np.array([1.0, 0.0, 2.0]) + 0.1 * RESIDUAL
    damped = np.vstack([ROWS.T, prior * np.eye(3)])
    right = np.concatenate([residual, np.zeros(3)])
    column = np.concatenate([own, np.zeros(3)])[:, None]

    def least(matrix):
        solution = np.linalg.lstsq(matrix, -right, rcond=None)[0]
        return np.sum((matrix @ solution + right) ** 2), solution[-1]

    gain, factor = Projection(base_of(residual, prior=prior)).gain(own)

    assert gain == pytest.approx(least(damped)[0] - least(np.hstack([damped, column]))[0])
    assert factor == pytest.approx(least(np.hstack([damped, column]))[1])


def test_a_size_is_believed_only_within_its_range():
    _, factor = Projection(base_of(-50.0 * RESIDUAL)).gain(RESIDUAL)

    assert factor == LARGEST_FACTOR


@pytest.fixture(scope="module")
def misread():
    """A beam whose sensor P4 reads four fifths, calibrated."""
    truth = Hypothesis(REFERENCE, effects=(SensorGain(Place(sensor="P4"), gain=0.8),))
    evaluator = evaluator_of(measured(truth, multisine(2048, rms=2.0)))
    return evaluator, fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE), max_iterations=3)


def test_the_gain_of_a_sensor_is_found_exactly(misread):
    told = []

    first, *others = screen(*misread, {"sensor_gain": SensorGain}, told.append)

    assert first.effect.place == Place(sensor="P4")
    # The rig's numbers moved a little to please the wrong channel; linear in the gain, so the noise is the rest.
    assert first.effect.gain == pytest.approx(0.8, abs=0.01)
    assert first.gain > 20.0 * max(s.gain for s in others if s.effect.place != first.effect.place)
    assert "8 trials" in told[0]


def test_an_effect_that_the_tolerance_covers_is_no_suspect(misread):
    evaluator, base = misread
    registry = {"sensor_gain": SensorGain, "youngs_modulus": YoungsModulus}

    best = {}
    for suspect in screen(evaluator, base, registry, lambda _: None):
        best.setdefault(suspect.effect.kind, suspect.gain)

    assert best["youngs_modulus"] < 0.05 * best["sensor_gain"]


def test_an_effect_already_there_is_not_tried_again(misread):
    evaluator, base = misread
    known = SensorGain(Place(sensor="P4"), gain=0.8)
    there = fit(evaluator, base.hypothesis.with_effects(known), base.unknowns, max_iterations=1)

    places = {s.effect.place.sensor for s in screen(evaluator, there, {"sensor_gain": SensorGain}, lambda _: None)}

    assert places == {"P1", "P2", "P3", "P5", "P6", "P7", "P8"}


def test_the_promising_are_few_of_each_kind_and_one_a_place():
    def mass(position, gain):
        return Suspect(PointMass(Place(position=position), mass=0.1), gain)

    suspects = [mass(0.5, 9.0), mass(0.5, 8.0), mass(0.7, 7.0), mass(0.9, 6.0)]
    suspects += [Suspect(CoulombFriction(Place(), 1.0, 1e-3, against), 5.0) for against in ("ground", "base")]

    kept = promising(sorted(suspects, key=lambda s: -s.gain), 2)

    assert [s.gain for s in kept] == [9.0, 7.0, 5.0, 5.0]


def test_places_within_a_distance_are_one():
    rows = [Suspect(PointMass(Place(position=x), mass=0.1), gain) for x, gain in ((0.5, 9.0), (0.6, 8.0), (0.8, 7.0))]

    assert [s.gain for s in promising(rows, 3, apart=0.15)] == [9.0, 7.0]


def test_what_is_left_of_a_residual_is_least_squares_with_the_prior():
    prior = base_of(prior=True)
    matrix, right = np.vstack([ROWS.T, np.eye(3)]), np.concatenate([RESIDUAL, np.zeros(3)])
    solution = np.linalg.lstsq(matrix, -right, rcond=None)[0]

    assert Projection(prior).left_of(RESIDUAL) == pytest.approx(np.sum((matrix @ solution + right) ** 2))


def test_a_survey_finds_the_place_and_the_size_of_a_heavy_mass():
    """A quarter of the beam's mass: nothing is linear in it."""
    hidden = PointMass(Place(position=0.86), mass=0.9)
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(hidden,)), multisine(1024, rms=2.0)))
    start = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE), max_iterations=0)
    registry = {"point_mass": PointMass, "sensor_gain": SensorGain}

    first, *_ = survey(evaluator, start, registry, lambda _: None)
    near, *_ = survey(evaluator, start, registry, lambda _: None, near=0.86)

    assert isinstance(first.effect, PointMass)
    assert abs(first.effect.place.position - 0.86) < 0.13
    assert near.effect.place == Place(position=0.86)
    assert hidden.mass / 1.6 < near.effect.mass < hidden.mass * 1.6
    assert near.gain >= first.gain


def test_a_survey_tries_sizes_about_the_best_one_at_the_best_places(monkeypatch):
    hidden = PointMass(Place(position=0.86), mass=0.1)
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(hidden,)), multisine(1024, rms=10.0)))
    start = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE), max_iterations=0)
    tried = []

    def seen(evaluator, model, trials):
        tried.append(list(trials))
        return simulated(evaluator, model, trials)

    simulated = screening._residuals
    monkeypatch.setattr(screening, "_residuals", seen)
    found = survey(evaluator, start, {"point_mass": PointMass}, lambda _: None)

    first, smaller, about = tried
    best = promising([s for s in found if s.effect in {*first, *smaller}], PLACES_TO_SIZE)
    wanted = {(s.effect.place, round(s.effect.mass * factor, 9)) for s in best for factor in (0.46, 2.15)}
    assert {(effect.place, round(effect.mass, 9)) for effect in about} == wanted
    assert len(about) == 2 * PLACES_TO_SIZE < len(first)


@pytest.mark.parametrize("look", [survey, screen])
def test_a_mass_that_shows_as_little_as_the_noise_is_found_at_its_place(look):
    """Three grams: a trial of ordinary size shifts all resonances by more than their width, and shows nothing."""
    hidden = PointMass(Place(position=0.86), mass=0.003)
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(hidden,)), multisine(8192, rms=2.0)))
    base = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE))
    assert base.ratio < 2.0

    first, *_ = look(evaluator, base, {"point_mass": PointMass, "sensor_gain": SensorGain}, lambda _: None)

    assert first.effect.place.position == pytest.approx(0.86, abs=0.1)
    assert first.effect.mass == pytest.approx(0.003, rel=0.5)


@pytest.mark.parametrize("look", [survey, screen])
def test_an_absorber_between_two_modes_is_found_at_its_frequency(look):
    """Half way between two resonances of the rig at rest, and smaller than any trial."""
    modes = natural_modes(linearised(build_modal(build_plant(REFERENCE), band=400.0)), (), 700.0).natural_freqs
    between = float(np.sqrt(modes[1] * modes[2]))
    hidden = Absorber(Place(position=0.86), mass=0.01, frequency=between, damping_ratio=0.02)
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(hidden,)), multisine(4096, rms=2.0)))
    base = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE))

    first, *_ = look(evaluator, base, {"absorber": Absorber, "sensor_gain": SensorGain}, lambda _: None)

    assert isinstance(first.effect, Absorber)
    assert abs(np.log2(first.effect.frequency / between)) < 0.3


@pytest.mark.parametrize("look", [survey, screen])
def test_a_delay_of_many_turns_is_found_as_long_as_it_is(look):
    """No slope leads there: what moves at 200 Hz has turned four times by then."""
    hidden = SensorDelay(Place(sensor="P4"), delay=0.021)
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(hidden,)), multisine(4096, rms=2.0)))
    base = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE))
    registry = {"sensor_delay": SensorDelay, "sensor_gain": SensorGain, "sensor_position": SensorPosition}

    first, *_ = look(evaluator, base, registry, lambda _: None)

    assert first.effect.place == hidden.place
    assert isinstance(first.effect, SensorDelay)
    assert first.effect.delay == pytest.approx(hidden.delay, abs=0.5 / FS)
