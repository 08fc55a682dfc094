"""A table in time gets as many values as what it stands for asks for."""

import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.detail import in_more_detail
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
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


def test_a_table_that_explains_is_left_as_it_is():
    course = TimeVaryingDamping(SLEEVE, times=(0.0, 1.0), values=(200.0, 40.0))
    truth = Hypothesis(REFERENCE, effects=(course,))
    evaluator, told = evaluator_of(measured(truth, multisine(2048, rms=2.0))), []
    found = fit(evaluator, truth, (*rig_unknowns(REFERENCE), *effect_unknowns(truth)))

    assert in_more_detail(evaluator, found, told.append) is found
    assert told == []
