"""The phases that every record has for itself are found, counted and fitted; a single line is seen in what is left."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine, oscillator

from identification.evidence import log_occam
from identification.fit import fit
from identification.hypothesis import Hypothesis, OwnNumber, effect_unknowns, own_unknowns, with_own_number
from identification.in_step import in_step, tried_with
from identification.lines import lines_left
from models.effects import Place
from models.effects.base_motion import BaseMotion
from models.effects.mains_hum import MainsHum
from models.effects.point_damping import PointDamping

HUM = MainsHum(Place(), frequency=50.02, amplitude=0.5)
PHASES = {"hum_phase_1": 0.7, "hum_phase_3": -2.1, "hum_phase_5": 3.0}
FLOOR = BaseMotion(Place(), frequency=33.3, amplitude=0.4)


def hearing(effect, **phases):
    """Two records of an oscillator with an effect, the second with all phases turned by 1 rad."""
    rig, pairs = oscillator(), []
    for turn, name in enumerate(("first", "second")):
        truth = Hypothesis(rig, effects=(effect,))
        for key, phase in phases.items():
            truth = with_own_number(truth, name, key, phase + turn)
        pairs.append(measured(truth, multisine(n=4096, periods=2, seed=turn), name=name))
    return Hypothesis(rig), evaluator_of(*pairs)


def turned(found, expected):
    """How far two phases are apart."""
    return abs((found - expected + pi) % (2 * pi) - pi)


@pytest.mark.parametrize("effect", [HUM, FLOOR], ids=lambda effect: effect.kind)
def test_phases_are_found_for_each_record(effect):
    phases = PHASES if effect is HUM else {"base_phase": 0.7}
    given, evaluator = hearing(effect, **phases)
    tried = tried_with(evaluator, given, effect)
    for turn, name in enumerate(("first", "second")):
        for key, phase in phases.items():
            assert turned(tried.own[name][key], phase + turn) < 0.1  # noise, and one after the other


def test_an_effect_of_half_the_size_finds_the_same_phases():
    given, evaluator = hearing(FLOOR, base_phase=0.7)
    small = tried_with(evaluator, given, replace(FLOOR, amplitude=0.1))
    assert turned(small.own["first"]["base_phase"], 0.7) < 0.1


def test_an_effect_without_numbers_of_its_own_is_left_alone():
    given, evaluator = hearing(HUM, **PHASES)
    damping = PointDamping(Place(), damping=3.0)
    assert tried_with(evaluator, given, damping).own == {}
    assert in_step(evaluator, given, ()) is given


def test_frequency_amplitude_and_phases_are_fitted_together():
    given, evaluator = hearing(HUM, **PHASES)
    start = tried_with(evaluator, given, replace(HUM, frequency=50.0, amplitude=0.3))
    unknowns = own_unknowns(start)
    assert sum(isinstance(unknown, OwnNumber) for unknown in unknowns) == 6
    found = fit(evaluator, start, unknowns)
    assert found.ratio == pytest.approx(1.0, abs=0.03)
    (effect,) = found.hypothesis.effects
    assert effect.frequency == pytest.approx(50.02, abs=0.01)
    assert effect.amplitude == pytest.approx(0.5, rel=0.02)


def test_the_numbers_of_a_record_that_is_not_there_are_left_out_of_a_fit():
    given, evaluator = hearing(FLOOR, base_phase=0.7)
    start = tried_with(evaluator, given, FLOOR)
    first = evaluator.with_targets(evaluator.targets[:1])
    found = fit(first, start, own_unknowns(start), max_iterations=1)
    assert [u.record for u in found.unknowns if isinstance(u, OwnNumber)] == ["first"]
    assert len(found.jacobian) == len(found.unknowns) == 3


def test_a_phase_costs_its_share_of_a_turn():
    """One number with a standard deviation s of a turn: log(s sqrt(2 pi) / (2 pi)) of evidence."""
    given, evaluator = hearing(FLOOR, base_phase=0.7)
    start = tried_with(evaluator, given, FLOOR)
    found = fit(evaluator, start, [u for u in own_unknowns(start) if isinstance(u, OwnNumber)])
    expected = np.sum(np.log(np.sqrt(2 * pi * np.diag(found.covariance)) / (2 * pi)))
    assert log_occam(found) == pytest.approx(expected, abs=1e-4)  # the records' phases do not touch each other


def test_phases_of_an_effect_of_the_rig_file_belong_to_no_hypothesis():
    assert effect_unknowns(Hypothesis(REFERENCE)) == ()
    assert all(u.effect == 0 for u in effect_unknowns(Hypothesis(REFERENCE, effects=(HUM,))))


def test_a_line_that_the_model_does_not_explain_is_seen():
    given, evaluator = hearing(FLOOR, base_phase=0.7)
    assert lines_left(evaluator, given).free[0] == pytest.approx(33.3, abs=0.02)


def test_a_hum_is_seen_with_its_harmonics():
    given, evaluator = hearing(HUM, **PHASES)
    seen = lines_left(evaluator, given).free
    for harmonic in (1, 3, 5):
        assert min(abs(f - harmonic * 50.02) for f in seen) < 0.03


def test_noise_alone_has_no_lines():
    given = Hypothesis(oscillator())
    records = [measured(given, multisine(4096, 2), seed=seed) for seed in range(10)]
    seen = [lines_left(evaluator_of(record), given) for record in records]
    assert (
        sum(len(lines.free + lines.driven) for lines in seen) <= 2
    )  # STANDS_OUT: some thousand lines of one channel each


def test_lines_of_the_excitation_are_not_taken_for_others():
    """With a wrong frequency the model leaves every line of a multisine; the floor's own line is told first."""
    given, evaluator = hearing(FLOOR, base_phase=0.7)
    wrong = replace(given, values={"stiffness": 1.02 * given.rig.structure.stiffness})
    seen = lines_left(evaluator, wrong)
    assert seen.free[0] == pytest.approx(33.3, abs=0.02)
    assert len(seen.free) == 1
