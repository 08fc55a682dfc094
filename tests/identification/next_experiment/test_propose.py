"""What is proposed after every verdict."""

import re
from dataclasses import replace

import numpy as np
import pytest
from rival_scenes import SIGMA, bench_of, built, ranked_on

from identification.evaluate import Evaluator
from identification.evidence import misfit_in_common
from identification.hypothesis import Hypothesis
from identification.locating.located import Located
from identification.next_experiment.advice import CHAOTIC, LOWER
from identification.next_experiment.candidates import steady
from identification.next_experiment.choose import settles
from identification.next_experiment.costs import COSTS, LIMITS
from identification.next_experiment.proposal import Option
from identification.next_experiment.propose import next_experiment, shortened
from identification.next_experiment.rivals import rivals_of
from identification.next_experiment.words import in_vain, why, words_of
from identification.outcome import AT_REST_ONLY
from identification.prepare import Horizon, horizons
from identification.result import ErrorMap, MissingForce
from identification.session import Session
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.sensor_gain import SensorGain
from tests.identification.trial_records import REFERENCE, evaluator_of, measured, multisine, oscillator

CALM = [Horizon("test", 2.0, 1.0)]


def session_of(evaluator, limits=None):
    return Session(evaluator, evaluator, CALM if limits is None else limits, EFFECTS, lambda _: None, 0)


def oscillators_record(truth=None, rms=5.0, n=2048):
    rig = oscillator("displacement")
    record, noise = measured(truth or Hypothesis(rig), multisine(n, rms=rms, low=10.0), noise=0.01)
    return Hypothesis(rig), evaluator_of((record, noise))


def test_without_a_time_record_one_is_asked_for():
    told = next_experiment(session_of(Evaluator([], 1)), "complete", [], Hypothesis(REFERENCE))
    assert told.why == AT_REST_ONLY
    assert told.test is None


def test_a_complete_model_is_tried_at_a_higher_level():
    model, evaluator = oscillators_record()
    told = next_experiment(session_of(evaluator), "complete", [], model)
    assert "higher level" in told.do
    assert told.test.excitation["rms"] == pytest.approx(10.0, rel=0.01)
    assert set(told.noise) == {"top", "excitation"}


def test_a_complete_model_is_tried_where_it_touches_what_it_has_not_touched():
    model = built()[0]
    record, noise = measured(model, multisine(2048, rms=1.0, low=10.0))

    told = next_experiment(session_of(evaluator_of((record, noise))), "complete", [], model)

    assert re.search(
        "what no record has touched is touched there: (the lower wall|the upper wall|both walls) of", told.why
    )
    factor = told.test.excitation["rms"]
    louder = replace(record, excitation=factor * record.excitation)
    trace = model.simulated(louder, replace(evaluator_of((record, noise)).settings, trace=True)).trace
    assert np.abs(trace.contact_forces[0]).max() > 0.0


def test_a_motion_that_cannot_be_followed_is_asked_for_at_a_level_at_which_it_can():
    model = built()[0]
    record, noise = measured(model, multisine(4096, rms=60.0, low=10.0))
    evaluator = evaluator_of((record, noise))
    limits = [Horizon("test", 2.0 * CHAOTIC, 0.5)]

    told = next_experiment(session_of(evaluator, limits), "missing_effect", [], model)

    assert "lower level" in told.do
    factor = told.test.excitation["rms"] / 60.0
    assert min(abs(factor / lower - 1.0) for lower in LOWER) < 0.01
    quiet = evaluator_of((replace(record, excitation=factor * record.excitation), noise))
    assert horizons(quiet, model)[0].growth <= CHAOTIC


def test_a_model_that_nobody_tried_is_tried_on_a_record_of_another_kind():
    model, evaluator = oscillators_record()
    told = next_experiment(session_of(evaluator), "missing_effect", [], model)
    assert "--holdout" in told.do
    assert told.test.excitation["kind"] == "sweep"

    kept = next_experiment(session_of(evaluator), "missing_effect", [], model, kept_aside=True)
    assert "higher level" in kept.do
    assert "kept aside" in kept.why


def test_what_was_not_predicted_is_to_be_learnt_from():
    model = built()[0]
    evaluator = evaluator_of(measured(model, multisine(2048, rms=1e-3, low=10.0)))

    told = next_experiment(session_of(evaluator), "missing_effect", [], model, kept_aside=True, missed=["burst"])

    assert told.do.startswith("learn from burst too, and keep another record aside: a multisine of ")
    assert told.why.startswith("what was learnt does not hold on burst")
    assert "no record learnt from has touched both walls of sleeve 1 and sleeve 2" in told.why


def test_what_is_unexplained_is_looked_at_where_it_is():
    model, evaluator = oscillators_record()
    errors = np.array([[0.1, 0.8, 0.1]])
    frequency, quiet = np.array([30.0, 60.0, 90.0]), np.full((1, 3), 0.01)
    where = ErrorMap("test", 5.0, frequency, errors, np.array([0.5]), np.ones((1, 1)), quiet)
    force = MissingForce("mass", "test", np.zeros(9), np.zeros(9), np.arange(9.0), 100.0)

    told = next_experiment(session_of(evaluator), "unexplained", [], model, maps=[where], forces=[force])

    assert told.test.excitation["low"] < 60.0 < told.test.excitation["high"]
    assert told.test.excitation["rms"] == pytest.approx(2.5, rel=0.01)
    assert "60 Hz" in told.why
    assert "acts at mass" in told.why


@pytest.mark.parametrize(
    ("is_untold", "begins"), [(True, "the same test again, once it is"), (False, "half the level")]
)
def test_a_record_of_which_nothing_is_told_is_to_be_looked_at_itself(is_untold, begins):
    model, evaluator = oscillators_record()

    told = next_experiment(session_of(evaluator), "unexplained", [], model, is_untold=is_untold)

    assert told.do.startswith(begins)


@pytest.mark.parametrize(
    ("enough", "sensor", "words"), [(True, None, "a sensor at 0.626 m"), (False, None, ""), (True, "P1", "")]
)
def test_a_sensor_is_put_where_one_force_explains_it_and_nowhere_else(enough, sensor, words):
    model, evaluator = oscillators_record()
    force = MissingForce("mass", "test", np.zeros(9), np.zeros(9), np.arange(9.0), 100.0)
    none = np.zeros(0)
    place = None if sensor else 0.626
    located = Located(none, none, (), 5.0, 1.0, place, None, None, sensor, 0.99, enough, "", (), None)

    told = next_experiment(session_of(evaluator), "unexplained", [], model, forces=[force], located=located)

    assert ("with a sensor at" in told.do) == bool(words)
    assert words in told.do


def test_a_group_is_told_apart_by_a_weighed_test():
    rig = oscillator("displacement")
    cubic = CubicStiffness(Place(), stiffness=3.0 * rig.structure.stiffness / 1e-3**2)
    gain = SensorGain(Place(sensor="top"), gain=1.0)
    _, evaluator = oscillators_record(Hypothesis(rig, effects=(replace(gain, gain=1.1),)), rms=2.0)
    ranked = ranked_on(evaluator, [Hypothesis(rig, effects=(effect,)) for effect in (cubic, gain)])
    chances = [0.6, 0.4]

    told = next_experiment(session_of(evaluator), "missing_effect", [(ranked, chances)], ranked[0].fit.hypothesis)

    assert told.best.expected_probability > 0.95
    assert told.best.test is told.test
    assert {effect.kind for effect in told.rivals} == {"cubic_stiffness", "sensor_gain"}
    assert "do not tell" in told.why
    assert told.present_probability < told.best.expected_probability

    late = session_of(evaluator)
    late.until = 0.0
    unweighed = next_experiment(late, "missing_effect", [(ranked, chances)], ranked[0].fit.hypothesis)
    assert (unweighed.options, unweighed.rivals) == ((), ())
    assert late.untried == ["the time given is over: weighing tests that tell the suspects apart was not begun"]


GAIN = SensorGain(Place(sensor="top"), gain=1.1)


def test_only_fitted_members_in_doubt_are_rivals():
    rig = oscillator("displacement")
    _, evaluator = oscillators_record(rms=2.0)  # nothing is there
    (first,) = ranked_on(evaluator, [Hypothesis(rig, effects=(GAIN,))])
    sketch, other = replace(first, refitted=False), replace(first)
    far = replace(first, fit=replace(first.fit, chi2=first.fit.chi2 + 9.0 * misfit_in_common([first])))

    assert [rival.chance for rival in rivals_of([first, sketch, other], [0.5, 0.3, 0.2])] == [0.5, 0.2]
    assert rivals_of([first, sketch], [0.6, 0.4]) == ()
    assert rivals_of([first, far], [0.99, 0.01]) == ()


@pytest.mark.parametrize(
    ("expected", "apart", "is_settled"), [(0.97, 0.3, False), (0.97, 4.0, True), (0.9, 4.0, False)]
)
def test_only_what_a_test_measures_settles_a_matter(expected, apart, is_settled):
    """Of two that predict the same one may be as probable beforehand."""
    test = steady(bench_of(oscillator(), SIGMA), COSTS, 1.0, (10.0, 200.0), "level")
    assert settles(Option(test, expected, apart, 1.0, test.seconds)) == is_settled


def test_what_a_test_does_not_part_is_said():
    test = steady(bench_of(oscillator(), SIGMA), COSTS, 1.0, (10.0, 200.0), "level")
    same, near, far = (Option(test, 0.97, apart, 1.0, test.seconds) for apart in (0.2, 2.0, 4.0))
    assert "one of them may still do what another does" in in_vain(["a", "b"], same)
    assert "part by 2 standard deviations" in in_vain(["a", "b"], near)
    assert "part by 4 standard deviations" in why(["a", "b"], far, 0.9, LIMITS)
    assert words_of(same) == f"no test within reach parts them; the best of those weighed is {test.words}"
    assert words_of(far) == test.words


def test_a_part_of_old_records_stands_for_all_of_them():
    _, evaluator = oscillators_record(n=20480)
    model = Hypothesis(oscillator("displacement"))
    short = shortened(evaluator)
    assert sum(target.record.duration for target in short.timed) == pytest.approx(6.0, abs=0.1)
    change = [SensorGain(Place(sensor="top"), gain) for gain in (1.0, 1.1)]

    def told(records):
        one, other = records.residuals([(model.with_effects(effect), None) for effect in change])
        return np.sum((one - other) ** 2)

    # The first second, before the resonance has built up, counts more in the part.
    assert told(short) == pytest.approx(told(evaluator), rel=0.15)
