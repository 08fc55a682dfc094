"""Laws that a quiet beginning leaves open are told apart by the loud rest of the records."""

from dataclasses import replace

import pytest
from trial_records import OSCILLATOR, evaluator_of, measured, multisine, oscillator, rising_session

from identification import instead
from identification import told_by_all as subject
from identification.evidence import Ranked, misfit_in_common, probabilities
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.instead import ahead_by_all
from identification.outcome import groups_of, members_of
from identification.prepare import Horizon
from identification.session import Session
from identification.told_by_all import MOST_HELD, told_by_all
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.quadratic_stiffness import QuadraticStiffness
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain

HARDER = CubicStiffness(Place(), stiffness=0.3 * OSCILLATOR.structure.stiffness / 1e-3**2)
BENT = QuadraticStiffness(Place(), stiffness=1e-3 * OSCILLATOR.structure.stiffness / 1e-3)
LATE = SensorDelay(Place(sensor="top"), delay=4e-4)


def with_both(truth, beside=(), laws=(HARDER, BENT), seconds=1.0):
    """A session that has fitted the first seconds of four, and a round in which two laws explain them alike."""
    session, calibrated = rising_session(Hypothesis(OSCILLATOR, effects=(*beside, *truth)), seconds)
    found = []
    for effect in laws:
        model = Hypothesis(OSCILLATOR, effects=(*beside, effect))
        unknowns = (*rig_unknowns(OSCILLATOR), *effect_unknowns(model))
        found.append(Ranked.of(fit(session.fitting, model, unknowns, precise=True)))
    return session, calibrated, [found[0], replace(found[1], log_evidence=-0.5)]


def is_open(ranked):
    return groups_of(ranked, probabilities([row.log_evidence for row in ranked])) != ()


def test_a_law_that_fits_the_beginning_alone_is_no_member_any_more():
    session, _, ranked = with_both((HARDER,))
    assert is_open(ranked)

    rows, _ = told_by_all(session, ranked, ranked[0].fit, 0)

    assert not is_open(rows)
    assert rows[0] is ranked[0]
    assert [row.effect for row in rows] == [row.effect for row in ranked]
    assert "as well as cubic_stiffness, but not all" in session.decisions[-1]


def test_a_law_is_held_against_all_of_them_in_the_place_of_its_own_rounds_effect():
    session, _, ranked = with_both((HARDER,), beside=(LATE,))
    assert is_open(ranked)

    rows, _ = told_by_all(session, ranked, ranked[0].fit, 1)

    assert not is_open(rows)


@pytest.fixture
def bent_first():
    """What is hidden comes second on the part: a session, the calibrated model, the round, the one that is ahead."""
    session, calibrated, ranked = with_both((HARDER,), laws=(BENT, HARDER), seconds=2.0)
    assert is_open(ranked)
    rows, (ahead,) = told_by_all(session, ranked, ranked[0].fit, 0)
    return session, calibrated, rows, ahead


def test_what_all_of_them_speak_for_takes_the_place_of_what_came_first(bent_first):
    session, calibrated, rows, ahead = bent_first
    assert ahead.row is rows[1]
    assert ahead.fit.ratio == pytest.approx(1.0, abs=0.05)
    assert is_open(rows)

    other = ahead_by_all(session, calibrated, rows[0].fit, 0, rows, ahead)

    assert other.fit.hypothesis.effects[0].stiffness == pytest.approx(HARDER.stiffness, rel=0.01)
    assert [row.effect.kind for row in other.ranked] == ["cubic_stiffness", "quadratic_stiffness"]
    assert not is_open(other.ranked)
    assert other.ranked[0].log_evidence - other.ranked[1].log_evidence >= 0.5 * ahead.by
    assert told_by_all(session, other.ranked, other.fit, 0) == (other.ranked, [])


@pytest.mark.parametrize("lost", ["established", "finite", "odds", "near"])
def test_what_would_not_stand_itself_takes_no_place(bent_first, monkeypatch, lost):
    session, calibrated, rows, ahead = bent_first
    found, limits, fitting = rows[0].fit, [*session.limits], session.fitting
    if lost == "established":

        def doubted(session, *_):
            session.limits[0], session.pieces = replace(limits[0], seconds=0.1), (None,)
            session.decide("a cut that will not hold")
            return 0, "its size"

        monkeypatch.setattr(instead, "in_doubt", doubted)
    elif lost == "finite":
        monkeypatch.setattr(Session, "holds", lambda *_: False)
    elif lost == "odds":
        ahead = replace(ahead, fit=replace(ahead.fit, penalty=1e9))
    else:
        monkeypatch.setattr(instead, "fit_at", lambda *_: replace(found, chi2=9.0 * found.chi2))

    assert ahead_by_all(session, calibrated, found, 0, rows, ahead) is None

    assert (session.limits, session.pieces, session.fitting) == (limits, (), fitting)
    assert session.decisions == (
        [] if lost == "odds" else ["all records speak for cubic_stiffness, which would not stand itself"]
    )


def test_a_fit_that_stopped_on_its_way_is_gone_on_with_from_the_member(bent_first, monkeypatch):
    session, _, rows, ahead = bent_first
    # As if the right law stood, but far from where it would have come to.
    stopped = replace(ahead.fit, chi2=100.0 * ahead.fit.chi2)
    monkeypatch.setattr(subject._Court, "whole", subject._Stand(session.all_predicted, stopped, 0, session.told_later))

    assert subject._Court(session, rows[0].fit, 0).held(rows[1], rows) == (rows[1], None)


def test_what_fits_all_of_them_as_well_stays_a_member():
    session, _, ranked = with_both((), laws=(replace(HARDER, stiffness=1e-6 * HARDER.stiffness), BENT))

    rows, ahead = told_by_all(session, ranked, ranked[0].fit, 0)

    assert rows == ranked
    assert ahead == []
    assert session.decisions == []


def test_what_sits_in_several_parts_stays_as_it_was(monkeypatch):
    session, _, ranked = with_both((HARDER,))
    monkeypatch.setattr(QuadraticStiffness, "parts", lambda self: (self, self))
    assert told_by_all(session, ranked, ranked[0].fit, 0) == (ranked, [])
    assert told_by_all(session, [ranked[1], ranked[0]], ranked[1].fit, 0) == ([ranked[1], ranked[0]], [])


def test_where_all_was_judged_already_nothing_is_asked_again(monkeypatch):
    session, _, ranked = with_both((HARDER,))
    session.fitting = session.all_predicted
    monkeypatch.setattr(subject, "fit_to_its_end", [])
    assert told_by_all(session, ranked, ranked[0].fit, 0) == (ranked, [])


def test_a_member_of_which_no_fit_stands_stays_open(monkeypatch):
    session, _, ranked = with_both((HARDER,))
    session.to_the_end(ranked[0].fit)

    def lost(*_):
        raise ArithmeticError

    monkeypatch.setattr(subject, "fit_to_its_end", lost)
    assert told_by_all(session, ranked, ranked[0].fit, 0) == (ranked, [])


RIG = oscillator("displacement")
GAIN = SensorGain(Place(sensor="top"), gain=1.1)
DELAY = SensorDelay(Place(sensor="top"), delay=3e-4)
CUBIC = CubicStiffness(Place(), stiffness=3.0 * RIG.structure.stiffness / 1e-3**2)


def fitted(evaluator, *effects, **about):
    model = Hypothesis(RIG, effects=effects)
    return fit(evaluator, model, (*rig_unknowns(RIG), *effect_unknowns(model)), precise=True, **about)


def sketched_beside(*stands, truth=()):
    """A session on all there is, a round of the first effect and one that was only sketched, and the model."""
    pair = measured(Hypothesis(RIG, effects=truth), multisine(rms=2.0, low=10.0), noise=0.01)
    evaluator = evaluator_of(pair)
    session = Session(evaluator, evaluator, [Horizon("test", 2.0, 1.0)], EFFECTS, lambda _: None, 0)
    standing = fitted(evaluator, *stands)
    first, far = Ranked.of(fitted(evaluator, stands[0]), 0), Ranked.of(fitted(evaluator, CUBIC, max_iterations=0))
    return session, [first, replace(far, refitted=False, log_evidence=-0.5)], standing


def test_a_member_that_was_only_sketched_is_fitted():
    session, rows, standing = sketched_beside(GAIN)  # neither is there: both are near to nothing

    (first, other), _ = told_by_all(session, rows, standing, 0)

    assert first is rows[0]
    assert other.refitted
    assert other.fit.chi2 == pytest.approx(fitted(session.fitting, CUBIC).chi2, rel=0.01)
    assert other.log_evidence <= -0.5
    assert members_of([first, other]) == [first, other]


def test_a_member_that_its_fit_excludes_is_none_any_more():
    session, rows, standing = sketched_beside(GAIN, truth=(GAIN,))
    assert members_of(rows) == rows

    (first, other), _ = told_by_all(session, rows, standing, 0)

    behind = (other.fit.chi2 - first.fit.chi2) / misfit_in_common(rows)
    assert behind > 100.0
    assert other.log_evidence == pytest.approx(-0.5 * behind)
    assert members_of([first, other]) == [first]


def test_it_is_fitted_beside_what_stands_in_the_place_of_its_rounds_effect():
    session, rows, standing = sketched_beside(GAIN, DELAY)

    (_, other), _ = told_by_all(session, rows, standing, 0)

    assert [effect.kind for effect in other.fit.hypothesis.effects] == ["cubic_stiffness", "sensor_delay"]
    assert {unknown.effect for unknown in other.fit.unknowns if hasattr(unknown, "effect")} == {0, 1}
    assert other.effect.kind == "cubic_stiffness"


def test_what_is_excluded_is_not_fitted(monkeypatch):
    session, (first, sketch), standing = sketched_beside(GAIN)
    excluded = [first, replace(sketch, log_evidence=-20.0)]
    monkeypatch.setattr(subject, "fit_to_its_end", [])
    assert told_by_all(session, excluded, standing, 0) == (excluded, [])


def test_only_the_most_probable_are_fitted(monkeypatch):
    session, (first, sketch), standing = sketched_beside(GAIN)
    effects = [replace(CUBIC, stiffness=CUBIC.stiffness * number) for number in range(1, MOST_HELD + 3)]
    others = [replace(sketch, effect=e, log_evidence=-0.1 * number) for number, e in enumerate(effects)]
    monkeypatch.setattr(subject, "distinct", list)
    asked = []

    def near(evaluator, start, *_):
        asked.append(start.effects[0])
        return replace(standing, hypothesis=start)

    monkeypatch.setattr(subject, "fit_to_its_end", near)

    rows, _ = told_by_all(session, [first, *others], standing, 0)

    assert asked == effects[:MOST_HELD]
    assert [row.refitted for row in rows[1:]] == [True] * MOST_HELD + [False, False]
