"""Laws that a quiet beginning leaves open are told apart by the loud rest of the records."""

from dataclasses import replace

from trial_records import OSCILLATOR, rising_session

from identification.evidence import Ranked, probabilities
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.outcome import groups_of
from identification.told_by_all import told_by_all
from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.quadratic_stiffness import QuadraticStiffness
from models.effects.sensor_delay import SensorDelay

HARDER = CubicStiffness(Place(), stiffness=0.3 * OSCILLATOR.structure.stiffness / 1e-3**2)
BENT = QuadraticStiffness(Place(), stiffness=1e-3 * OSCILLATOR.structure.stiffness / 1e-3)


LATE = SensorDelay(Place(sensor="top"), delay=4e-4)


def with_both(truth, beside=()):
    """A session that has fitted the first second of four, and a round in which two laws explain it alike."""
    session, _ = rising_session(Hypothesis(OSCILLATOR, effects=(*beside, *truth)), 1.0)
    found = []
    for effect in (HARDER, BENT):
        model = Hypothesis(OSCILLATOR, effects=(*beside, effect))
        unknowns = (*rig_unknowns(OSCILLATOR), *effect_unknowns(model))
        found.append(Ranked.of(fit(session.fitting, model, unknowns, precise=True)))
    return session, [found[0], replace(found[1], log_evidence=-0.5)]


def is_open(ranked):
    return groups_of(ranked, probabilities([row.log_evidence for row in ranked])) != ()


def test_a_law_that_fits_the_beginning_alone_is_no_member_any_more():
    session, ranked = with_both((HARDER,))
    assert is_open(ranked)

    rows = told_by_all(session, ranked, ranked[0].fit, 0)

    assert not is_open(rows)
    assert rows[0] is ranked[0]
    assert [row.effect for row in rows] == [row.effect for row in ranked]
    assert "as well as cubic_stiffness, but not all" in session.decisions[-1]


def test_a_law_is_held_against_all_of_them_in_the_place_of_its_own_rounds_effect():
    session, ranked = with_both((HARDER,), beside=(LATE,))
    assert is_open(ranked)

    rows = told_by_all(session, ranked, ranked[0].fit, 1)

    assert not is_open(rows)


def test_what_sits_in_several_parts_stays_as_it_was(monkeypatch):
    session, ranked = with_both((HARDER,))
    monkeypatch.setattr(QuadraticStiffness, "parts", lambda self: (self, self))
    assert told_by_all(session, ranked, ranked[0].fit, 0) == ranked


def test_what_fits_all_of_them_as_well_stays_as_it_was():
    session, ranked = with_both(())
    assert told_by_all(session, ranked, ranked[0].fit, 0) == ranked
    assert session.decisions == []


def test_where_all_was_judged_already_nothing_is_asked_again(monkeypatch):
    session, ranked = with_both((HARDER,))
    session.fitting = session.all_predicted
    monkeypatch.setattr(session, "fit_of_all", None)
    assert told_by_all(session, ranked, ranked[0].fit, 0) == ranked


def test_a_member_of_which_no_fit_stands_stays_open(monkeypatch):
    session, ranked = with_both((HARDER,))
    session.to_the_end(ranked[0].fit)

    def lost(_):
        raise ArithmeticError

    monkeypatch.setattr(session, "fit_of_all", lost)
    assert told_by_all(session, ranked, ranked[0].fit, 0) == ranked
