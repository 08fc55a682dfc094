"""The separation of rivals: its closed form, and what their numbers explain away."""

from dataclasses import replace

import numpy as np
import pytest
from rival_scenes import SIGMA, bench_of, certain, free, gains

from identification.evidence import MODEL_ERROR, unit_of
from identification.hypothesis import Hypothesis
from identification.next_experiment.candidates import released, steady
from identification.next_experiment.costs import COSTS
from identification.next_experiment.forecast import explained_away, followed, forecast
from models.simulate import Settings
from tests.identification.trial_records import FS, REFERENCE, moved, oscillator


def forecast_of(rig, rivals, *, sigma=SIGMA, seconds=2.0):
    bench = bench_of(rig, sigma, seconds=seconds)
    test = steady(bench, COSTS, 1.0, bench.band, "level")
    return forecast(bench, rivals, test, 1.0, Settings(), 1)


def test_the_separation_of_two_gains_is_the_signal_times_their_difference_over_the_noise():
    rig, rivals = gains(1.0, 1.01)
    seen = forecast_of(rig, rivals)

    silent = seen.test.record("next", ("top",), 2.0)
    truth = Hypothesis(rig).simulated(silent, Settings()).channels
    below = np.fft.rfft(truth[0])[: int(0.35 * len(truth[0])) + 1]
    apart = 0.01**2 * 2.0 * np.sum(np.abs(below) ** 2) / len(truth[0]) / SIGMA**2
    expected = apart / unit_of(1.0, 1.0, 1 + 2 * len(below))
    assert seen.scatter()[0, 1, 1] == pytest.approx(expected, rel=1e-6)
    assert seen.scatter()[1, 0, 0] == pytest.approx(expected, rel=1e-6)
    assert seen.scatter()[0, 0, 0] == 0.0


def test_a_longer_test_tells_more_until_the_models_own_error_is_what_is_left():
    rig, rivals = gains(1.0, 1.001)
    d2 = {seconds: forecast_of(rig, rivals, seconds=seconds).scatter()[0, 1, 1] for seconds in (2.0, 4.0, 2000.0)}
    n_data = 2 * (int(0.35 * 2.0 * FS) + 1)
    apart = np.sum(forecast_of(rig, rivals).residuals[1] ** 2)

    assert d2[2.0] < d2[4.0] < 2.0 * d2[2.0]
    assert d2[2000.0] == pytest.approx(apart / n_data / MODEL_ERROR, rel=0.01)


def test_half_the_noise_parts_twice_as_far():
    rig, rivals = gains(1.0, 1.001)
    quiet, loud = forecast_of(rig, rivals), forecast_of(rig, rivals, sigma=2.0 * SIGMA)
    assert quiet.scatter()[0, 1, 1] == pytest.approx(4.0 * loud.scatter()[0, 1, 1], rel=1e-9)


def test_what_a_number_of_the_rig_does_as_well_is_no_difference():
    rig = oscillator()
    stiffer, given = moved(rig, 0.0, 0.02, 0.0), Hypothesis(rig)
    seen = forecast_of(rig, [certain(stiffer), free(given)], sigma=0.3)

    left = explained_away(followed(seen), [certain(stiffer), free(given)])

    assert seen.scatter()[0, 1, 1] > 4.0
    # Moving a number by 0.02 of its tolerance costs 0.02^2; the rest is the stiffness acting out of proportion.
    assert left[0, 1, 1] < 0.1
    # The other way round nothing can move.
    assert left[1, 0, 0] == pytest.approx(seen.scatter()[1, 0, 0], rel=1e-6)


def test_a_difference_that_no_number_makes_stays():
    rig, (one, other) = gains(1.0, 1.05)
    seen = forecast_of(rig, [one, other])
    loose = [replace(free(r.hypothesis), chance=0.5) for r in (one, other)]
    left = explained_away(followed(seen), loose)
    # Mass, stiffness and damping scale the motion too, but not without moving the resonance and 5 % of mass is 5 sigma.
    assert 25.0 < left[0, 1, 1] < seen.scatter()[0, 1, 1]


def test_what_is_held_and_let_go_begins_where_the_hold_bends_it():
    bench = bench_of(REFERENCE, 0.02)
    test = next(iter(released(bench, COSTS)))
    test = replace(test, excitation={**test.excitation, "force": 20.0})
    rivals = [certain(Hypothesis(REFERENCE)), certain(moved(REFERENCE, *([0.5] + [0.0] * 8)))]

    seen = forecast(bench, rivals, test, 1.0, Settings(), 1)

    assert seen.reach > 0.0
    assert seen.evaluator.timed[0].record.excitation is None
    # The state at the start is not known beforehand, so it explains part of any difference.
    assert 0.0 < explained_away(followed(seen), rivals)[0, 1, 1] < seen.scatter()[0, 1, 1]
    assert seen.test.fs == FS
