"""A table in time gets as many values as what it stands for asks for."""

import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.detail import in_more_detail
from identification.evidence import Ranked
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.judge import _first_in_detail
from models.effects import Place
from models.effects.point_mass import PointMass
from models.effects.time_varying_damping import TimeVaryingDamping

MASS = PointMass(Place(position=0.7), mass=0.3)
SLEEVE = Place(sleeve="sleeve 2", position=REFERENCE.sleeves[1].position)


def test_a_table_is_refined_beside_the_effect_that_was_found_after_it():
    """Two knots cannot follow a damping that falls and stays; only once the mass is there does that show."""
    course = TimeVaryingDamping(SLEEVE, times=(0.0, 1.0, 2.0), values=(200.0, 40.0, 40.0))
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(course, MASS)), multisine(4096, rms=2.0)))
    coarse = TimeVaryingDamping(SLEEVE, times=(0.0, 2.0), values=(170.0, 20.0))
    start, told = Hypothesis(REFERENCE, effects=(coarse, MASS)), []
    before = fit(evaluator, start, (*rig_unknowns(REFERENCE), *effect_unknowns(start)))

    after = in_more_detail(evaluator, before, told.append)

    assert before.ratio > 1.3
    assert after.ratio < 1.05
    table, mass = after.hypothesis.effects
    assert table.values == pytest.approx(course.values, rel=0.1)
    assert mass.mass == pytest.approx(MASS.mass, rel=0.02)
    assert told[0].startswith("time_varying_damping at sleeve 2 described in more detail")


@pytest.fixture(scope="module")
def odd():
    """The records of a course that is odd about its middle, where three knots do no more than two, and that of two."""
    course = TimeVaryingDamping(SLEEVE, times=(0.0, 0.5, 1.0, 1.5, 2.0), values=(80.0, 160.0, 80.0, 20.0, 80.0))
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(course,)), multisine(4096, rms=2.0)))
    start = Hypothesis(REFERENCE, effects=(TimeVaryingDamping(SLEEVE, times=(0.0, 2.0), values=(120.0, 50.0)),))
    return course, evaluator, fit(evaluator, start, (*rig_unknowns(REFERENCE), *effect_unknowns(start)))


def test_a_corner_that_no_half_shows_is_found_in_the_quarters(odd):
    course, evaluator, before = odd

    after = in_more_detail(evaluator, before, lambda _: None)

    (table,) = after.hypothesis.effects
    assert after.ratio < 1.05 < before.ratio
    assert table.values == pytest.approx(course.values, rel=0.1)


def test_the_first_of_a_ranking_is_told_in_detail_before_another_way_of_looking(odd):
    _, evaluator, before = odd
    (row,) = _first_in_detail([Ranked.of(before)], evaluator, lambda _: None)
    assert row.fit.ratio < 1.05
    assert len(row.effect.times) == 5
    assert _first_in_detail([row], evaluator, lambda _: None) == [row]
    assert _first_in_detail([], evaluator, lambda _: None) == []


def test_a_table_that_explains_is_left_as_it_is():
    course = TimeVaryingDamping(SLEEVE, times=(0.0, 1.0), values=(200.0, 40.0))
    truth = Hypothesis(REFERENCE, effects=(course,))
    evaluator, told = evaluator_of(measured(truth, multisine(2048, rms=2.0))), []
    found = fit(evaluator, truth, (*rig_unknowns(REFERENCE), *effect_unknowns(truth)))

    assert in_more_detail(evaluator, found, told.append) is found
    assert told == []
