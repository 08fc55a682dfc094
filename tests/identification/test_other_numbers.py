"""A record kept aside that is missed is explained by a law with other numbers, and by another law not at all."""

from dataclasses import replace

import numpy as np
import pytest
from rest_records import frfs_of
from trial_records import evaluator_of, measured, multisine, oscillator

from identification.conclude import settled
from identification.draws import Drawn
from identification.evaluate import carry_noise
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.kept_aside import kept_aside
from identification.other_numbers import _Court, with_other_numbers
from identification.prepare import Horizon
from identification.reached import NOISE_REACHED
from identification.session import Session
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.quadratic_stiffness import QuadraticStiffness

RIG = oscillator("displacement")
HARD = CubicStiffness(Place(), stiffness=3e-3 * RIG.structure.stiffness / 1e-3**2)
BENT = QuadraticStiffness(Place(), stiffness=1e-3 * RIG.structure.stiffness / 1e-3)
NAME = "at 100 N"


def loud(rms=100.0, high=250.0, **noise):
    """What the hardening spring makes of a louder force."""
    force = multisine(4096, rms=rms, seed=11, low=1.0, high=high)
    return measured(Hypothesis(RIG, effects=(HARD,)), force, name=f"at {rms:g} N", **noise)[0]


def learnt_as(law, *others, rms=10.0, **noise):
    """A session, a law fitted to a record of the hardening spring, and what it is worth on other records."""
    pair = measured(Hypothesis(RIG, effects=(HARD,)), multisine(4096, rms=rms), noise=0.03, **noise)
    everything = evaluator_of(pair, rig=RIG)
    everything = everything.with_targets(carry_noise(everything, Hypothesis(RIG), np.random.default_rng(0)))
    session = Session(everything, everything, [Horizon("test", 1.0, 2.0)], EFFECTS, lambda _: None, 0)
    model = Hypothesis(RIG, effects=(law,))
    found = fit(session.fitting, model, (*rig_unknowns(RIG), *effect_unknowns(model)), precise=True)
    last = settled(session, found)
    return session, last, kept_aside(session, Hypothesis(RIG), last.hypothesis, others)


def test_a_law_whose_size_was_not_told_explains_the_rest_with_another():
    session, last, kept = learnt_as(HARD, loud())
    assert last.ratio == pytest.approx(1.0, abs=0.05)
    assert (set(kept.missed), kept.holds) == ({NAME}, False)
    before = last.hypothesis.effects

    asked = with_other_numbers(session, last, kept)

    assert (asked.explained, asked.holds, asked.scores) == (True, True, kept.scores)
    assert last.hypothesis.effects == before
    words = "with other numbers the same model explains it as well as what was learnt from"
    assert asked.missed == {NAME: f"{kept.missed[NAME]}, but {words}"}
    assert session.decisions[-1] == f"{NAME}: {words}"


def test_a_law_that_is_another_does_not_whatever_its_size():
    session, last, kept = learnt_as(BENT, loud())
    assert last.ratio == pytest.approx(1.0, abs=0.05)
    assert set(kept.missed) == {NAME}

    asked = with_other_numbers(session, last, kept)

    assert (asked.explained, asked.holds, asked.missed) == (False, False, kept.missed)
    assert session.decisions[-1].startswith(f"no numbers of the model explain {NAME} too: ")


@pytest.mark.parametrize(("most", "explained"), [(1e3, None), (1.0, False)])
def test_what_noise_may_leave_of_one_record_refutes_no_law(most, explained, monkeypatch):
    session, last, kept = learnt_as(BENT, loud())
    noise = Drawn(1000, np.ones(2), np.array([1.0, most]))
    monkeypatch.setattr("identification.other_numbers.drawn", lambda *_: {NAME: noise})

    asked = with_other_numbers(session, last, kept)

    assert (asked.explained, asked.holds, asked.missed) == (explained, False, kept.missed)
    told = "the force's noise alone may leave 1000.00 times of it in one test"
    assert any(told in each for each in session.decisions) == (explained is None)


def test_noise_that_the_force_hides_is_no_law_that_is_missing():
    """It fills the whole band, so that its noise is told by what the right numbers leave."""
    session, last, kept = learnt_as(HARD, loud(300.0, high=1000.0, force_noise=0.015), force_noise=0.015)
    assert set(kept.missed) == {"at 300 N"}
    court = _Court.of(session, last, kept.followed, kept)
    assert not court.fitted(court.heard, court.known).explains

    assert with_other_numbers(session, last, kept).explained


def test_a_record_that_holds_says_nothing_of_one_that_is_missed():
    session, last, kept = learnt_as(BENT, loud(), loud(10.0))
    assert set(kept.missed) == {NAME}

    court = _Court.of(session, last, kept.followed, kept)

    assert [target.record.name for target in court.heard.timed] == [NAME]
    assert [target.record.name for target in court.as_told.timed] == [NAME]
    assert court.explained()[0] is False


def test_what_only_says_where_a_fit_stopped_refutes_nothing(monkeypatch):
    session, last, kept = learnt_as(BENT, loud())
    words = f"no numbers were found that explain {NAME} too, and it is not told whether there are any"
    for name, value in (("ASTRAY", 0.005), ("MODELS_APART", 0.1), ("NOISE_REACHED", 10.0)):
        with monkeypatch.context() as patched:
            patched.setattr(f"identification.other_numbers.{name}", value)

            assert with_other_numbers(session, last, kept) is kept

        assert session.decisions[-1] == words


def test_a_step_that_a_fit_has_not_taken_counts_as_taken():
    session, last, kept = learnt_as(BENT, loud())
    court = _Court.of(session, last, kept.followed, kept)
    found = court.fitted(court.heard, court.known)
    assert found.promised == pytest.approx(found.left, rel=1e-3)

    far = replace(found, cost_alone=found.cost_alone, fit=replace(found.fit, jacobian=found.fit.jacobian + 1.0))

    assert far.promised < found.promised


def test_from_numbers_far_off_the_beginnings_of_the_records_lead_to_those_that_explain(monkeypatch):
    """The spring learnt is 2.4 times too stiff, as if nothing near it led away."""
    session, last, kept = learnt_as(HARD, loud())
    known = kept.followed.known
    stuck = known.with_effect_at(0, CubicStiffness(Place(), stiffness=8.0 * HARD.stiffness))
    begun = []
    fitted = _Court.fitted

    def first_is_stuck(court, missed, begin):
        begun.append(begin)
        return fitted(court, missed, begin) if len(begun) > 3 else replace(fitted(court, missed, begin), cost_alone=0.0)

    monkeypatch.setattr(_Court, "fitted", first_is_stuck)
    asked = with_other_numbers(session, last, replace(kept, followed=replace(kept.followed, known=stuck)))

    assert asked.explained
    assert len(begun) == 5


def test_what_was_learnt_from_is_not_given_up_for_what_was_kept_aside():
    session, last, kept = learnt_as(HARD, loud())
    court = _Court.of(session, last, kept.followed, kept)
    found = court.fitted(court.heard, court.known)
    assert found.explains
    learnt, missed = np.split(found.fit.residual, [found.learnt.n_data])

    given_up = replace(found, fit=replace(found.fit, residual=np.concatenate([1.3 * learnt, missed])))

    assert not given_up.explains


def test_a_law_that_holds_is_not_asked_again():
    session, last, kept = learnt_as(HARD, loud(10.0))
    assert (kept.missed, kept.holds) == ({}, True)
    told = len(session.decisions)

    assert with_other_numbers(session, last, kept) is kept
    assert len(session.decisions) == told


def test_a_law_that_leaves_more_than_the_noise_where_it_was_learnt_is_not_asked():
    session, last, kept = learnt_as(BENT, loud(), rms=100.0)
    assert last.ratio > NOISE_REACHED
    assert kept.missed

    assert with_other_numbers(session, last, kept) is kept


def test_small_motion_about_rest_refutes_no_law():
    session, last, kept = learnt_as(HARD, frfs_of(Hypothesis(RIG.with_values({"mass": 1.2 * RIG.structure.mass}))))
    assert len(kept.missed) == 1

    assert with_other_numbers(session, last, kept) is kept
