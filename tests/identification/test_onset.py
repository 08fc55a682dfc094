"""Where a misfit begins, and the search from there: a sweep that comes to what is missing after many seconds."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import (
    FS,
    OSCILLATOR,
    REFERENCE,
    evaluator_of,
    measured,
    multisine,
    oscillator,
    rising_session,
)

from identification.calibrate import pulled
from identification.evaluate import AHEAD
from identification.fit import fit
from identification.hypothesis import Hypothesis
from identification.onset import WINDOW, goes_on, of_whole, onset_of
from identification.rounds import _where_it_shows, view_of
from models.effects import EFFECTS, Place
from models.effects.absorber import Absorber
from models.effects.bouc_wen import BoucWen
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_delay import SensorDelay
from models.effects.wear import Wear
from models.simulate import Motion

HARDENING = CubicStiffness(Place(), stiffness=5e11)


@pytest.mark.parametrize("rig", [oscillator(q) for q in ("displacement", "velocity", "acceleration")] + [REFERENCE])
def test_the_truth_goes_on_from_its_own_state(rig):
    truth = Hypothesis(rig)
    evaluator = evaluator_of(measured(truth, multisine(8192), noise=1e-3, force_noise=1e-9))
    (target,) = evaluator.targets
    motion = truth.motion_at(target.driven, 2777, evaluator.settings)
    later = target.later(2777, "later")

    (residual,) = evaluator.with_targets([later]).residuals([(replace(truth, motions={"later": motion}), None)])
    (at_rest,) = evaluator.with_targets([later]).residuals([(truth, None)])

    assert later.record.n_samples == 8192 - 2777
    assert np.sqrt(np.mean(residual**2)) == pytest.approx(1.0, abs=0.05)
    assert np.sqrt(np.mean(at_rest**2)) > 5.0
    short = later.cut(1000)
    assert short.unjudged == AHEAD
    np.testing.assert_array_equal(short.measured, short.spectrum(short.record.responses))


@pytest.mark.parametrize(
    "effect",
    [
        PointMass(Place(position=0.9), mass=0.1),
        PointDamping(Place(position=0.8), damping=5.0),
        Absorber(Place(position=1.1), mass=0.02, frequency=200.0, damping_ratio=0.1),
    ],
    ids=lambda effect: effect.kind,
)
def test_another_model_takes_up_the_motion_whatever_its_modes(effect):
    """A mode may change its sign or its number; the beam moves on where it was, and what differs is the effect."""
    bare, other = Hypothesis(REFERENCE), Hypothesis(REFERENCE, effects=(effect,))
    evaluator = evaluator_of(measured(bare, multisine(8192), noise=1e-3))
    (target,) = evaluator.targets
    later = evaluator.with_targets([target.later(4000, "later")])
    motion = bare.motion_at(target.driven, 4000, evaluator.settings)

    begun = later.responses(replace(other, motions={"later": motion}))[0].channels
    bare_begun = later.responses(replace(bare, motions={"later": motion}))[0].channels

    first = slice(AHEAD, AHEAD + 20)
    change = np.std(begun[:, first] - bare_begun[:, first]) / np.std(bare_begun[:, first])
    assert change < 0.3


def test_a_misfit_that_begins_late_is_seen_from_there():
    session, base = rising_session(Hypothesis(OSCILLATOR, effects=(HARDENING,)), 1.5)
    whole = session.everything.responses(base.hypothesis)[0].channels
    error = whole - session.everything.timed[0].record.responses
    noise = session.everything.timed[0].noise.sensors[0]
    assert np.std(error[:, : round(FS)]) < 1.1 * noise

    onset = onset_of(session.everything, base.hypothesis, session.limits, {})

    (first,), (limit,) = onset.seconds, onset.limits
    width = round(WINDOW * FS)
    loud = [k for k in range(16) if np.std(error[:, k * width : (k + 1) * width]) > 1.3 * noise]
    assert first == pytest.approx(loud[0] * WINDOW, abs=2.0 * WINDOW)
    assert first > 1.0
    assert limit.seconds == pytest.approx(4.0 - first)
    (target,) = onset.evaluator.timed
    assert limit.record == target.record.name == f"rising from {first:.2f} s"


def test_where_nothing_is_missing_no_misfit_begins():
    session, base = rising_session(Hypothesis(OSCILLATOR), 4.0)

    assert onset_of(session.everything, base.hypothesis, session.limits, {}) is None


def late_channel(delay):
    """A session in which a channel is late and a misfit begins late, and the model that knows of the channel alone."""
    late = SensorDelay(Place(sensor="top"), delay=delay)
    session, base = rising_session(Hypothesis(OSCILLATOR, effects=(HARDENING, late)), 1.5)
    return session, replace(base.hypothesis, values={}, effects=(late,))


def test_what_a_late_channel_looks_back_at_is_not_judged():
    """There it shows what was before the record begins, which its model does not know."""
    session, model = late_channel(0.05)

    onset = onset_of(session.everything, model, session.limits, {})

    (target,) = onset.evaluator.timed
    assert target.unjudged == AHEAD + np.ceil(0.05 * FS)
    (residual,) = onset.evaluator.residuals([(replace(onset.hypothesis, effects=(HARDENING, *model.effects)), None)])
    assert np.sqrt(residual @ residual / onset.evaluator.n_judged) == pytest.approx(1.0, abs=0.05)


def test_a_channel_so_late_that_nothing_is_left_to_judge_shows_no_onset():
    session, model = late_channel(0.8)

    assert onset_of(session.everything, model, session.limits, {}) is None


def test_the_search_moves_to_where_the_misfit_is():
    session, base = rising_session(Hypothesis(OSCILLATOR, effects=(HARDENING,)), 1.0)
    kinds = {"cubic_stiffness": EFFECTS["cubic_stiffness"]}
    view = view_of(session.everything, session.limits, base, kinds, 1.0, 2)

    moved = _where_it_shows(session, session.everything, base, view)

    assert moved.is_late
    assert moved.there.ratio > 2.0 > view.there.ratio
    assert "shows late" in session.decisions[-1]


def test_numbers_that_a_late_misfit_has_pulled_away_do_not_hide_that_it_is_late():
    """Fitted on whole records they leave a misfit from the first, where nothing is missing."""
    session, early = rising_session(Hypothesis(OSCILLATOR, effects=(HARDENING,)), 1.0)
    base = fit(session.everything, early.hypothesis, early.unknowns, precise=True)
    assert pulled(base)
    view = view_of(session.everything, session.limits, base, {"cubic_stiffness": EFFECTS["cubic_stiffness"]}, 1.0, 2)
    assert view.there.ratio > 1.15

    moved = _where_it_shows(session, session.everything, base, view)

    assert moved.is_late
    assert not pulled(moved.there)
    assert moved.there.ratio > 2.0


def test_a_record_that_starts_in_motion_goes_on_from_where_it_is():
    assert goes_on(Hypothesis(OSCILLATOR, starts={"rising": np.array([1e-3, 0.0])}))


def test_the_search_stays_where_the_misfit_shows_from_the_first():
    session, base = rising_session(Hypothesis(OSCILLATOR, effects=(HARDENING,)), 1.0)
    view = view_of(session.everything, session.limits, base, EFFECTS, 4.0, 2)
    assert view.there.ratio > 1.15

    assert _where_it_shows(session, session.everything, base, view) is view


@pytest.mark.parametrize(
    "effect",
    [
        Wear(Place(sleeve="sleeve 1", position=REFERENCE.sleeves[0].position), rate=1e-5),
        BoucWen(Place(position=0.7), force=5.0, yield_displacement=1e-4, exponent=1.0),
    ],
    ids=lambda effect: effect.kind,
)
def test_a_law_with_a_clock_or_a_memory_does_not_go_on_from_a_state(effect):
    assert not goes_on(Hypothesis(REFERENCE, effects=(effect,)))
    assert goes_on(Hypothesis(REFERENCE, effects=(PointMass(Place(position=0.7), mass=0.1),)))


def test_whole_records_keep_what_is_theirs():
    record, _ = measured(Hypothesis(OSCILLATOR), multisine(), name="whole")
    start = np.ones(2)
    found = Hypothesis(
        OSCILLATOR,
        motions={"whole from 1.00 s": Motion((None,), start, start)},
        offsets={"whole": 1.0, "whole from 1.00 s": 2.0},
        own={"whole": {"phase": 1.0}, "whole from 1.00 s": {"phase": 2.0}},
    )

    kept = of_whole(found, [record])

    assert set(kept.offsets) == set(kept.own) == {"whole"}
    assert not kept.motions
