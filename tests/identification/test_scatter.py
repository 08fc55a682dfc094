"""Intervals widen where the parts of the records disagree, and only there."""

import numpy as np
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.fit import fit
from identification.hypothesis import Hypothesis, coordinates, rig_unknowns
from identification.intervals import corrected
from identification.scatter import widening
from models.effects import Place
from models.effects.sensor_gain import SensorGain

UNKNOWNS = rig_unknowns(REFERENCE)
TRUTH = Hypothesis(REFERENCE)


def fitted(*effects):
    """The rig's numbers on two records of the truth with effects that the model does not know."""
    truth = TRUTH.with_effects(*effects)
    forces = {"low": multisine(4096, 4, rms=4.0), "high": multisine(4096, 4, rms=12.0, seed=2)}
    evaluator = evaluator_of(*(measured(truth, force, name=name) for name, force in forces.items()), jobs=2)
    return evaluator, fit(evaluator, TRUTH, UNKNOWNS, precise=True, tolerance=0.0)


def pulls(found):
    """Distance of each number from the truth, in standard deviations."""
    return (coordinates(found.hypothesis, UNKNOWNS) - coordinates(TRUTH, UNKNOWNS)) / found.std()


def test_noise_alone_widens_little():
    evaluator, found = fitted()
    factor = widening(evaluator, found, found.jacobian * found.residual)
    assert np.all(factor >= 1.0)
    assert np.median(factor) < 1.3
    assert factor.max() < 2.0


def test_what_every_channel_misses_a_little_widens_to_hold_the_truth():
    gains = 1.0 + 0.001 * np.random.default_rng(3).standard_normal(len(REFERENCE.sensors))
    evaluator, found = fitted(
        *(SensorGain(Place(sensor=s.name), gain=g) for s, g in zip(REFERENCE.sensors, gains, strict=True))
    )
    factor = widening(evaluator, found, found.jacobian * found.residual)
    told = corrected(evaluator, found, np.random.default_rng(0))
    np.testing.assert_allclose(told.std() / found.std(), factor, rtol=0.2)
    before, after = pulls(found), pulls(found) / factor
    assert found.ratio < 1.1
    assert np.sqrt(np.mean(before**2)) > 2.0
    assert np.sqrt(np.mean(after**2)) < 1.7
