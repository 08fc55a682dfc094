"""An effect that explains a second of a test and nothing of the rest is none."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import evaluator_of, measured, multisine, oscillator

from identification.acceptance import accepted, finite_first
from identification.diagnose import _exchanged, _pruned
from identification.evidence import LEAST_EVIDENCE, Ranked, with_evidence
from identification.exchange import Exchange
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.prepare import Horizon, cut_to
from identification.session import Session
from identification.unseen import left_unseen
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.quadratic_stiffness import QuadraticStiffness

RIG = oscillator(mass=1e-5, stiffness=1e-5, damping=1e-4)
BENT = Hypothesis(RIG, effects=(CubicStiffness(Place(), stiffness=2e7),))
N, PART = 8192, 1.0


def session_on(truth, passing=None):
    """A record of the truth, its first second perhaps another's, of which that second is fitted."""
    force = multisine(N, rms=200.0)
    record, noise = measured(truth, force)
    if passing is not None:
        other, _ = measured(passing, force)
        early = np.arange(N) < PART * record.fs
        record = replace(record, responses=np.where(early, other.responses, record.responses))
    everything = evaluator_of((record, noise))
    limits = [Horizon("test", 1.0, 4.0)]
    return Session(everything, cut_to(everything, PART, limits), limits, EFFECTS, lambda _: None, 0)


def fits_on(session):
    """The rig without the effect and with it."""
    base = fit(session.fitting, Hypothesis(RIG), rig_unknowns(RIG), precise=True)
    found = fit(session.fitting, BENT, (*rig_unknowns(RIG), *effect_unknowns(BENT)), precise=True)
    rows = with_evidence([Ranked.of(found)])
    return base, found, rows


def test_a_model_that_is_right_leaves_the_noise_where_nobody_fitted():
    session = session_on(BENT)
    base, found, rows = fits_on(session)

    unseen = left_unseen(session, base, found)
    assert unseen.after == pytest.approx(1.0, abs=0.05)
    assert unseen.before > 1.15
    assert unseen.before**2 == pytest.approx(1.0 + unseen.between**2, rel=0.1)  # the noise knows of neither model
    assert accepted(session, base, rows) is not None
    assert not session.is_passing


def test_an_event_that_passes_is_not_explained_by_a_law():
    session = session_on(Hypothesis(RIG), passing=BENT)
    base, found, rows = fits_on(session)
    assert base.ratio > 1.15
    assert found.ratio < 1.1

    assert accepted(session, base, rows) is None
    assert session.is_passing
    assert "as long as a test lasts" in session.decisions[-1]


def test_an_event_beside_an_effect_says_nothing_of_the_model_without_it():
    """That model may be far from the records, and must not be called complete but for the event."""
    session = session_on(Hypothesis(RIG), passing=BENT)
    base, found, _ = fits_on(session)
    slight = QuadraticStiffness(Place(), stiffness=1e-3)
    beside = replace(base, hypothesis=base.hypothesis.with_effects(slight))
    both = replace(found, hypothesis=replace(found.hypothesis, effects=(slight, *BENT.effects)))

    assert accepted(session, beside, with_evidence([Ranked.of(both)])) is None
    assert "as long as a test lasts" in session.decisions[-1]
    assert not session.is_passing


def test_what_was_fitted_whole_has_no_rest():
    session = session_on(BENT)
    whole = replace(session, fitting=session.everything)
    assert left_unseen(whole, *fits_on(session)[:2]) is None


def test_a_rest_in_which_both_models_are_still_is_no_evidence_against_an_effect():
    """A blow has rung down before the part that was not fitted begins."""
    force = np.where(np.arange(N) < 200, 3e4 * multisine(N, rms=1.0), 0.0)
    quick = oscillator(mass=1e-5, stiffness=1e-5, damping=0.3)
    bent = Hypothesis(quick, effects=BENT.effects)
    everything = evaluator_of(measured(bent, force))
    limits = [Horizon("test", 1.0, 4.0)]
    session = Session(everything, cut_to(everything, PART, limits), limits, EFFECTS, lambda _: None, 0)
    base = fit(session.fitting, Hypothesis(quick), rig_unknowns(quick), precise=True)
    found = fit(session.fitting, bent, (*rig_unknowns(quick), *effect_unknowns(bent)), precise=True)
    assert base.ratio > 1.5
    assert left_unseen(session, base, found).between < 0.3

    assert accepted(session, base, with_evidence([Ranked.of(found)])) is not None


def growing():
    """A session whose force grows, and a spring that softens without end: through the first second alone it holds."""
    force = np.linspace(0.02, 1.0, N) ** 2 * multisine(N, rms=200.0)
    everything = evaluator_of(measured(Hypothesis(RIG), force))
    limits = [Horizon("test", 1.0, 4.0)]
    session = Session(everything, cut_to(everything, PART, limits), limits, EFFECTS, lambda _: None, 0)
    runaway = Hypothesis(RIG, effects=(QuadraticStiffness(Place(), stiffness=-4e8),))
    assert session.fitting.residuals([(runaway, None)])[0] is not None
    return session, runaway


def test_an_effect_that_lets_the_rig_run_away_later_is_not_added():
    session, runaway = growing()
    base, found, _ = fits_on(session_on(BENT))
    rows = with_evidence([Ranked.of(replace(found, hypothesis=runaway))])

    assert session.holds(base.hypothesis)
    assert accepted(session, base, rows) is None
    assert "leaves the finite numbers" in session.decisions[-1]


@pytest.mark.parametrize(("behind", "is_asked"), [(5.0, True), (LEAST_EVIDENCE + 1.0, False)])
def test_what_runs_away_later_gives_way_to_what_is_about_as_probable(behind, is_asked):
    session, runaway = growing()
    _, found, _ = fits_on(session_on(BENT))
    lost = replace(Ranked.of(replace(found, hypothesis=runaway)), log_evidence=0.0)
    stays = replace(Ranked.of(found), log_evidence=-behind)
    unfitted = replace(stays, refitted=False, log_evidence=-100.0)

    rows = finite_first(session, [lost, stays, unfitted])

    assert rows == ([stays, unfitted] if is_asked else [lost, stays, unfitted])
    assert len(session.decisions) == int(is_asked)


def test_a_model_that_runs_away_later_takes_the_place_of_none(monkeypatch):
    """Neither with an effect less nor with another: its errors on whole records could not even be told."""
    session, runaway = growing()
    base, found, rows = fits_on(session_on(BENT))
    lost = replace(found, hypothesis=runaway)
    monkeypatch.setattr("identification.diagnose.pruned", lambda *_, **__: [(0, lost)])
    monkeypatch.setattr("identification.diagnose.exchanged", lambda *_: None)
    monkeypatch.setattr("identification.diagnose.looked_for_anew", lambda *_: Exchange(lost, [[]], ("another",), 0))
    chain, stages = [base, found], []

    assert _pruned(session, chain, [rows], stages, newest=1) == (chain, [rows])
    assert _exchanged(session, chain, [rows], stages, [0]) == (chain, [rows])
    assert stages == []
    assert [told.partition(":")[0] for told in session.decisions] == ["- cubic_stiffness", "another"]
