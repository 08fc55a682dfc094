"""An effect that one mode tells may sit elsewhere: the records say where else, and the probability is shared."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import REFERENCE, beam_session, evaluator_of, found_with, measured, multisine

from identification.evidence import Ranked, probabilities
from identification.hypothesis import Hypothesis, PlaceUnknown
from identification.places_open import PARTS, in_parts, with_other_valleys
from identification.prepare import Horizon
from identification.session import Session
from models.effects import EFFECTS, Place
from models.effects.local_damage import LocalDamage
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

GRAM, POUND = (PointMass(Place(position=1.2), mass=mass) for mass in (2e-4, 0.05))
UNIT = REFERENCE.structure.length / 20.0


def found_in_one_mode(mass):
    """A session on noisy motion in the first mode of the rig with a mass, and the fit of that."""
    force = multisine(4096, rms=0.05, low=2.0, high=30.0)
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(mass,)), force, noise=0.05))
    session = Session(evaluator, evaluator, [Horizon("test", 1.0, 2.0)], EFFECTS, lambda _: None, 0)
    return session, found_with(session, mass)


def with_place_std(found, std):
    """The fit with a place known to this, m."""
    (row,) = (i for i, unknown in enumerate(found.unknowns) if isinstance(unknown, PlaceUnknown))
    covariance = found.covariance.copy()
    covariance[row, row] = (std / UNIT) ** 2
    return replace(found, covariance=covariance)


@pytest.fixture(scope="module")
def hardly_told():
    return found_in_one_mode(GRAM)


@pytest.fixture(scope="module")
def told():
    return found_in_one_mode(POUND)


def test_where_a_place_is_hardly_told_others_explain_the_records_as_well(hardly_told):
    session, found = hardly_told
    beaten = replace(Ranked.of(found), fit=replace(found, chi2=found.chi2 + 1000.0), log_evidence=-4.0)
    first, rival = Ranked.of(found), beaten

    rows = in_parts(session, [first, rival], found, 0)

    members, (last,) = rows[:-1], rows[-1:]
    places = [row.effect.place.position for row in members]
    assert (len(members), members[0].fit, last) == (PARTS, found, rival)
    assert all(abs(one - other) > 0.1 for i, one in enumerate(places) for other in places[:i])
    assert [row.fit.chi2 for row in members] == pytest.approx([found.chi2] * PARTS, abs=4.0)
    chances = probabilities([row.log_evidence for row in rows])
    assert np.ptp(chances[:-1]) == pytest.approx(0.0, abs=1e-12)
    assert sum(chances[:-1]) == pytest.approx(probabilities([0.0, -4.0])[0])


def test_a_place_that_is_not_told_at_all_falls_into_thirds_of_the_beam(hardly_told):
    """The one that was fitted, at 1.04 m, stands for the last third; at a sixth of the length the records say no."""
    session, found = hardly_told

    rows = in_parts(session, [Ranked.of(found)], with_place_std(found, 30.0), 0)

    thirds = [row.effect.place.position / REFERENCE.structure.length for row in rows]
    assert thirds[1:] == pytest.approx([1.0 / 6.0, 0.5][-len(thirds[1:]) :], abs=0.01)


def test_beside_another_effect_that_is_not_excluded_the_place_stays_one(hardly_told):
    session, found = hardly_told
    ranked = [Ranked.of(found), replace(Ranked.of(found), log_evidence=-1.0)]
    assert in_parts(session, ranked, found, 0) == ranked


def test_of_two_effects_that_in_question_is_moved(hardly_told):
    session, found = hardly_told
    both = found_with(session, found.hypothesis.effects[0], SensorGain(Place(sensor="P4"), gain=1.0))
    row = Ranked.of(both, 0)

    rows = in_parts(session, [row], with_place_std(both, 0.25), 0)

    assert len(rows) > 1
    assert {each.effect.kind for each in rows} == {"point_mass"}
    assert len({each.effect.place.position for each in rows}) == len(rows)


def test_what_the_records_exclude_is_no_member(told):
    session, found = told

    row = Ranked.of(found)
    assert in_parts(session, [row], with_place_std(found, 0.3), 0) == [row]


def test_a_place_that_is_told_is_one(told):
    session, found = told
    row = Ranked.of(found)
    assert in_parts(session, [row], found, 0) == [row]


def test_what_has_no_place_along_the_beam_is_one(told):
    session, _ = told
    row = Ranked.of(found_with(session, SensorGain(Place(sensor="P4"), gain=1.0), iterations=0))
    assert in_parts(session, [row], row.fit, 0) == [row]


@pytest.fixture(scope="module")
def damaged():
    """A session on a rig with damage, its calibrated model, and damage fitted in the right and in the wrong valley."""
    session = beam_session(LocalDamage(Place(position=0.5), loss=0.3, width=0.06))
    places = (Place(position=0.5), Place(position=1.5))
    right, stuck = (Ranked.of(found_with(session, LocalDamage(place, loss=0.3, width=0.06))) for place in places)
    return session, found_with(session), right, stuck


def test_each_of_two_that_cannot_be_told_apart_is_sought_in_other_valleys(damaged):
    session, base, right, stuck = damaged
    mass = found_with(session, PointMass(Place(position=0.9), mass=0.1))

    rows = with_other_valleys(session, base, [replace(Ranked.of(mass), refitted=False), stuck])

    assert rows[0].effect.place.position == pytest.approx(right.effect.place.position, abs=0.01)
    assert stuck.fit in [row.fit for row in rows]


def test_what_stands_alone_is_not_sought_again(damaged):
    session, base, right, stuck = damaged
    ranked = [right, replace(stuck, log_evidence=-50.0)]
    assert with_other_valleys(session, base, ranked) is ranked
