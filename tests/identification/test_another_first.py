"""An effect that imitates two gives way to one of them, beside which the other is seen."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest
from trial_records import REFERENCE, beam_session, found_with

from identification import another_first as module
from identification import diagnose
from identification.anew import WORTH_REFITTING
from identification.another_first import AnotherFirst, another_first, one_of_two
from identification.established import NO_LAW, NO_SIZE
from identification.evidence import LEAST_EVIDENCE, SIMPLER, Ranked, misfit_of
from identification.hypothesis import numbers_with_place
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


def as_two(asked, effect, *others, less=0.0):
    """An effect of which no number is told, that leaves so much less than it does, and what came after it."""
    asked.session.decisions.clear()
    found = asked.rows[effect].fit
    untold = replace(found, chi2=found.chi2 - less)
    return one_of_two(asked.session, asked.calibrated, untold, asked.round(effect, *others))


def test_two_that_explain_more_take_the_place_of_what_imitates_them(asked):
    other = as_two(asked, LOAD, DAMAGE, GAIN)

    assert other.fit.hypothesis.effects[0].kind == "local_damage"
    assert other.ranked[0].effect.kind == "sensor_gain"
    assert other.label.startswith("axial_load exchanged for local_damage at")
    assert "with numbers that are not told" in other.why
    assert [row.effect.kind for row in other.round] == ["local_damage", "sensor_gain"]  # the load is out


def test_another_of_the_same_kind_stays_in_the_round(asked):
    near = Ranked.of(found_with(asked.session, LIGHT))
    place = near.effect.place.position
    away = Place(position=place + (2.0 if place < 1.0 else -2.0) * valley(REFERENCE))
    far = replace(asked.rows[GAIN], effect=PointMass(away, mass=0.01))
    asked.rows |= {"near": near, "far": far}

    other = as_two(asked, "near", DAMAGE, "far")

    assert other is not None
    masses = [row for row in other.round if row.effect.kind == "point_mass"]
    assert [row.effect.place for row in masses] == [away]


@pytest.mark.parametrize(("better", "is_taken"), [(0.5, False), (1.5, True)])
def test_two_are_held_against_what_imitates_them_with_a_price_for_each_number(asked, better, is_taken, monkeypatch):
    monkeypatch.setattr(module, "MOST_BEHIND", np.inf)
    pair = as_two(asked, LOAD, DAMAGE).ranked[0].fit
    further = sum(map(numbers_with_place, pair.hypothesis.effects)) - numbers_with_place(LOAD)
    asked_for = 2.0 * misfit_of(pair) * (LEAST_EVIDENCE + further * np.log(SIMPLER))
    load = asked.rows[LOAD].fit
    less = load.cost - pair.cost - better * asked_for

    assert further > 0
    assert (as_two(asked, LOAD, DAMAGE, less=less) is not None) == is_taken


def test_where_nothing_is_seen_beside_a_runner_up_an_imitation_is_not_two(asked, looked):
    assert as_two(asked, LOAD, DAMAGE) is None
    assert looked == ["local_damage"]


CALIBRATED, IMITATION, STANDS = object(), object(), object()


def found(verdict, untold=None, effects=(DAMAGE, GAIN)):
    """What a search came to."""
    stands = SimpleNamespace(hypothesis=SimpleNamespace(effects=effects))
    return diagnose._Found([CALIBRATED, stands], [["round"]], verdict, stands, stands, None, "searched", untold)


class Searched:
    """A session in which searches come to one end after the other."""

    def __init__(self, monkeypatch, *ends, other=None, law=None):
        self.begun, self.states, self.stages, self.is_beyond = [], ["concluded"], ["as given"], False

        def added(_session, _given, _holdout, stages, _most, chain, rounds, seen):
            self.begun.append((chain, rounds, seen, self.states[-1]))
            stages.append(f"of search {len(self.begun)}")
            if ends[len(self.begun) - 1] is None:
                raise ArithmeticError
            return ends[len(self.begun) - 1]

        monkeypatch.setattr(diagnose, "_added", added)
        monkeypatch.setattr(diagnose, "_staged", lambda _, stages, label, __: stages.append(label) or True)
        monkeypatch.setattr(diagnose, "one_of_two", lambda *_: other)
        monkeypatch.setattr(diagnose, "law_beyond", lambda *_: law)
        monkeypatch.setattr(diagnose, "is_beyond_library", lambda _, found: found is not None)

    def decide(self, words):
        """Nobody listens."""

    def as_it_is(self):
        """What it is."""
        return self.states[-1]

    def back_to(self, state):
        """As it was."""
        self.states.append(state)

    def come_to(self, most_effects=3):
        """What is found in the end."""
        return diagnose._searched(self, None, (), self.stages, most_effects, [CALIBRATED])


OTHER = AnotherFirst(STANDS, ["in front"], ["seen"], "exchanged", "why")


def test_the_search_goes_on_from_one_of_two(monkeypatch):
    two = found("missing_effect")
    session = Searched(monkeypatch, found("unexplained", IMITATION), two, other=OTHER)

    assert session.come_to() is two
    assert session.stages == ["as given", "of search 1", "exchanged", "of search 2"]
    assert session.begun == [
        ([CALIBRATED], [], [], "concluded"),
        ([CALIBRATED, STANDS], [["in front"]], ["seen"], "searched"),
    ]


@pytest.mark.parametrize(
    "second",
    [found("unexplained", IMITATION), found("missing_effect", effects=(DAMAGE,)), found("complete", effects=()), None],
    ids=["unexplained", "one of them alone", "complete", "a motion that is lost"],
)
def test_two_that_are_not_named_leave_all_as_it_was(second, monkeypatch):
    first = found("unexplained", IMITATION)
    session = Searched(monkeypatch, first, second, other=OTHER)

    assert session.come_to() is first
    assert session.stages == ["as given", "of search 1"]
    assert session.as_it_is() == "concluded"


@pytest.mark.parametrize(
    ("untold", "told"),
    [
        (None, {"other": OTHER}),
        (IMITATION, {}),
        (IMITATION, {"other": OTHER, "law": "a memory"}),
        (IMITATION, {"other": OTHER, "most_effects": 1}),
    ],
    ids=["another reason", "no pair", "a law beyond the library", "one effect at most"],
)
def test_otherwise_the_search_is_over(untold, told, monkeypatch):
    first = found("unexplained", untold)
    session = Searched(monkeypatch, first, other=told.get("other"), law=told.get("law"))

    assert session.come_to(told.get("most_effects", 3)) is first
    assert session.stages == ["as given", "of search 1"]
    assert len(session.begun) == 1


def test_what_is_ranked_beside_another_effect_is_no_runner_up(asked, looked):
    asked.rows["beside"] = replace(asked.rows[DAMAGE], fit=found_with(asked.session, GAIN, DAMAGE), effect=DAMAGE)

    assert as_two(asked, LOAD, "beside") is None
    assert looked == []


@pytest.mark.parametrize(
    ("effects", "why", "is_untold"),
    [((LIGHT,), NO_LAW, True), ((LIGHT,), NO_SIZE, False), ((LIGHT, LOAD), NO_LAW, False)],
    ids=["one law", "a size", "one of two"],
)
def test_what_is_taken_out_alone_since_no_number_is_told_may_be_two(effects, why, is_untold, monkeypatch):
    session = SimpleNamespace(decide=lambda _: None, stage=lambda *_: "calibrated again")
    last, bare = (SimpleNamespace(hypothesis=SimpleNamespace(effects=each)) for each in (effects, ()))
    monkeypatch.setattr(
        diagnose, "verdict_of", lambda *_, taken_out, **__: "unexplained" if taken_out else "missing_effect"
    )
    monkeypatch.setattr(diagnose, "settled", lambda _, fit: fit)
    monkeypatch.setattr(diagnose, "in_doubt", lambda *_: (0, why))
    for name in ("instead_of", "within_tolerances", "fit_without"):
        monkeypatch.setattr(diagnose, name, lambda *_: None)
    bare_rounds = [["round"] for _ in effects]

    ended = diagnose._ended(session, [bare, last], bare_rounds, [], ())

    assert ended.verdict == "unexplained"
    assert ended.final is bare
    assert (ended.untold is last) == is_untold
