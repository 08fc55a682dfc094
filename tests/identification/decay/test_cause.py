import numpy as np
import pytest
from decay_scenes import FS, OMEGA, noisy

from identification.decay.cause import Watched, find_cause
from identification.decay.course import integral_of
from identification.decay.poles import fit_poles
from identification.decay.smoother import smooth_decay
from identification.decay.verification import verification_decay

T = np.arange(25600) / FS


def watched(signal, snr_db, seed=0):
    """What the smoother sees of one mode's damping and frequency."""
    measured = signal + np.random.default_rng(seed).standard_normal(signal.shape) * 10.0 ** (-snr_db / 20.0) * 0.7
    (mode,) = smooth_decay(measured, FS, fit_poles(measured, FS, [-0.01 + 1j * OMEGA]), np.ones(1))
    level = integral_of(mode.decay.times, mode.decay.rate, mode.blocks.times) + np.log(np.abs(mode.blocks.shape[0]))
    scale = float(np.abs(mode.decay.rate).max())
    return Watched(mode.decay_points, level, scale), Watched(mode.turning_points, level, scale)


def test_a_steady_decay_is_steady():
    damping, frequency = watched((np.exp(-0.01 * T) * np.cos(OMEGA * T))[None], 40.0)
    assert find_cause([damping]).verdict == "steady"
    assert find_cause([frequency]).verdict == "steady"


def test_drag_depends_on_amplitude_to_the_first_power():
    damping, frequency = watched((np.cos(OMEGA * T) / (1.0 + 0.03 * T))[None], 50.0)
    cause = find_cause([damping])
    assert cause.verdict == "amplitude"
    assert cause.law.power == 1.0
    assert find_cause([frequency]).verdict == "steady"


def test_dry_friction_depends_on_amplitude_to_the_power_of_minus_one():
    """A' = -s A - f: sigma = s + f / A."""
    amplitude = (1.0 + 0.5) * np.exp(-0.01 * T) - 0.5
    damping, _ = watched((amplitude * np.cos(OMEGA * T))[None], 60.0)
    cause = find_cause([damping])
    assert (cause.verdict, cause.law.power) == ("amplitude", -1.0)


def test_a_straight_drift_is_one_of_time():
    damping, _ = watched(verification_decay("line").signal[None], 60.0)
    cause = find_cause([damping])
    assert (cause.verdict, cause.law.power) == ("time", 1.0)


def test_a_frequency_that_falls_with_amplitude_squared_is_told_from_a_drift():
    amplitude = np.exp(-0.02 * T)
    phase = OMEGA * T + 0.05 * np.cumsum(amplitude**2) / FS
    _, frequency = watched((amplitude * np.cos(phase))[None], 50.0)
    cause = find_cause([frequency])
    assert (cause.verdict, cause.law.power) == ("amplitude", 2.0)


def test_what_one_decay_cannot_tell_two_of_different_levels_can():
    """A short decay whose damping grows a little with amplitude: alone undecided, beside a weaker one decided."""

    def decay(start):
        t = np.arange(5000) / FS
        return (start * np.cos(OMEGA * t) / (1.0 + 0.03 * start * t))[None]

    pair = [watched(decay(start), 46.0, seed)[0] for seed, start in enumerate((1.0, 0.4))]
    assert find_cause(pair[:1]).verdict in {"undecided", "irregular"}
    assert find_cause(pair).verdict == "amplitude"


def test_probabilities_sum_to_one():
    damping, _ = watched((np.exp(-0.01 * T) * np.cos(OMEGA * T))[None], 40.0)
    assert sum(find_cause([damping]).probabilities.values()) == pytest.approx(1.0)


def test_noise_alone_does_not_make_a_cause():
    verdicts = []
    for seed in range(20):
        signal = noisy((np.exp(-0.01 * T[:8192]) * np.cos(OMEGA * T[:8192]))[None], 40.0, seed)
        damping, _ = watched(signal, 200.0)
        verdicts.append(find_cause([damping]).verdict)
    assert verdicts.count("steady") >= 18
