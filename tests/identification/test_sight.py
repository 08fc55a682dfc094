"""What explains the beginning of records tells how far they can be followed."""

from dataclasses import replace

import pytest
from trial_records import OSCILLATOR, evaluator_of, measured, moved, multisine, oscillator, rising_session

from identification.evidence import Ranked
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.prepare import LEAST_TORN, PREDICTABLE_GROWTH, Horizon, cut_to, horizons
from identification.sight import beginnings_of, explained_beginning, refitted_from, shorten
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.end_stop import EndStop

STOP = EndStop(Place(), stiffness=1e7, gap=1e-3)
UNKNOWNS = rig_unknowns(OSCILLATOR)


def test_a_beginning_is_lengthened_from_where_the_shorter_one_has_one_valley():
    """A spring 26 % off over eighty cycles: no fit of all finds it, a tenth of a second tells it well enough."""
    far = oscillator(freq=20.0, damping_ratio=0.003, stiffness=0.1)
    truth = moved(far, -3.0)
    evaluator = evaluator_of(measured(truth, multisine(8192)))
    unknowns = rig_unknowns(far)
    stuck = fit(evaluator, Hypothesis(far), unknowns, precise=True)
    assert stuck.ratio > 2.0

    found = explained_beginning(evaluator, Hypothesis(far), unknowns)

    assert found.ratio == pytest.approx(1.0, abs=0.15)
    assert unknowns[0].get(found.hypothesis) == pytest.approx(-3.0, abs=0.05)


def test_what_is_missing_from_the_first_moment_has_no_explained_beginning():
    truth = Hypothesis(OSCILLATOR, effects=(CubicStiffness(Place(), stiffness=1e12),))
    evaluator = evaluator_of(measured(truth, multisine(4096, rms=200.0)))

    assert explained_beginning(evaluator, Hypothesis(OSCILLATOR), UNKNOWNS) is None


def suspect(session, *effects, seconds):
    """A row as a round leaves it: not fitted to all, begun with what explains so many seconds."""
    found = fit(session.fitting, Hypothesis(OSCILLATOR, effects=effects), UNKNOWNS, max_iterations=0)
    short = cut_to(session.everything, seconds, session.limits)
    begun = fit(short, found.hypothesis, UNKNOWNS, precise=True)
    return Ranked.of(found, sketch=begun) if effects else Ranked(STOP, found, True, 0.0, begun)


def test_no_more_is_fitted_than_what_explains_the_beginning_predicts():
    """Later a stop is struck, and motions part."""
    session, _ = rising_session(replace(moved(OSCILLATOR, 1.0, -1.0, 0.0), effects=(STOP,)), 4.0, force_noise=1e-3)
    row = suspect(session, STOP, seconds=1.0)
    assert row.fit.ratio > 2.0

    assert shorten(session, beginnings_of(session, [row]))

    (limit,) = session.limits
    assert limit.seconds < 3.0
    assert session.fitting.timed[0].record.duration == pytest.approx(limit.seconds, abs=0.01)
    assert "by the model that explains the beginning" in session.decisions[-1]
    assert not shorten(session, beginnings_of(session, [row]))  # a second time nothing is left to shorten


def test_a_calm_record_that_a_model_does_not_explain_is_left_whole():
    spring = CubicStiffness(Place(), stiffness=2e10)
    session, _ = rising_session(Hypothesis(OSCILLATOR, effects=(spring,)), 4.0)
    before, row = session.fitting, suspect(session, seconds=0.5)
    assert row.fit.ratio > 2.0

    assert max(each.n_data for each in beginnings_of(session, [row])) < 0.5 * row.fit.n_data
    assert not shorten(session, beginnings_of(session, [row]))
    assert session.fitting is before


def test_a_suspect_is_refitted_from_where_it_explains_the_beginning_and_stands_in_the_ranking_once():
    truth = replace(moved(OSCILLATOR, 1.0, -1.0, 0.0), effects=(STOP,))
    session, _ = rising_session(truth, 2.0)
    row = suspect(session, STOP, seconds=1.0)
    assert row.fit.ratio > 2.0
    beginnings = beginnings_of(session, [row])

    (better,) = refitted_from(session, beginnings, [row])

    assert better.fit.ratio == pytest.approx(1.0, abs=0.15)
    (again,) = refitted_from(session, beginnings, [better])
    assert again.fit.cost == pytest.approx(better.fit.cost, rel=1e-3)
    assert refitted_from(session, [], [row]) == [row]


def test_a_model_that_leaves_the_finite_numbers_later_shortens_nothing():
    softening = CubicStiffness(Place(), stiffness=-1e12)
    session, _ = rising_session(Hypothesis(OSCILLATOR), 4.0)
    with pytest.raises(ArithmeticError):
        horizons(session.everything, Hypothesis(OSCILLATOR, effects=(softening,)))

    assert not session.shorten_to(Hypothesis(OSCILLATOR, effects=(softening,)))


def test_where_all_is_explained_no_beginning_is_looked_at():
    session, _ = rising_session(Hypothesis(OSCILLATOR, effects=(STOP,)), 4.0)

    assert beginnings_of(session, [suspect(session, STOP, seconds=1.0)]) == []
    assert not shorten(session, [])


@pytest.mark.parametrize("slip_velocity", [1e-3, 1e-5, 1e-7])
def test_motions_do_not_part_where_a_joint_sticks(slip_velocity):
    sticking = CoulombFriction(Place(), friction_force=5.0, slip_velocity=slip_velocity)
    session, _ = rising_session(Hypothesis(OSCILLATOR, effects=(sticking,)), 4.0, force_noise=1e-4)

    (limit,) = horizons(session.everything, Hypothesis(OSCILLATOR, effects=(sticking,)))

    assert limit.growth < 10.0
    assert limit.seconds == pytest.approx(4.0)


@pytest.mark.parametrize(("torn", "shortens"), [(0.5 * LEAST_TORN, False), (2.0 * LEAST_TORN, True)])
def test_motions_that_part_are_left_whole_where_noise_tears_nothing_apart(torn, shortens, monkeypatch):
    session, _ = rising_session(Hypothesis(OSCILLATOR), 4.0)
    before = session.fitting
    parted = Horizon("rising", growth=1e2 * PREDICTABLE_GROWTH, seconds=1.0, torn=torn)
    monkeypatch.setattr("identification.session.horizons", lambda *_: [parted])

    assert session.shorten_to(Hypothesis(OSCILLATOR)) is shortens
    assert (session.fitting is before) is not shortens
