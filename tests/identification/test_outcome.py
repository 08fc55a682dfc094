"""What a person reads: numbers in their units, and groups that cannot be told apart."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, moved, multisine, oscillator

from identification.assess import score
from identification.evaluate import nrmse, scored_spectrum, whitened
from identification.fit import Fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.judge import Ranked
from identification.outcome import (
    KNOWN_TO,
    LARGEST_LOG_STD,
    PLACE_KNOWN_TO,
    UNTRIED,
    UNTRIED_BEYOND,
    UNTRIED_LATER,
    UNTRIED_LATER_BEYOND,
    UNTRIED_MISSED,
    Tried,
    added_effects,
    candidates_of,
    distinct,
    effect_estimates,
    groups_of,
    rig_estimates,
    tried,
)
from models.effects import Place
from models.effects.breathing_crack import BreathingCrack
from models.effects.contact_stiffness import ContactStiffness
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

MASS = PointMass(Place(position=0.7), mass=0.3)
DAMPING = PointDamping(Place(position=0.7), damping=2.0)
GAIN = SensorGain(Place(sensor="P3"), gain=0.5)


def fit_of(hypothesis, unknowns, std, ratio=1.0):
    n, n_data = len(unknowns), 100
    covariance = np.diag(np.broadcast_to(std, n).astype(float) ** 2)
    zeros = np.zeros((n, n_data))
    return Fit(hypothesis, tuple(unknowns), ratio**2 * n_data, 0.0, n_data, np.zeros(n_data), zeros, covariance)


def effect_fit(*effects, std=0.01, ratio=1.0):
    hypothesis = Hypothesis(REFERENCE, effects=effects)
    return fit_of(hypothesis, effect_unknowns(hypothesis), std, ratio)


def ranked(effect, log_evidence=0.0, ratio=1.0):
    return Ranked(effect, effect_fit(effect, ratio=ratio), refitted=True, log_evidence=log_evidence)


def test_a_number_of_the_rig_is_told_in_its_unit_and_widened_by_the_misfit():
    rig = oscillator()
    unknowns = rig_unknowns(rig)
    hypothesis = unknowns[0].set(Hypothesis(rig), 1.5)

    rows = {e.name: e for e in rig_estimates(fit_of(hypothesis, unknowns, 0.2))}
    wide = {e.name: e for e in rig_estimates(fit_of(hypothesis, unknowns, 0.2, ratio=3.0))}

    first = unknowns[0].parameter
    value = first.value * np.exp(1.5 * first.tolerance)
    assert rows[first.path].value == pytest.approx(value)
    assert rows[first.path].std == pytest.approx(np.hypot(0.2 * first.tolerance, KNOWN_TO) * value)
    assert wide[first.path].std == pytest.approx(np.hypot(0.6 * first.tolerance, KNOWN_TO) * value)
    untold = {e.name: e for e in rig_estimates(fit_of(hypothesis, unknowns, 0.9, ratio=3.0))}
    assert untold[first.path].std == pytest.approx(first.tolerance * value)  # its owner knew that much
    assert (set(rows), rows["mass"].unit) == ({"mass", "stiffness", "damping"}, "kg")


def test_an_effects_numbers_are_told_with_its_place():
    rows = {e.name: e for e in effect_estimates(effect_fit(MASS), 0)}

    spread = PointMass.parameters()["mass"].spread
    assert (rows["mass"].value, rows["mass"].unit) == (0.3, "kg")
    assert rows["mass"].std == pytest.approx(0.3 * np.hypot(np.expm1(0.01 * spread), KNOWN_TO))
    assert rows["position"].value == 0.7
    assert rows["position"].std == pytest.approx(1.469 * np.hypot(0.01 / 20.0, PLACE_KNOWN_TO))


def test_a_linear_number_has_a_deviation_in_its_own_unit():
    (row,) = effect_estimates(effect_fit(GAIN), 0)

    assert (row.name, row.value) == ("gain", 0.5)
    assert row.std == pytest.approx(0.5 * np.hypot(0.01, KNOWN_TO))


def test_no_number_is_told_closer_than_two_models_of_one_rig_agree():
    rows = {e.name: e for e in effect_estimates(effect_fit(MASS, std=1e-9), 0)}

    assert rows["mass"].std == pytest.approx(KNOWN_TO * 0.3)
    assert rows["position"].std == pytest.approx(PLACE_KNOWN_TO * REFERENCE.structure.length)


def test_a_number_that_nobody_knows_has_a_finite_deviation():
    row = effect_estimates(effect_fit(MASS, std=1e9), 0)[-1]

    assert row.std == pytest.approx(0.3 * np.expm1(LARGEST_LOG_STD))


@pytest.mark.parametrize("loss", [0.3, 0.999])
def test_a_number_within_bounds_is_never_known_less_than_that(loss):
    crack = BreathingCrack(Place(position=REFERENCE.structure.length), loss=loss)

    rows = {e.name: e.std for e in effect_estimates(effect_fit(crack, std=1e9), 0)}

    anywhere = np.random.default_rng(0).uniform(0.0, 0.999, 100_000)
    assert rows["loss"] == pytest.approx(np.sqrt(np.mean((anywhere - loss) ** 2)), rel=0.01)
    assert rows["position"] == pytest.approx(REFERENCE.structure.length / np.sqrt(3.0))


def test_each_of_two_effects_has_its_own_numbers():
    result = effect_fit(GAIN, MASS)

    assert {e.name for e in effect_estimates(result, 0)} == {"gain"}
    assert {e.name for e in effect_estimates(result, 1)} == {"mass", "position"}
    alone = {e.name: e.std for e in effect_estimates(effect_fit(MASS), 0)}
    assert {e.name: e.std for e in effect_estimates(result, 1)} == pytest.approx(alone)


def test_an_added_effect_has_the_probability_of_its_own_round():
    rounds = [[ranked(GAIN, 0.0), ranked(MASS, -np.log(3.0))], [ranked(MASS, 0.0)]]

    first, second = added_effects(effect_fit(GAIN, MASS), rounds, Tried(0.97, 0.9))

    assert (first.effect, first.probability) == (GAIN, pytest.approx(0.97 * 0.75))
    assert (second.effect, second.probability) == (MASS, pytest.approx(0.9))  # the rest is for what was not judged


@pytest.mark.parametrize(("there", "mass", "held"), [(0.78, 0.36, True), (1.3, 0.36, False)])
def test_a_place_is_known_no_better_than_fits_of_its_valley_lie_apart(there, mass, held):
    rival = replace(MASS, place=Place(position=there), mass=mass)
    rounds = [[ranked(MASS, 0.0), ranked(rival, -np.log(3.0)), ranked(DAMPING, -np.log(3.0))]]

    (added,) = added_effects(effect_fit(MASS, std=1e-3), rounds, Tried(0.97, 0.9))

    alone = {e.name: e.std for e in effect_estimates(effect_fit(MASS, std=1e-3), 0)}
    apart = {"position": there - 0.7, "mass": mass - 0.3}
    for number in added.estimates:
        wider = 0.5 * apart[number.name] if held else 0.0  # a quarter of what is of its kind lies there
        assert number.std == pytest.approx(np.hypot(alone[number.name], wider))


def test_parts_of_one_effect_are_as_probable_as_it_is():
    one = [ranked(GAIN, 0.0)]

    first, second = added_effects(effect_fit(GAIN, MASS), [one, one], Tried(0.97, 0.9))

    assert first.probability == second.probability == pytest.approx(0.97)


def test_candidates_stand_beside_the_best_with_errors_of_the_records():
    record, noise = measured(Hypothesis(REFERENCE), multisine(512))
    evaluator = evaluator_of((record, noise))
    target, rng = evaluator.timed[0], np.random.default_rng(2)
    left = 0.1 * record.responses.std(axis=1, keepdims=True) * rng.standard_normal(record.responses.shape)
    residual = whitened(scored_spectrum(left), target)
    fitted, ruled_out = ranked(MASS, -50.0), replace(ranked(GAIN, -53.0, ratio=2.0), refitted=False)
    fitted = replace(fitted, fit=replace(fitted.fit, residual=residual))

    without = replace(Hypothesis(REFERENCE), values={"youngs_modulus": 1.05 * REFERENCE.structure.youngs_modulus})
    best, other = candidates_of([fitted, ruled_out], [0.9, 0.05, 0.05], evaluator, 0.97, without)
    bounds = [
        evaluator.nrmse_of(row) for row in evaluator.residuals([(without, None), (ruled_out.fit.hypothesis, None)])
    ]

    assert (best.log_evidence, other.log_evidence) == (0.0, -3.0)
    assert best.nrmse == pytest.approx(nrmse(scored_spectrum(left), target.measured, target.quantities))
    assert other.nrmse == pytest.approx(min(bounds))
    assert max(bounds) > 1.1 * min(bounds)
    assert (best.probability, best.effect, other.refitted) == (pytest.approx(0.97 * 0.9), MASS, False)


def test_what_cannot_be_excluded_stands_in_one_group():
    rows = [ranked(MASS), ranked(DAMPING, ratio=1.1), ranked(GAIN, ratio=1.1)]

    assert groups_of(rows, [0.7, 0.29, 0.01, 0.0]) == ((MASS, DAMPING),)
    assert groups_of(rows, [0.99, 0.005, 0.005, 0.0]) == ()
    assert groups_of([], []) == ()


def test_what_predicts_the_same_is_one_group_whatever_was_known_beforehand():
    rows = [ranked(MASS), ranked(DAMPING), ranked(GAIN, ratio=1.1)]

    assert groups_of(rows, [0.998, 0.001, 0.001]) == ((MASS, DAMPING),)


SLEEVE = REFERENCE.sleeves[0]
AT_SLEEVE = Place(sleeve=SLEEVE.name, position=SLEEVE.position)
RUB = CoulombFriction(AT_SLEEVE, friction_force=0.3, slip_velocity=1e-3)


@pytest.mark.parametrize(
    ("best", "other", "is_one"),
    [
        (ContactStiffness(AT_SLEEVE, ratio=0.001), ContactStiffness(AT_SLEEVE, ratio=4.0), True),
        (RUB, replace(RUB, place=Place(position=SLEEVE.position + 1e-3)), True),
        (RUB, replace(RUB, place=Place(position=SLEEVE.position + 0.3)), False),
        (RUB, replace(RUB, against="ground"), False),
        (MASS, DAMPING, False),
    ],
)
def test_one_kind_at_one_place_is_one_finding(best, other, is_one):
    rows = [ranked(best, 0.0), ranked(other, -0.1)]

    kept = distinct(rows)

    assert kept == rows[: 1 if is_one else 2]
    assert (len(groups_of(kept, [0.5, 0.5])) == 0) == is_one


def test_less_is_believed_where_more_than_the_noise_is_left():
    record, noise = measured(Hypothesis(REFERENCE), multisine(512))
    evaluator = evaluator_of((record, noise))
    off = moved(REFERENCE, 1.0, *[0.0] * (len(REFERENCE.parameters()) - 1))
    met, beyond = score(evaluator, Hypothesis(REFERENCE)), score(evaluator, off)

    assert tried(met) == Tried(1.0 - UNTRIED, 1.0 - UNTRIED_LATER)
    assert beyond.nrmse > 1.2 * beyond.noise_nrmse
    assert tried(beyond) == Tried(1.0 - UNTRIED_BEYOND, 1.0 - UNTRIED_LATER_BEYOND)
    assert tried(met, holds=False) == Tried(1.0 - UNTRIED_MISSED, 1.0 - UNTRIED_MISSED)
    assert 0.0 < UNTRIED < UNTRIED_LATER < UNTRIED_LATER_BEYOND  # what stands beside another is less sure
