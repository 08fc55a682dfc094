import numpy as np
import pytest
from decay_scenes import FS, MASS, OMEGA, line, noisy, rest_modes, ringing, step

from identification.decay.course import Told
from identification.decay.cramer_rao import decay_floor, stepped, straight
from identification.decay.poles import Poles, fit_poles
from identification.decay.smoother import follow_modes, smooth_decay
from identification.decay.verification import verification_decay
from models.errors import InputError
from models.rig_file import read_rig

SEEDS = 6


def errors_of(signal, sigma, snr_db, told=Told()):  # noqa: B008
    """Mean over seeds of the rms error of c = 2 m sigma over the whole record, N s/m, and the share inside."""
    t = np.arange(signal.shape[1]) / FS
    truth, errors, inside = np.array([sigma(now) for now in t]), [], []
    for seed in range(SEEDS):
        measured = noisy(signal, snr_db, seed)
        poles = fit_poles(measured, FS, [-0.004 + 1j * OMEGA])
        (mode,) = smooth_decay(measured, FS, poles, np.ones(1), told)
        errors.append(2.0 * MASS * np.sqrt(np.mean((-mode.decay.at(t) - truth) ** 2)))
        low, high = (-np.interp(t, mode.decay.times, bound) for bound in (mode.decay.high, mode.decay.low))
        inside.append(np.mean((low <= truth) & (truth <= high)))
    return np.mean(errors), np.mean(inside)


@pytest.fixture(scope="module")
def stepping():
    return verification_decay("step").signal[None]


@pytest.fixture(scope="module")
def drifting():
    return verification_decay("line").signal[None]


@pytest.mark.parametrize(("snr_db", "bar"), [(40.0, 0.0018), (60.0, 0.0006)])
def test_a_step_of_the_damping_is_followed_near_the_bound(stepping, snr_db, bar):
    error, inside = errors_of(stepping, step, snr_db)
    assert error < bar
    assert inside > 0.9


@pytest.mark.parametrize(("snr_db", "bar"), [(40.0, 0.0003), (60.0, 0.00005)])
def test_a_drift_of_the_damping_is_followed_near_the_bound(drifting, snr_db, bar):
    error, inside = errors_of(drifting, line, snr_db)
    assert error < bar
    assert inside > 0.9


@pytest.mark.parametrize("snr_db", [40.0, 60.0])
def test_told_the_form_the_bound_is_nearly_met(stepping, drifting, snr_db):
    of = {"omega": OMEGA, "phase": 0.0, "snr_db": snr_db, "fs": FS, "n_samples": 25600}
    for signal, sigma, form, told in (
        (stepping, step, stepped(0.006, 0.001, 50.0), Told(("constant",), 1)),
        (drifting, line, straight(0.006, -0.00002), Told(("line",), 0)),
    ):
        error, _ = errors_of(signal, sigma, snr_db, told)
        # six seeds know the mean of an rms error to a fifth of it
        assert error < 1.5 * 2.0 * MASS * decay_floor(form, **of).rms


def test_a_jump_between_two_blocks_is_no_better_known_than_one_within(stepping):
    """The record begun 37 samples later: nothing depends on where the blocks' edges fall."""
    late = stepping[:, 37:]
    errors = []
    for seed in range(SEEDS):
        measured = noisy(late, 60.0, seed)
        (mode,) = smooth_decay(measured, FS, fit_poles(measured, FS, [-0.004 + 1j * OMEGA]), np.ones(1))
        (jump,) = mode.decay.jumps
        errors.append((jump.time - (50.0 - 37 / FS)) / jump.std)
    assert np.abs(errors).max() < 4.0


def test_damping_that_grows_with_the_amplitude_is_followed():
    """c proportional to amplitude: A = A0 / (1 + b A0 t), so sigma = b A."""
    t = np.arange(25600) / FS
    amplitude = 1.0 / (1.0 + 0.02 * t)
    signal = (amplitude * np.cos(OMEGA * t))[None]
    measured = noisy(signal, 50.0, 0)
    (mode,) = smooth_decay(measured, FS, fit_poles(measured, FS, [-0.01 + 1j * OMEGA]), np.ones(1))
    seen = mode.decay.times < 99.0
    # the interval at 50 dB is about 2 % of sigma there
    assert -mode.decay.rate[seen] == pytest.approx(0.02 / (1.0 + 0.02 * mode.decay.times[seen]), rel=0.05)


@pytest.mark.slow
def test_the_reference_rig_at_rest_is_identified_and_intervals_cover():
    poles, shapes = rest_modes(read_rig("tests/data/reference_rig.toml"), 4)
    freqs, ratios = np.abs(poles) / 2 / np.pi, -poles.real / np.abs(poles)
    start = np.exp(2j * np.pi * np.random.default_rng(1).random(4))[:, None]
    signals = ringing(poles, start * shapes, 2048.0, 8192)
    inside = []
    for seed in range(200):
        found = fit_poles(noisy(signals, 40.0, seed), 2048.0, poles * 1.01)
        assert found.natural_freqs == pytest.approx(freqs, rel=5e-4)
        assert found.damping_ratios == pytest.approx(ratios, rel=0.03)
        of_freq = np.abs(found.natural_freqs - freqs) < 1.96 * found.natural_freq_stds
        of_ratio = np.abs(found.damping_ratios - ratios) < 1.96 * found.damping_ratio_stds
        inside.append(np.concatenate([of_freq, of_ratio]))
    # 200 draws know a share of 95 % to 1.5 %
    assert np.mean(inside, axis=0).min() > 0.90
    assert np.mean(inside, axis=0).max() < 0.995
    assert 0.93 < np.mean(inside) < 0.97


def test_a_mode_that_no_two_blocks_show_is_lost_and_the_others_stay():
    """The second mode is dead after a period and a half, and noise is all that blocks of it show."""
    values = np.array([-8.0 + 2j * np.pi * 81.0, -900.0 + 2j * np.pi * 160.0])
    signals = noisy(ringing(values, np.array([[1.0, 0.8], [0.02, -0.02]]), 4096.0, 4096), 40.0, 0)
    poles = fit_poles(signals, 4096.0, values[:1])
    both = Poles(values, np.vstack([poles.shapes, [[0.02, -0.02]]]), np.eye(4), poles.noise)
    stays, lost = follow_modes(signals, 4096.0, both, np.ones(2))
    assert lost is None
    assert stays.natural_freq.value == pytest.approx(81.01, rel=1e-3)
    with pytest.raises(InputError, match=r"a mode at 214.7 Hz that does not stand out for two blocks; .*; leave it"):
        smooth_decay(signals, 4096.0, both, np.ones(2))
