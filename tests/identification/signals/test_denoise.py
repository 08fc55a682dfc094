"""Denoising: nothing is taken from a clean decay, nearly all from noise, and the words say what."""

import sys

import numpy as np
import pytest
from signal_scenes import BEAM, FS, modes, rms, with_noise

from identification.signals.denoise import (
    WHITE,
    WHITE_FIRST,
    _functions,
    _is_noise,
    _period,
    denoise_ensemble,
    denoise_wavelet,
    noise_rms,
)
from models.errors import InputError

pytest.importorskip("PyEMD", reason="the ensemble needs the package EMD-signal")

SECONDS = 4.0
CLEAN = modes(BEAM, 0.005, seconds=SECONDS, n_channels=2).sum(axis=0)
NOISE = np.random.default_rng(3).normal(size=(2, 8192))


def wavelet(signals):
    return denoise_wavelet(signals, FS)


def ensemble(signals, seed=5, trials=4):
    return denoise_ensemble(signals, FS, seed=seed, trials=trials)


BOTH = pytest.mark.parametrize("denoise", [wavelet, ensemble])


@BOTH
def test_a_clean_decay_loses_nothing(denoise):
    """What of 190 Hz the wavelet lets into the finest level, 5e-6, is taken for noise, and its square taken out."""
    found = denoise(CLEAN)
    assert np.all(found.removed_rms < 1e-9 * rms(CLEAN))
    np.testing.assert_allclose(found.signals, CLEAN, atol=1e-8)


@BOTH
def test_of_white_noise_nearly_all_is_taken(denoise):
    """A coarsest band of a 128th of the spectrum is never shrunk by the wavelets."""
    found = denoise(NOISE)
    assert np.all(found.share_removed > 1.0 - 3.0 / 128.0)
    np.testing.assert_allclose(found.removed_rms, rms(NOISE), rtol=0.05)  # the spread of 8192 samples


@BOTH
@pytest.mark.parametrize("decibels", [20.0, 40.0])
def test_less_noise_is_left_and_what_was_removed_adds_up(denoise, decibels):
    signals = with_noise(CLEAN, decibels)
    found = denoise(signals)
    assert rms(found.signals - CLEAN) < 0.8 * rms(signals - CLEAN)
    removed = signals - found.signals
    np.testing.assert_allclose(found.removed_rms, np.sqrt(np.mean(removed**2, axis=1)), rtol=1e-12)
    power = np.mean(signals**2, axis=1)
    np.testing.assert_allclose(found.share_removed, found.removed_rms**2 / power, rtol=1e-12)


@pytest.mark.parametrize("size", [1e-3, 1.0, 50.0])
def test_the_rms_of_white_noise_under_a_decay(size):
    np.testing.assert_allclose(noise_rms(size * NOISE), size, rtol=0.05)  # 4096 magnitudes: 1.8 %
    signals = 100.0 * size * CLEAN + size * NOISE
    np.testing.assert_allclose(noise_rms(signals), size, rtol=0.05)


def test_the_rms_of_a_clean_decay_is_nothing():
    assert np.all(noise_rms(CLEAN) < 1e-5 * rms(CLEAN))  # the wavelet's stop band at 190 Hz


@BOTH
def test_a_change_of_unit_changes_the_unit_alone(denoise):
    signals = with_noise(CLEAN, 20.0)
    np.testing.assert_allclose(denoise(1e-9 * signals).signals, 1e-9 * denoise(signals).signals, atol=1e-9 * 1e-6)


def test_the_same_seed_gives_the_same_bits_and_another_seed_others():
    signals = (
        np.random.default_rng(0).normal(size=(2, 2048)) + 5.0 * modes((300.0,), 0.001, seconds=1.0, n_channels=2)[0]
    )
    first, again, other = ensemble(signals, 5), ensemble(signals, 5), ensemble(signals, 6)
    np.testing.assert_array_equal(first.signals, again.signals)
    assert first.what == again.what
    assert np.any(first.signals != other.signals)


def test_a_channel_does_not_depend_on_the_channels_after_it():
    signals = with_noise(CLEAN, 20.0)
    np.testing.assert_allclose(ensemble(signals).signals[:1], ensemble(signals[:1]).signals, atol=1e-14)


def test_the_functions_of_noise_are_named_and_the_mode_is_kept():
    """A tone of 30 Hz under a tenth of noise: what oscillates faster than 60 Hz is noise."""
    signals = with_noise(modes((30.0,), 0.001, seconds=SECONDS, n_channels=1)[0], 20.0)
    found = ensemble(signals, trials=16)
    named = [float(word.split(" ")[0]) for word in found.what[0].split("(about ")[1:]]
    assert max(named) > 400.0
    assert not any(20.0 < frequency < 45.0 for frequency in named)
    assert found.what[0].startswith("channel 0: intrinsic mode functions taken for noise: 1 (about ")
    assert "than white noise of rms 0.1" in found.what[0]


def test_the_functions_add_up_to_the_signal_for_their_noise_comes_in_pairs():
    signal = with_noise(CLEAN, 20.0)[0]
    functions = _functions(signal, np.random.default_rng(0), pairs=2, noise_share=0.2)
    np.testing.assert_allclose(functions.sum(axis=0), signal, atol=1e-13)  # rounding of a sum of eleven


def test_white_noise_leaves_the_same_energy_times_period_in_every_function():
    """The law of Wu and Huang; the first function, cut off at half the sampling rate, holds more."""
    functions = _functions(np.random.default_rng(1).normal(size=20480), np.random.default_rng(0), 4, 0.2)
    products = np.array([np.mean(f**2) * _period(f) for f in functions[:7]])
    assert 0.9 * WHITE_FIRST < products[0] < WHITE_FIRST
    assert np.all((products[1:] > 0.7) & (products[1:] < WHITE))


def test_energy_that_noise_would_spread_is_no_noise_in_one_place():
    """A function of 8 samples' period with 80 % of the energy that white noise leaves there, spread or in one tenth."""
    time = np.arange(20480)
    wave = np.sqrt(2.0 * 0.8 * 1.1 / 8.0) * np.cos(2.0 * np.pi * time / 8.0 + 0.1)
    spread, gathered = wave, np.where(time < 2048, np.sqrt(9.991), np.sqrt(0.001)) * wave
    assert rms(gathered) == pytest.approx(rms(spread), rel=1e-3)
    assert _is_noise(spread, 1, 1.0)
    assert not _is_noise(gathered, 1, 1.0)
    assert not _is_noise(2.0 * spread, 1, 1.0)


def test_the_words_name_each_level_with_what_was_done_there():
    found = wavelet(with_noise(CLEAN, 20.0))
    assert found.what[0].startswith("white noise of rms 0.")
    assert found.what[-1] == "512 to 1024 Hz: nothing above the noise, all removed"
    assert found.what[-3].startswith("128 to 256 Hz: threshold 0.0")
    assert found.what[-3].endswith(" % of the power removed")
    assert len(found.what) == 1 + 7  # 8192 samples down to 64 coefficients


@BOTH
def test_a_channel_at_rest_stays_at_rest(denoise):
    found = denoise(np.vstack((CLEAN[0], np.zeros(CLEAN.shape[1]))))
    np.testing.assert_array_equal(found.signals[1], 0.0)
    assert (found.removed_rms[1], found.share_removed[1]) == (0.0, 0.0)


def test_a_missing_package_is_told_with_the_extra_that_brings_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "PyEMD", None)
    with pytest.raises(InputError, match=r"needs the package EMD-signal; run make once, which installs it, or"):
        ensemble(NOISE)


@pytest.mark.parametrize("trials", [0, 1, 7])
def test_an_odd_number_of_trials_is_refused(trials):
    with pytest.raises(
        InputError, match=rf"{trials} trials; trials come in pairs of opposite noise; use {max(trials + 1, 2) // 2 * 2}"
    ):
        ensemble(NOISE, trials=trials)


@BOTH
@pytest.mark.parametrize("signals", [np.ones(4096), np.ones((2, 100)), np.full((1, 4096), np.nan)])
def test_signals_of_another_size_are_refused(denoise, signals):
    with pytest.raises(InputError, match=r"they are \(n_channels, N\) finite samples, N 128 or more; pass one row"):
        denoise(signals)
