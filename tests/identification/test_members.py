"""What was only sketched is fitted before it is stated as a member of a group."""

from dataclasses import replace

import pytest
from trial_records import evaluator_of, measured, multisine, oscillator

from identification.evidence import Ranked, misfit_in_common
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.members import MOST_FITTED, with_members_fitted
from identification.outcome import members_of
from identification.prepare import Horizon
from identification.session import Session
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain

RIG = oscillator("displacement")
GAIN = SensorGain(Place(sensor="top"), gain=1.1)
DELAY = SensorDelay(Place(sensor="top"), delay=3e-4)
CUBIC = CubicStiffness(Place(), stiffness=3.0 * RIG.structure.stiffness / 1e-3**2)


def fitted(evaluator, *effects, **about):
    model = Hypothesis(RIG, effects=effects)
    return fit(evaluator, model, (*rig_unknowns(RIG), *effect_unknowns(model)), precise=True, **about)


def sketched_beside(*stands, truth=()):
    """A session, and a round: the first of the effects that stand, and one that was only sketched and left far off."""
    pair = measured(Hypothesis(RIG, effects=truth), multisine(rms=2.0, low=10.0), noise=0.01)
    said, evaluator = [], evaluator_of(pair)
    session = Session(evaluator, evaluator, [Horizon("test", 2.0, 1.0)], EFFECTS, said.append, 0)
    first, far = Ranked.of(fitted(evaluator, *stands), 0), Ranked.of(fitted(evaluator, CUBIC, max_iterations=0))
    return session, [first, replace(far, refitted=False, log_evidence=-0.5)], said


def test_a_member_that_was_only_sketched_is_fitted():
    session, rows, said = sketched_beside(GAIN)  # neither is there: both are near to nothing

    first, other = with_members_fitted(session, rows)

    assert first is rows[0]
    assert other.refitted
    assert other.fit.chi2 == pytest.approx(fitted(session.fitting, CUBIC).chi2, rel=0.01)
    assert other.log_evidence <= -0.5
    assert "cubic_stiffness" in said[0]
    assert members_of([first, other]) == [first, other]


def test_a_member_that_its_fit_excludes_is_none_any_more():
    session, rows, _ = sketched_beside(GAIN, truth=(GAIN,))
    assert members_of(rows) == rows

    first, other = with_members_fitted(session, rows)

    behind = (other.fit.chi2 - first.fit.chi2) / misfit_in_common(rows)
    assert behind > 100.0
    assert other.log_evidence == pytest.approx(-0.5 * behind)
    assert members_of([first, other]) == [first]


def test_what_stood_beside_the_first_stands_beside_the_sketched_wherever_the_first_comes_in_order():
    session, rows, _ = sketched_beside(GAIN, DELAY)

    _, other = with_members_fitted(session, rows)

    assert [effect.kind for effect in other.fit.hypothesis.effects] == ["sensor_delay", "cubic_stiffness"]
    assert {unknown.effect for unknown in other.fit.unknowns if hasattr(unknown, "effect")} == {0, 1}
    assert other.effect.kind == "cubic_stiffness"


def test_what_is_excluded_or_no_fit_stands_of_stays_as_it_was(monkeypatch):
    session, (first, sketch), _ = sketched_beside(GAIN)
    excluded = [first, replace(sketch, log_evidence=-20.0)]
    assert with_members_fitted(session, excluded) == excluded

    monkeypatch.setattr("identification.members.refit", lambda *_: None)
    assert with_members_fitted(session, [first, sketch]) == [first, sketch]


def test_only_the_most_probable_are_fitted(monkeypatch):
    session, (first, sketch), _ = sketched_beside(GAIN)
    others = [replace(sketch, log_evidence=-0.1 * number) for number in range(MOST_FITTED + 2)]
    monkeypatch.setattr("identification.members.refit", lambda *_: first.fit)

    rows = with_members_fitted(session, [first, *others])

    assert [row.refitted for row in rows[1:]] == [True] * MOST_FITTED + [False, False]
