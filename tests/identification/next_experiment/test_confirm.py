"""A separation found from slopes is confirmed by a fit, which follows a number as far as it has to go."""

from dataclasses import replace

import numpy as np
import pytest
from rival_scenes import SIGMA, bench_of, free, gains, heard, ranked_on

from identification.evaluate import Evaluator, TimeTarget
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.next_experiment import confirm
from identification.next_experiment.bench import Bench
from identification.next_experiment.candidates import steady
from identification.next_experiment.confirm import Against, confirmed
from identification.next_experiment.costs import COSTS
from identification.next_experiment.forecast import explained_away, followed, forecast
from identification.next_experiment.rivals import rivals_of
from identification.noise import Noise
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.effects.protocol import Place
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


def dashpot_and_friction():
    """Rivals of which the second slips as fast as nothing moved so far, which a dashpot is; and the old records."""
    rig, sigma = oscillator("displacement"), 1e-6
    given = bench_of(rig, sigma)
    silent = steady(given, COSTS, 1.0, given.band, "level").record("old", given.sensors, 4.0)
    truth = Hypothesis(rig, effects=(PointDamping(Place(), damping=0.5),))
    old = Evaluator([heard(truth, silent, sigma, 1)], 1)
    friction = Hypothesis(rig, effects=(CoulombFriction(Place(), friction_force=0.025, slip_velocity=0.05),))
    return rivals_of(ranked_on(old, [truth, friction], places=False), [0.5, 0.5]), old


def seen_louder(rivals, old):
    bench = Bench.of(rivals[0].hypothesis.rig, old.timed)
    return followed(forecast(bench, rivals, steady(bench, COSTS, 10.0, bench.band, "level"), 1.0, Settings(), 1))


@pytest.fixture
def starts(monkeypatch):
    """Where the fits begin."""
    begun = []

    def seen_from(against, start, *others, **more):
        begun.append(start)
        return fit(against, start, *others, **more)

    monkeypatch.setattr(confirm, "fit", seen_from)
    return begun


def test_a_law_that_holds_the_right_one_within_it_begins_where_it_does_what_that_does(starts):
    (dashpot, rubs), old = dashpot_and_friction()
    # As if its slip velocity were known ten times as well as it is: no slope tells how far it goes.
    rivals = [dashpot, replace(rubs, axes=0.1 * rubs.axes)]
    seen = seen_louder(rivals, old)

    slopes = explained_away(seen, rivals)
    found = confirmed(seen, rivals, old, slopes)

    (begun,) = starts[0].effects
    assert starts[0].values == dashpot.fit.hypothesis.values
    assert begun.slip_velocity > 1.5 * rubs.effect.slip_velocity
    assert slopes[0, 1, 1] > 25.0
    assert found[0, 1, 1] < 4.0
    assert found[1, 0, 0] > 9.0  # a dashpot never rubs


def test_a_number_that_nothing_tells_is_moved_by_its_own_unit(starts):
    """A standard deviation would lead to its end, and past all that the right law does."""
    (dashpot, rubs), old = dashpot_and_friction()
    rivals = [dashpot, replace(rubs, axes=1e3 * rubs.axes)]
    seen = seen_louder(rivals, old)

    confirmed(seen, rivals, old, explained_away(seen, rivals))

    (begun,) = starts[0].effects
    assert 1.5 < begun.slip_velocity / rubs.effect.slip_velocity < 1e4
