"""What noise of a measured excitation does to a residual, drawn where it is carried."""

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.evaluate import carry_noise, unwhitened
from identification.hypothesis import Hypothesis
from identification.noise_changes import changes_by_noise

GIVEN = Hypothesis(REFERENCE)


@pytest.fixture(scope="module")
def evaluator():
    return evaluator_of(measured(GIVEN, multisine(1024, rms=10.0), force_noise=0.01))


def changes(evaluator, seed, jobs=1, realisations=6):
    (target,) = evaluator.timed
    rng = np.random.default_rng(seed)
    return np.array(changes_by_noise(evaluator.with_jobs(jobs), target, GIVEN, rng, realisations))


def test_each_core_draws_what_one_alone_would(evaluator):
    alone = changes(evaluator, 1)
    np.testing.assert_array_equal(changes(evaluator, 1, jobs=2), alone)
    assert len({row.tobytes() for row in alone}) == len(alone)
    assert not np.array_equal(changes(evaluator, 2), alone)


def test_the_changes_are_as_large_as_the_noise_that_a_model_carries(evaluator):
    (target,) = evaluator.timed
    (carried,) = carry_noise(evaluator, GIVEN, np.random.default_rng(3), 64)
    power = np.mean(carried.density - target.density)

    found = np.mean([np.abs(unwhitened(row, target)) ** 2 for row in changes(evaluator, 1, realisations=64)])

    assert found == pytest.approx(power, rel=0.25)


def test_a_motion_that_is_lost_tells_nothing(evaluator, monkeypatch):
    (target,) = evaluator.timed
    monkeypatch.setattr("models.simulate.march_model", lambda *_: 0)
    assert changes_by_noise(evaluator, target, GIVEN, np.random.default_rng(0), 2) == []
