"""A separation found from slopes is confirmed by a fit, which follows a number as far as it has to go."""

from dataclasses import replace

import numpy as np
import pytest
from rival_scenes import SIGMA, bench_of, free, gains

from identification.evaluate import Evaluator, TimeTarget
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.next_experiment.candidates import steady
from identification.next_experiment.confirm import Against, confirmed
from identification.next_experiment.costs import COSTS
from identification.next_experiment.forecast import explained_away, followed, forecast
from identification.noise import Noise
from models.simulate import Settings
from tests.identification.trial_records import moved, oscillator

BLIND = 1e3
"""Noise of an old record that told nothing, m/s^2."""


def blind_record(bench):
    silent = steady(bench, COSTS, 1.0, bench.band, "level").record("old", bench.sensors, 1.0)
    clean = Hypothesis(bench.rig).simulated(silent, Settings()).channels
    return Evaluator([TimeTarget.of(replace(silent, responses=clean), Noise(np.array([BLIND]), 0.0, "", ""))], 1)


def fitted(rival, old):
    """The rival with a fit to the old record, from which nothing has moved."""
    return replace(rival, fit=fit(old, rival.hypothesis, rig_unknowns(rival.hypothesis.rig), max_iterations=0))


def test_a_fit_follows_a_number_where_slopes_do_not():
    rig = oscillator()
    bench = bench_of(rig, SIGMA)
    old = blind_record(bench)
    rivals = [fitted(free(model), old) for model in (moved(rig, 0.0, 1.5, 0.0), Hypothesis(rig))]
    seen = followed(forecast(bench, rivals, steady(bench, COSTS, 1.0, bench.band, "level"), 1.0, Settings(), 1))

    slopes = explained_away(seen, rivals)
    found = confirmed(seen, rivals, old, slopes)

    assert slopes[0, 1, 1] > 100.0
    # One and a half tolerances cost 1.5^2, in whatever unit residuals are counted.
    assert found[0, 1, 1] == pytest.approx(2.25, abs=0.3)


def test_what_no_number_does_is_confirmed():
    rig, rivals = gains(1.0, 1.2)
    bench = bench_of(rig, 0.3)
    old = blind_record(bench)
    rivals = [replace(fitted(free(r.hypothesis), old), chance=0.5) for r in rivals]
    seen = followed(forecast(bench, rivals, steady(bench, COSTS, 1.0, bench.band, "level"), 1.0, Settings(), 1))

    found = confirmed(seen, rivals, old, explained_away(seen, rivals))

    assert found[0, 1, 1] > 25.0
    assert found[1, 0, 0] > 25.0


def test_a_prediction_stands_for_what_was_measured():
    bench = bench_of(oscillator(), SIGMA)
    old, truth = blind_record(bench), moved(bench.rig, 0.2, -0.1, 0.3)
    (same, other) = Against(old, truth).residuals([(truth, None), (Hypothesis(bench.rig), None)])
    (straight,) = old.residuals([(truth, None)])
    assert np.all(same == 0.0)
    # The old record is the given rig's response.
    assert other == pytest.approx(-straight)
