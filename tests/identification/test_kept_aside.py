"""Records kept aside: a model that holds there, one that does not, and what nobody can follow."""

from types import SimpleNamespace

import numpy as np
import pytest
from rest_records import frfs_of
from trial_records import measured, moved, multisine, oscillator

from identification.draws import Drawn
from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.kept_aside import kept_aside, predicted
from identification.prepare import Horizon
from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.quadratic_stiffness import QuadraticStiffness
from models.errors import DivergenceError

RIG = oscillator("displacement")
TRUTH = moved(RIG, 0.5, -0.8, 1.0)
HARD = TRUTH.with_effects(CubicStiffness(Place(), stiffness=0.3 * RIG.structure.stiffness / 1e-3**2))


class Told(SimpleNamespace):
    """Stands for a session."""

    def __init__(self):
        super().__init__(everything=Evaluator([], 1), seed=0, progress=lambda _: None, decisions=[])
        self.decide = self.decisions.append


def judged(updated, *records):
    session = Told()
    return kept_aside(session, Hypothesis(RIG), updated, records), session.decisions


def test_a_model_that_is_right_holds_and_nothing_is_missed():
    record, _ = measured(TRUTH, multisine(4096), name="kept")

    kept, decisions = judged(TRUTH, record)

    assert kept.missed == {}
    (told,) = decisions
    assert told.startswith("on kept, kept aside, the calibrated model leaves ")
    assert told.endswith("what was learnt holds there")
    assert kept.scores["updated"].nrmse < 0.3 * kept.scores["as given"].nrmse


def test_a_model_that_learnt_at_a_lower_level_is_told_where_it_fails():
    low, _ = measured(HARD, multisine(4096, rms=0.1), name="low")
    high, _ = measured(HARD, multisine(4096, rms=20.0), name="high")

    kept, decisions = judged(TRUTH, low, high)

    assert len(decisions) == 2
    assert kept.missed == {"high": next(told for told in decisions if "high" in told)}
    assert "does not hold" in kept.missed["high"]


@pytest.mark.parametrize(("error", "lines", "holds"), [(1.1, 1e9, True), (0.9, 1e9, False), (1.1, 1.0, False)], ids=str)
def test_what_noise_may_leave_of_one_record_is_no_miss(error, lines, holds, monkeypatch):
    record, _ = measured(HARD, multisine(4096, rms=20.0), name="high")
    left = judged(TRUTH, record)[0].scores["updated"].nrmse
    noise = Drawn(1000, np.array([0.0, error * left]), np.array([1.0, lines]))
    monkeypatch.setattr("identification.kept_aside.drawn", lambda *_: {"high": noise})

    kept, (told,) = judged(TRUTH, record)

    assert (kept.missed == {}) == holds
    assert ("no more than the force's noise may leave of one record: what was learnt holds there" in told) == holds


def test_what_is_met_is_not_asked_whether_it_may_be_noise(monkeypatch):
    record, _ = measured(TRUTH, multisine(4096), name="kept")
    monkeypatch.setattr("identification.kept_aside.drawn", lambda *_: pytest.fail("drawn"))

    assert judged(TRUTH, record)[0].missed == {}


def test_a_motion_that_some_noise_tears_away_excuses_nothing_and_loses_nothing(monkeypatch):
    def torn(*_):
        raise DivergenceError("gone")

    record, _ = measured(HARD, multisine(4096, rms=20.0), name="high")
    monkeypatch.setattr("identification.kept_aside.drawn", torn)

    kept, _ = judged(TRUTH, record)

    assert set(kept.missed) == {"high"}
    assert set(kept.scores) == {"as given", "updated"}


@pytest.mark.parametrize(("updated", "met"), [(HARD, True), (TRUTH, False)])
def test_what_is_kept_aside_is_predicted_if_it_shows_what_was_found(updated, met, monkeypatch):
    low, _ = measured(HARD, multisine(4096, rms=0.1), name="low")
    high, _ = measured(HARD, multisine(4096, rms=20.0), name="high")

    assert predicted(Told(), [low, high], TRUTH, updated) == met
    assert not predicted(Told(), [low], TRUTH, updated)  # at that level both are right
    assert not predicted(Told(), [], TRUTH, updated)
    assert not predicted(Told(), [frfs_of(TRUTH)], Hypothesis(RIG), TRUTH)

    monkeypatch.setattr("identification.kept_aside.horizons", lambda *_: [Horizon("high", growth=1e9, seconds=1.0)])
    assert not predicted(Told(), [high], TRUTH, updated)


def test_a_model_that_runs_away_predicts_nothing_and_one_that_does_without_the_effect_is_not_met():
    record, _ = measured(TRUTH, multisine(4096, rms=200.0), name="loud")
    runaway = TRUTH.with_effects(QuadraticStiffness(Place(), stiffness=-4e8))

    assert not predicted(Told(), [record], TRUTH, runaway)
    assert predicted(Told(), [record], runaway, TRUTH)


def test_only_what_can_be_followed_is_asked(monkeypatch):
    """A force that grows: the model without the hardening spring is right at the beginning alone."""
    force = multisine(8192) * np.linspace(0.0, 1.0, 8192) ** 4
    record, _ = measured(HARD, force, name="growing")
    asked = judged(TRUTH, record)[0].missed
    monkeypatch.setattr("identification.kept_aside.horizons", lambda *_: [Horizon("growing", growth=1e9, seconds=0.5)])

    kept, decisions = judged(TRUTH, record)

    assert len(asked) == 1
    assert kept.missed == {}
    assert "in its first 0.5 s, beyond which no model can follow it: what was learnt holds there" in decisions[0]
    assert kept.scores["updated"].records[0].nrmse > 0.05  # over the whole record, as it is


@pytest.mark.parametrize(("updated", "holds"), [(TRUTH, True), (Hypothesis(RIG), False)])
def test_frfs_are_judged_too(updated, holds):
    kept, _ = judged(updated, frfs_of(TRUTH))

    assert (kept.missed == {}) == holds


def test_a_model_that_runs_away_does_not_hold():
    """A spring that softens without end, under a force that it does not stand."""
    record, _ = measured(TRUTH, multisine(4096, rms=200.0), name="loud")
    runaway = TRUTH.with_effects(QuadraticStiffness(Place(), stiffness=-4e8))

    kept, decisions = judged(runaway, record)

    assert set(kept.missed) == {"loud"}
    assert dict(kept.scores) == {}
    assert decisions[0].startswith("the updated model does not predict loud, kept aside")


def test_a_model_that_runs_away_on_one_record_is_judged_on_the_others():
    loud, _ = measured(TRUTH, multisine(4096, rms=200.0), name="loud")
    low, _ = measured(TRUTH, multisine(4096, rms=0.1), name="low")
    runaway = TRUTH.with_effects(QuadraticStiffness(Place(), stiffness=-4e8))

    kept, decisions = judged(runaway, loud, low)

    assert set(kept.missed) == {"loud"}
    assert dict(kept.scores) == {}
    lost, met, why = decisions
    assert lost == kept.missed["loud"]
    assert met.startswith("on low, kept aside, ")
    assert met.endswith("holds there")
    assert why == "no error over all records kept aside is told, since the motion is lost in one of them"


def test_a_rig_as_given_that_runs_away_takes_nothing_from_what_was_learnt():
    low, _ = measured(TRUTH, multisine(4096, rms=0.1), name="low")
    runaway = Hypothesis(RIG).with_effects(QuadraticStiffness(Place(), stiffness=-1e16))
    session = Told()

    kept = kept_aside(session, runaway, Hypothesis(RIG), [low])

    assert set(kept.missed) == {"low"}
    assert "the calibrated model" in kept.missed["low"]
    assert dict(kept.scores) == {}
    assert session.decisions[0].startswith("the rig as given does not predict")


def test_nothing_kept_is_nothing_said():
    kept, decisions = judged(TRUTH)

    assert (dict(kept.scores), kept.missed, decisions) == ({}, {}, [])
