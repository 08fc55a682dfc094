"""A record beside the model's own run of it: where no force is told, the motion stays the model's own."""

import numpy as np
import pytest

from identification.hypothesis import Hypothesis
from identification.locating.beside import runs_beside
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from tests.identification.trial_records import REFERENCE, evaluator_of, measured, multisine

RUBBING = CoulombFriction(Place(position=0.8), 2.0, 1e-3)


def run_of(*effects, **asked):
    pair = measured(Hypothesis(REFERENCE, effects=effects), multisine(8192, rms=6.0, high=300.0))
    return runs_beside(evaluator_of(pair), Hypothesis(REFERENCE), **asked)[0]


def test_noise_moves_no_law():
    run = run_of()

    assert not np.any(run.settled.by_law)
    np.testing.assert_array_equal(run.settled.q, run.trace.q)


def test_a_probe_takes_the_force_from_the_sleeves():
    plain, probed = run_of(RUBBING), run_of(RUBBING, probe=0.8)

    assert probed.places[0] == pytest.approx(0.8)
    assert probed.settled.missing[0].std() > 1.0
    assert probed.settled.missing[1:].std() < 0.2 * plain.settled.missing.std()


def test_an_unheard_channel_says_nothing():
    heard, unheard = run_of(), run_of(unheard="P6")

    ratio = unheard.variance / heard.variance
    assert np.all(ratio[:, 5] > 1e6)
    np.testing.assert_allclose(np.delete(ratio, 5, axis=1), 1.0)
