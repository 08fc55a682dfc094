"""A record beside the model's own run of it: where no force is told, the motion stays the model's own."""

from dataclasses import replace

import numpy as np
import pytest

from identification.conclude import _told
from identification.hypothesis import Hypothesis
from identification.locating.beside import RUN_AWAY, runs_beside
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


def test_a_model_that_does_not_move_at_all_has_springs_as_well():
    floating = REFERENCE.model_copy(update={"structure": REFERENCE.structure.model_copy(update={"gravity": 0.0})})
    record, noise = measured(Hypothesis(floating), multisine(2048, rms=6.0, high=300.0))
    still = replace(record, excitation=np.zeros(record.n_samples))

    (run,) = runs_beside(evaluator_of((still, noise), rig=floating), Hypothesis(floating))

    assert np.ptp(run.trace.q) == 0.0
    assert np.all(run.springs > 0.0)


class Listener:
    """A session that is only told."""

    def __init__(self):
        self.decisions = []

    def decide(self, words):
        self.decisions.append(words)


def test_a_force_that_would_move_the_rig_out_of_all_proportion_is_none():
    pair = measured(Hypothesis(REFERENCE, effects=(RUBBING,)), multisine(8192, rms=6.0, high=300.0))
    heard, session = evaluator_of(pair), Listener()
    (run,) = runs_beside(heard, Hypothesis(REFERENCE))
    assert run.is_told
    assert _told(session, heard, [run])[1] == [run]
    assert session.decisions == []

    (astray,) = runs_beside(heard, Hypothesis(REFERENCE))
    astray.settled = replace(run.settled, q=2.0 * RUN_AWAY * run.settled.q)

    assert not astray.is_told
    kept, runs = _told(session, heard, [astray])
    assert (kept.timed, runs) == ((), [])
    assert session.decisions[0].startswith(f"no missing force is told from {run.record.name}: ")
