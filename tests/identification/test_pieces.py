"""Parts of a record that begin in motion: the truth leaves the noise in them, and what their start does counts not."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import FS, REFERENCE, evaluator_of, found_with, measured, multisine

from identification.calibrate import beginning
from identification.evaluate import AHEAD, TimeTarget, carry_noise
from identification.fit import fit
from identification.followed_again import begin_again, explains_its_own, fails_in_pieces, go_on
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.noise_left import noise_left
from identification.pieces import SECONDS, Piece, begun_by, fit_from_own_starts, most_missed, pieces_of
from identification.prepare import MIN_SAMPLES, Horizon, cut_to
from identification.session import Session
from models.effects import EFFECTS, Place
from models.effects.bouc_wen import BoucWen
from models.effects.point_mass import PointMass
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_swap import SensorSwap
from models.effects.wear import Wear

TRUTH = Hypothesis(REFERENCE)
FOLLOWED = 1.0
"""S, as if neighbouring motions parted then."""


WRONG = replace(TRUTH, values={"sleeves[0].clearance": 1.1 * REFERENCE.sleeves[0].clearance})


SMALL = PointMass(Place(position=0.5), mass=1e-9)


def pieces_by(model, evaluator, followed=FOLLOWED):
    return pieces_of(evaluator, model, [Horizon("test", 1e4, followed)], 0.8, np.random.default_rng(0))


def ratios(evaluator, pieces, model):
    there = evaluator.with_targets(pieces)
    (residual,) = there.residuals([(model, None)])
    return [float(np.sqrt(part @ part / target.n_judged)) for target, part in there.parts_of(residual)]


@pytest.fixture(scope="module")
def evaluator():
    driven = evaluator_of(measured(TRUTH, multisine(8192, rms=20.0), force_noise=0.005))
    return driven.with_targets(carry_noise(driven, TRUTH, np.random.default_rng(1)))


@pytest.fixture(scope="module")
def pieces(evaluator):
    return pieces_by(TRUTH, evaluator)


def test_the_truth_leaves_the_noise_in_every_piece(evaluator, pieces):
    assert [piece.record.name for piece in pieces] == [f"test from {s:.2f} s" for s in (1.0, 2.0, 3.0)]
    assert all(piece.record.n_samples >= 0.9 * SECONDS * FS for piece in pieces)
    assert ratios(evaluator, pieces, TRUTH) == pytest.approx([1.0] * 3, abs=0.1)


def test_a_channel_that_is_late_by_many_samples_is_met_in_pieces_too():
    """At the start of a piece it tells of motion before that, which nobody has followed."""
    late = SensorDelay(Place(sensor="P3"), delay=0.06)
    truth = Hypothesis(REFERENCE, effects=(late,))
    driven = evaluator_of(measured(truth, multisine(8192, rms=20.0), force_noise=0.005))

    found = pieces_by(truth, driven)

    assert len(found) == 3
    assert ratios(driven, found, truth) == pytest.approx([1.0] * 3, abs=0.1)
    assert {piece.unjudged for piece in found} == {AHEAD + round(0.06 * FS + 0.5)}
    assert all(piece.record.n_samples > MIN_SAMPLES for piece in beginning(driven.with_targets(found), 0.0, 0.1).timed)
    assert pieces_by(replace(truth, effects=(replace(late, delay=0.9 * SECONDS),)), driven) == ()


def test_no_pieces_are_begun_where_all_channels_are_late():
    late = SensorDelay(Place(sensor="P3"), delay=0.06)
    truth = Hypothesis(REFERENCE, effects=(late,))
    driven = evaluator_of(measured(truth, multisine(8192, rms=20.0), force_noise=0.005))
    alone = driven.with_targets([target.only(["P3"]) for target in driven.timed])
    assert pieces_by(truth, alone) == ()


def test_a_channel_that_was_exchanged_with_a_late_one_does_not_tell_a_start():
    late = SensorDelay(Place(sensor="P3"), delay=0.06)
    truth = Hypothesis(REFERENCE, effects=(late, SensorSwap(Place(sensor="P3", other="P5"))))
    driven = evaluator_of(measured(truth, multisine(8192, rms=20.0), force_noise=0.005))

    found = pieces_by(truth, driven)

    assert ratios(driven, found, truth) == pytest.approx([1.0] * 3, abs=0.1)


def test_a_wrong_number_shows_though_the_starts_were_found_by_it(evaluator):
    assert min(ratios(evaluator, pieces_by(WRONG, evaluator), WRONG)) > 2.0


def test_a_model_may_begin_a_piece_elsewhere(evaluator, pieces):
    start = pieces[0].start
    moved = replace(start.begin, velocity=1.01 * start.begin.velocity)
    told = replace(TRUTH, motions={pieces[0].record.name: moved})
    own, begun = (
        evaluator.with_targets([piece]).residuals([(model, None)])[0]
        for piece, model in ((pieces[0], told), (replace(pieces[0], start=replace(start, begin=moved)), TRUTH))
    )
    np.testing.assert_array_equal(own, begun)


def test_the_truth_begins_better_where_a_wrong_model_has_begun(evaluator):
    others = evaluator.with_targets(pieces_by(WRONG, evaluator))
    own, there = begun_by(others, TRUTH)
    before, after = ratios(others, others.timed, TRUTH), ratios(own, own.timed, there)
    assert max(before) > 1.3
    assert after == pytest.approx([1.0] * 3, abs=0.12)
    assert set(there.motions) == {piece.record.name for piece in own.timed}


def test_a_fit_goes_on_from_starts_of_its_own(evaluator):
    unknowns = rig_unknowns(REFERENCE)
    others = evaluator.with_targets(pieces_by(WRONG, evaluator))
    first = fit(others, TRUTH, unknowns, max_iterations=1)
    gone_on = fit_from_own_starts(others, first)
    assert gone_on.ratio < 0.9 * first.ratio
    assert gone_on.ratio == pytest.approx(1.0, abs=0.1)
    without = fit(evaluator, TRUTH, unknowns, max_iterations=1)
    assert fit_from_own_starts(evaluator, without) is without


def test_a_clock_has_run_when_a_piece_begins():
    sleeve = REFERENCE.sleeves[0]
    worn = replace(TRUTH, effects=(Wear(Place(sleeve=sleeve.name), rate=0.02 * sleeve.clearance),))
    evaluator = evaluator_of(measured(worn, multisine(8192, rms=20.0)))
    pieces = pieces_by(TRUTH, evaluator)
    assert [piece.ran for piece in pieces] == [1.0, 2.0, 3.0]
    own, there = begun_by(evaluator.with_targets(pieces), worn)
    assert ratios(own, own.timed, there) == pytest.approx([1.0] * 3, abs=0.2)
    still, there = begun_by(evaluator.with_targets([replace(piece, ran=0.0) for piece in pieces]), worn)
    assert min(ratios(still, still.timed, there)) > 1.3
    assert pieces_by(worn, evaluator) == ()


def test_the_noise_of_a_piece_is_not_lowered_to_what_its_start_left(evaluator, pieces):
    loud = [
        each.with_noise(replace(each.noise, sensors=3.0 * each.noise.sensors)) for each in (*evaluator.timed, *pieces)
    ]
    there = evaluator.with_targets(loud)
    (residual,) = there.residuals([(TRUTH, None)])
    lowered = [noise is not each.noise for noise, each in zip(noise_left(there, residual), loud, strict=True)]
    assert lowered == [True, False, False, False]


def test_another_start_changes_nothing(evaluator, pieces):
    piece = pieces[0]
    begin = piece.start.begin
    pushed = replace(begin, velocity=begin.velocity + 1e-4 * np.abs(begin.velocity).max())
    other = replace(piece, start=replace(piece.start, begin=pushed))
    before, after = (evaluator.with_targets([each]).residuals([(TRUTH, None)])[0] for each in (piece, other))
    plain = [each.response(TRUTH, evaluator.settings).channels for each in (piece, other)]
    shift = np.linalg.norm((plain[1] - plain[0])[:, : piece.record.n_samples] / piece.noise.sensors[:, None])
    assert np.linalg.norm(after - before) < 0.05 * shift


def test_every_number_of_the_start_takes_one_of_the_judged(pieces):
    whole = TimeTarget.of(pieces[0].record, pieces[0].noise, pieces[0].unjudged)
    assert pieces[0].n_judged == whole.n_judged - len(pieces[0].start.slopes)
    assert 10 < len(pieces[0].start.slopes) < 60


def test_a_part_of_a_piece_is_a_piece(pieces):
    short = pieces[0].cut(512)
    assert isinstance(short, Piece)
    assert short.start.slopes.shape == (*pieces[0].start.slopes.shape[:2], 512)
    names = pieces[0].record.sensors[2:5]
    assert pieces[0].only(names).start.slopes.shape[1] == 3


def test_what_a_piece_needs_is_known_of_laws_without_memory_only(evaluator):
    remembering = replace(TRUTH, effects=(BoucWen(Place(position=0.5), 0.1, 1e-4, 1.0),))
    assert pieces_by(remembering, evaluator) == ()
    assert pieces_by(TRUTH, evaluator, followed=3.9) == ()


def test_pieces_are_no_beginnings(evaluator, pieces):
    together = evaluator.with_targets([evaluator.timed[0].cut(2048), *pieces])
    assert [target.record.name for target in beginning(together, 0.1, 0.1).timed] == ["test"]
    assert len(beginning(evaluator.with_targets(pieces), 0.1, 0.1).timed) == 3


def test_those_that_miss_most_come_first(evaluator, pieces):
    limits = [Horizon("test", 1e4, FOLLOWED)]
    begun = cut_to(evaluator, FOLLOWED, limits)
    session = session_on(evaluator, begun.with_targets([*begun.targets, *pieces]), limits)
    base = found_with(session)
    missed = most_missed(session.fitting, base, 1.5)
    left = dict(zip(pieces, ratios(evaluator, pieces, base.hypothesis), strict=True))
    assert len(missed) == 2
    assert left[missed[0]] >= left[missed[1]]


def session_on(evaluator, fitting, limits):
    return Session(evaluator, fitting, limits, EFFECTS, lambda _: None, 0)


@pytest.fixture
def begun_session(evaluator):
    """A session on the first second."""
    limits = [Horizon("test", 1e4, FOLLOWED)]
    return session_on(evaluator, cut_to(evaluator, FOLLOWED, limits), limits)


def test_what_explains_the_beginning_is_tried_on_what_came_after(begun_session):
    right = fit(begun_session.fitting, TRUTH, rig_unknowns(REFERENCE))
    assert not fails_in_pieces(begun_session, right)
    assert fails_in_pieces(begun_session, replace(fit(begun_session.fitting, WRONG, ()), chi2=0.0))
    told = "in 3.0 s that were not fitted, followed again from later starts, "
    assert [words.startswith(told) for words in begun_session.decisions] == [True, True]


def test_what_explained_little_fails_only_where_it_explains_less(begun_session):
    wrong = fit(begun_session.fitting, WRONG, ())
    assert not fails_in_pieces(begun_session, replace(wrong, chi2=100.0 * wrong.chi2))


def test_a_session_goes_on_in_pieces_once(begun_session):
    base = fit(begun_session.fitting, TRUTH, rig_unknowns(REFERENCE))
    far = replace(base, chi2=2.0 * base.chi2)
    assert not begin_again(begun_session, base, far)
    assert go_on(begun_session, base)
    assert [isinstance(target, Piece) for target in begun_session.fitting.timed] == [False, True, True, True]
    assert not go_on(begun_session, base)
    assert not fails_in_pieces(begun_session, base)
    before = begun_session.fitting
    assert not begin_again(begun_session, far, base)
    assert begin_again(begun_session, base, far)
    assert begun_session.fitting is not before
    assert explains_its_own(begun_session, replace(base, hypothesis=replace(TRUTH, effects=(SMALL,))))
