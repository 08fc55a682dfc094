"""What a fitted model leaves corrects the noise downwards, never upwards, and only where it is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import fft
from trial_records import FS, REFERENCE, evaluator_of, measured, moved, multisine, oscillator

from identification.diagnose import diagnose
from identification.evaluate import Evaluator, TimeTarget
from identification.hypothesis import Hypothesis
from identification.noise import estimate_noise
from identification.noise_left import LEAST_LINES, MODEL_ERROR, noise_left, noise_uncovered, with_noise
from models.band_limit import recorder_gain


def filling(n, rms=60.0):
    return rms * np.random.default_rng(5).standard_normal(n)


def taken_for(pair, factor):
    """An evaluator that takes the noise for so many times what it is."""
    record, noise = pair
    return evaluator_of((record, replace(noise, sensors=factor * noise.sensors)))


def left_by(evaluator, hypothesis):
    return evaluator.residuals([(hypothesis, None)])[0]


@pytest.mark.parametrize("n", [2048, 16384])
@pytest.mark.parametrize("share", [0.003, 0.05])
def test_under_a_force_that_fills_the_band_the_true_model_tells_the_noise(n, share):
    """Noise that the recorder filters, too: the stopped band holds none."""
    clean, _ = measured(Hypothesis(REFERENCE), multisine(n, rms=10.0, high=760.0), noise=0.0)
    sensors = share * clean.responses.std(axis=1, keepdims=True)
    white = sensors * np.random.default_rng(3).standard_normal(clean.responses.shape)
    gain = recorder_gain(fft.rfftfreq(n, 1.0 / FS), FS)
    heard = replace(clean, responses=clean.responses + fft.irfft(fft.rfft(white, axis=1) * gain, n, axis=1))
    evaluator = Evaluator([TimeTarget.of(heard, replace(estimate_noise(heard), hidden=False))], 1)

    (found,) = noise_left(evaluator, left_by(evaluator, Hypothesis(REFERENCE)))

    assert np.max(found.sensors / sensors[:, 0]) < 1.1
    assert np.median(found.sensors / sensors[:, 0]) == pytest.approx(1.0, abs=0.06)


def test_noise_taken_right_or_too_low_stays():
    for factor in (0.8, 1.0):
        evaluator = taken_for(measured(Hypothesis(oscillator()), multisine(8192)), factor)

        (found,) = noise_left(evaluator, left_by(evaluator, Hypothesis(oscillator())))

        assert found is evaluator.targets[0].noise


def test_a_model_that_is_far_away_says_nothing():
    evaluator = taken_for(measured(Hypothesis(oscillator()), multisine(8192)), 2.0)

    (found,) = noise_left(evaluator, left_by(evaluator, moved(oscillator(), 0.0, 3.0, 0.0)))

    assert found is evaluator.targets[0].noise


def test_a_model_that_misses_a_little_never_lowers_it_below_the_truth():
    record, noise = measured(Hypothesis(oscillator()), multisine(8192))
    evaluator = taken_for((record, noise), 5.0)
    wrong = moved(oscillator(), 0.0, 0.02, 0.0)

    (found,) = noise_left(evaluator, left_by(evaluator, wrong))

    assert 0.95 * noise.sensors[0] < found.sensors[0] < 1.5 * noise.sensors[0]


def test_a_floor_of_few_lines_is_not_believed():
    record, noise = measured(Hypothesis(oscillator()), multisine(256))
    evaluator = taken_for((record, noise), 5.0)

    assert 0.7 * record.n_samples / 2.0 < LEAST_LINES
    assert noise_left(evaluator, left_by(evaluator, Hypothesis(oscillator())))[0] is evaluator.targets[0].noise


def test_no_noise_is_believed_below_the_error_of_the_model():
    record, _ = measured(Hypothesis(oscillator()), multisine(8192), noise=0.0)
    evaluator = evaluator_of((record, replace(estimate_noise(record), sensors=np.array([1.0]))))

    (found,) = noise_left(evaluator, left_by(evaluator, Hypothesis(oscillator())))

    assert found.sensors[0] == pytest.approx(MODEL_ERROR * record.responses[0].std())


def test_the_hidden_noise_of_an_excitation_is_uncovered_by_its_shape():
    rig = oscillator("displacement")
    record, truth = measured(Hypothesis(rig), filling(8192), noise=0.002, force_noise=0.005)
    noise = replace(truth, excitation=0.0, hidden=True)
    evaluator = evaluator_of((record, noise))

    rng = np.random.default_rng(0)
    (found,) = noise_uncovered(evaluator, Hypothesis(rig), left_by(evaluator, Hypothesis(rig)), rng)
    known = with_noise(evaluator, [found], Hypothesis(rig), rng)

    assert found.excitation == pytest.approx(truth.excitation, rel=0.25)
    assert np.mean(left_by(known, Hypothesis(rig)) ** 2) == pytest.approx(1.0, abs=0.2)


def test_what_a_model_lacks_is_no_hidden_noise():
    rig = oscillator("displacement")
    record, truth = measured(Hypothesis(rig), filling(8192), noise=0.002)
    evaluator = evaluator_of((record, replace(truth, hidden=True)))
    wrong = moved(rig, 0.0, 3.0, 0.0)

    (found,) = noise_uncovered(evaluator, wrong, left_by(evaluator, wrong), np.random.default_rng(0))

    assert found.excitation == 0.0


def test_a_diagnosis_learns_the_noise_and_says_so():
    rig = oscillator("displacement")
    record, truth = measured(moved(rig, 0.5, -0.8, 1.0), filling(4096), noise=0.001)

    found = diagnose(rig, [record], jobs=1)

    assert found.verdict == "complete"
    assert estimate_noise(record).sensors[0] > 5.0 * truth.sensors[0]
    assert found.final.score.records[0].noise.sensors == pytest.approx(truth.sensors, rel=0.06)
    assert any("lowered" in decision for decision in found.decisions)
    assert found.final.score.nrmse == pytest.approx(found.final.score.noise_nrmse, rel=0.1)


def test_a_hidden_force_noise_is_no_missing_effect():
    rig = oscillator("displacement")
    record, truth = measured(moved(rig, 0.5, -0.8, 1.0), filling(4096), noise=0.005, force_noise=0.005)

    found = diagnose(rig, [record], jobs=1)

    assert (found.verdict, found.added) == ("complete", ())
    assert found.final.score.records[0].noise.excitation == pytest.approx(truth.excitation, rel=0.25)
