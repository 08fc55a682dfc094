"""An effect that imitates two gives way to one of them, beside which the other is seen."""

from dataclasses import replace
from math import inf

import pytest
from trial_records import REFERENCE, beam_session, found_with

from identification import another_first as module
from identification.anew import WORTH_REFITTING
from identification.another_first import another_first
from identification.evidence import Ranked
from identification.in_its_place import EXPLAINED
from identification.relearning import everything_again
from identification.scene import valley
from models.effects import EFFECTS, Place
from models.effects.axial_load import AxialLoad
from models.effects.local_damage import LocalDamage
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

DAMAGE, GAIN = LocalDamage(Place(position=0.64), loss=0.08, width=0.1), SensorGain(Place(sensor="P4"), gain=0.96)
LIGHT = PointMass(Place(position=1.0), mass=0.001)
THERE = PointDamping(Place(position=1.0 + 0.8 * valley(REFERENCE)), damping=1.0)
LOAD, NEAR_BY = AxialLoad(Place(), force=-5.0), PointMass(Place(position=0.64), mass=0.001)


class Asked:
    """What is asked of where an imitation came first."""

    def __init__(self):
        self.session = beam_session(DAMAGE, GAIN)
        self.session.registry = {kind: EFFECTS[kind] for kind in ("local_damage", "axial_load", "sensor_gain")}
        self.calibrated = found_with(self.session)
        self.rows = {each: Ranked.of(found_with(self.session, each)) for each in (LOAD, DAMAGE, GAIN)}
        self.rows[NEAR_BY] = replace(self.rows[DAMAGE], effect=NEAR_BY)

    def round(self, *effects):
        """One in which they were found so probable, one after the other."""
        return [replace(self.rows[each], log_evidence=-100.0 * k) for k, each in enumerate(effects)]

    def about(self, *effects, seen=()):
        """Beside the first of them something or nothing was seen."""
        self.session.decisions.clear()
        return another_first(self.session, self.calibrated, self.rows[effects[0]].fit, self.round(*effects), seen)


@pytest.fixture(scope="module")
def asked():
    return Asked()


@pytest.fixture
def looked(monkeypatch):
    """Effects beside which was looked; nothing is seen there."""
    beside = []

    def look(_session, base, _look, near):
        assert near == WORTH_REFITTING
        beside.append(base.hypothesis.effects[-1].kind)
        return []

    monkeypatch.setattr(module, "ranked_beside", look)
    return beside


def test_the_one_beside_which_the_other_is_seen_takes_the_place_of_an_imitation(asked):
    other = asked.about(LOAD, DAMAGE)

    (damage,) = other.fit.hypothesis.effects
    assert damage.kind == "local_damage"
    assert other.fit.ratio > EXPLAINED
    assert other.ranked[0].effect.kind == "sensor_gain"
    assert [effect.kind for effect in other.ranked[0].fit.hypothesis.effects] == ["local_damage", "sensor_gain"]
    assert other.ranked[0].fit.ratio == pytest.approx(1.0, abs=0.1)
    assert other.label.startswith("axial_load exchanged for local_damage at")
    assert other.why.startswith("beside that sensor_gain on P4 leaves 1.00 times the noise")


def test_it_stays_in_front_when_all_are_fitted_again(asked):
    chain = [asked.calibrated, asked.rows[DAMAGE].fit]
    other = asked.about(LOAD, DAMAGE, GAIN)

    _, (again,) = everything_again(asked.session, chain, [other.round])

    for ranked in (other.round, again):
        first, *others = ranked
        assert first.effect.kind == "local_damage"
        (imitation,) = (row for row in others if row.effect.kind == "axial_load")
        assert first.log_evidence - imitation.log_evidence > 1000.0
        assert not imitation.refitted


@pytest.mark.parametrize(
    ("name", "answer"),
    [
        ("reaches_noise", False),
        ("LEAST_EVIDENCE", 1e9),
        ("LEAST_SHARE", 2.0),
        ("passing", "an event"),
    ],
)
def test_a_pair_that_would_not_be_added_takes_no_place(asked, monkeypatch, name, answer):
    monkeypatch.setattr(module, "_runners_up", lambda *_: [asked.rows[DAMAGE]])
    monkeypatch.setattr(module, name, (lambda *_: answer) if callable(getattr(module, name)) else answer)

    assert asked.about(LOAD, DAMAGE) is None


def test_a_pair_whose_motion_is_lost_in_whole_records_takes_no_place(asked, monkeypatch):
    monkeypatch.setattr(type(asked.session), "holds", lambda *_: False)

    assert asked.about(LOAD, DAMAGE) is None


def test_what_imitates_in_one_valley_is_asked_once(asked, looked):
    asked.rows[THERE] = replace(asked.rows[GAIN], effect=THERE)
    asked.rows[LIGHT] = replace(asked.rows[GAIN], effect=LIGHT)

    assert asked.about(LOAD, LIGHT, THERE, DAMAGE) is None
    assert looked == ["sensor_gain", "local_damage"]  # the mass has the fit of the gain


def test_no_other_is_asked_where_something_is_seen_beside_the_first(asked, looked):
    both = Ranked.of(found_with(asked.session, DAMAGE, GAIN))
    assert both.fit.ratio <= EXPLAINED

    assert asked.about(LOAD, DAMAGE, seen=[both]) is None
    assert looked == []


def test_what_sits_where_the_first_does_or_explains_next_to_nothing_is_not_asked(asked, looked):
    assert asked.about(DAMAGE, NEAR_BY, GAIN, LOAD) is None
    assert looked == ["sensor_gain"]  # a load takes next to nothing away


def test_what_explains_far_less_than_the_first_is_not_asked(asked, looked, monkeypatch):
    monkeypatch.setattr(module, "MOST_BEHIND", 1.0)

    assert asked.about(DAMAGE, GAIN) is None
    assert looked == []


def test_no_more_are_asked_than_the_most(asked, looked, monkeypatch):
    monkeypatch.setattr(module, "MOST_RUNNERS_UP", 1)

    assert asked.about(LOAD, GAIN, DAMAGE) is None
    assert looked == ["sensor_gain"]


def test_where_nothing_is_seen_beside_any_the_first_stays(asked, looked):
    assert asked.about(LOAD, DAMAGE, GAIN) is None
    assert looked == ["local_damage", "sensor_gain"]
    assert asked.session.decisions == []


def test_none_is_asked_when_the_time_is_over(asked, looked):
    asked.session.until = -inf
    try:
        assert asked.about(LOAD, DAMAGE) is None
    finally:
        asked.session.until = inf
    assert looked == []
    assert "a search beside local_damage" in asked.session.decisions[-1]
