"""By how much a channel is late, from its likeness to the model's."""

import numpy as np
import pytest
from scipy.signal import lfilter
from trial_records import FS, REFERENCE, evaluator_of, measured, multisine

from identification.calibrate import beginning
from identification.hypothesis import Hypothesis
from identification.lag import ALIKE, LONGEST, lag
from identification.scene import Longer, each_sensor, scenes
from models.band_limit import delayed
from models.effects import Place
from models.effects.sensor_delay import SensorDelay

RNG = np.random.default_rng(7)
MODEL = RNG.standard_normal(4096)


@pytest.mark.parametrize("samples", [3, 40, int(LONGEST * 4096) - 1])
@pytest.mark.parametrize("gain", [1.0, 0.2])
def test_a_lag_is_told_to_the_sample_whatever_the_channels_gain(samples, gain):
    late = gain * np.roll(MODEL, samples) + 0.1 * gain * RNG.standard_normal(4096)
    assert lag([(late, MODEL, 1000.0)]).seconds == pytest.approx(samples / 1000.0)


def test_nothing_is_told_of_a_channel_that_is_in_time_early_or_foreign():
    noise = RNG.standard_normal(4096)
    for channel in (MODEL, MODEL + 0.5 * noise, np.roll(MODEL, -20), noise, np.zeros(4096)):
        assert lag([(channel, MODEL, 1000.0)]).seconds == 0.0


def test_a_likeness_of_less_than_half_is_none():
    loud = np.sqrt(1.0 / ALIKE**2 - 1.0)
    for more, told in ((0.8, True), (1.25, False)):
        channel = np.roll(MODEL, 30) + more * loud * RNG.standard_normal(4096)
        assert (lag([(channel, MODEL, 1000.0)]).seconds > 0.0) == told


def test_the_record_that_tells_does_so_in_its_own_seconds():
    foreign, late = RNG.standard_normal(4096), np.roll(MODEL, 25)
    assert lag([(foreign, MODEL, 1000.0), (late, MODEL, 500.0), (MODEL, foreign, 1000.0)]).seconds == pytest.approx(
        0.05
    )


def test_a_record_that_moves_too_slowly_to_tell_silences_no_other():
    slow = np.sin(2.0 * np.pi * 2.0 * np.arange(4096) / 1000.0)
    late = np.roll(slow, 16)
    assert lag([(late, slow, 1000.0)]).seconds == 0.0
    assert lag([(late, slow, 1000.0), (np.roll(MODEL, 16), MODEL, 1000.0)]).seconds == pytest.approx(0.016)


@pytest.mark.parametrize("samples", [17.25, 18.5, 61.5])
def test_between_two_samples_no_other_turn_of_a_lasting_motion_is_taken_for_the_lag(samples):
    """A mode of 300 Hz, hardly damped, at a rate of 2048 Hz: seven samples a turn, and the next turn falls on one."""
    ringing = lfilter([1.0], [1.0, -2.0 * 0.995 * np.cos(2.0 * np.pi * 300.0 / 2048.0), 0.995**2], MODEL)
    late = delayed(ringing, samples)
    assert lag([(late, ringing, 2048.0)]).seconds == pytest.approx(samples / 2048.0, abs=0.1 / 2048.0)


def test_a_late_channel_of_a_rig_is_tried_as_late_as_it_is_and_the_others_as_before():
    late = SensorDelay(Place(sensor="P3"), delay=0.021)
    truth, given = Hypothesis(REFERENCE, effects=(late,)), Hypothesis(REFERENCE)
    evaluator = evaluator_of(measured(truth, multisine(4096, 2, rms=4.0), noise=1e-3))

    seen = scenes(evaluator, given, each_sensor(REFERENCE))

    assert seen[late.place].lag == pytest.approx(late.delay, abs=0.1 / FS)
    assert any(trial.delay == seen[late.place].lag for trial in SensorDelay.trials(seen[late.place]))
    for place, scene in seen.items():
        if place != late.place:
            assert scene.lag == 0.0
            assert len(list(SensorDelay.trials(scene))) == 3


def test_a_lag_that_is_long_beside_what_is_looked_at_is_told_by_longer_records():
    late = SensorDelay(Place(sensor="P3"), delay=0.11)
    truth, given = Hypothesis(REFERENCE, effects=(late,)), Hypothesis(REFERENCE)
    evaluator = evaluator_of(measured(truth, multisine(8192, 2, rms=4.0), noise=1e-3))
    short = beginning(evaluator, 0.0, 0.4)

    alone, told = (
        scenes(short, given, each_sensor(REFERENCE), longer)[late.place].lag
        for longer in (None, Longer.told_by(evaluator, given))
    )

    assert alone != pytest.approx(late.delay, abs=1e-3)
    assert told == pytest.approx(late.delay, abs=0.1 / FS)
