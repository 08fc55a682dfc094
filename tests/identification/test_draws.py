"""What noise may leave of one record: far more than in the mean where walls are struck, or where damping is low."""

from types import SimpleNamespace

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine, oscillator

from identification.draws import DRAWS, Drawn, drawn, most_together
from identification.evaluate import Evaluator, carry_noise
from identification.hypothesis import Hypothesis
from identification.kept_aside import kept_aside


def heard_of(rig, force_noise):
    pair = measured(Hypothesis(rig), multisine(4096), force_noise=force_noise)
    everything = evaluator_of(pair, rig=rig)
    return everything.with_targets(carry_noise(everything, Hypothesis(rig), np.random.default_rng(0), 16))


@pytest.mark.parametrize(
    ("rig", "force_noise", "error_strays", "lines_stray"),
    [
        (oscillator(), 0.02, False, False),
        (oscillator(damping_ratio=0.001), 0.02, True, False),  # one resonance holds nearly all of the error
        (REFERENCE, 0.05, True, True),
    ],
)
def test_what_the_most_of_many_draws_leaves(rig, force_noise, error_strays, lines_stray):
    heard = heard_of(rig, force_noise)

    noise = drawn(heard, Hypothesis(rig), 0)["test"]

    assert noise.nrmse.shape == noise.ratio.shape == (DRAWS,)
    assert np.mean(noise.ratio**2) == pytest.approx(1.0, abs=0.15)
    assert np.sqrt(np.mean(noise.nrmse**2)) == pytest.approx(heard.nrmse_of_noise, rel=0.2)
    assert (noise.nrmse.max() > 1.3 * np.median(noise.nrmse)) == error_strays
    assert (noise.ratio.max() > 1.2) == lines_stray


def test_without_noise_of_the_force_every_draw_leaves_the_sensors():
    heard = heard_of(oscillator(), force_noise=0.0)

    noise = drawn(heard, Hypothesis(oscillator()), 0)["test"]

    assert set(noise.nrmse) == {heard.nrmse_of_noise}
    assert set(noise.ratio) == {1.0}


def test_records_count_together_by_their_numbers():
    one = Drawn(300, np.ones(2), np.array([1.0, 2.0]))
    other = Drawn(100, np.ones(2), np.array([3.0, 1.0]))

    assert most_together({"one": one, "other": other}) == pytest.approx(np.sqrt((3 * 4.0 + 1.0) / 4))


def test_the_truth_holds_on_every_record_of_a_rig_that_is_hardly_damped():
    """By the mean of four draws alone some are missed."""
    rig = oscillator(damping_ratio=0.001)
    truth, told = Hypothesis(rig), list[str]()
    session = SimpleNamespace(everything=Evaluator([], 1), seed=0, progress=lambda _: None, decide=told.append)

    for seed in range(12):
        record, _ = measured(truth, multisine(4096), force_noise=0.02, seed=seed)
        assert kept_aside(session, truth, truth, [record]).missed == {}

    assert any("no more than the force's noise may leave of one record" in each for each in told)
