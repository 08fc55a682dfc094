import numpy as np
import pytest

from identification.decay.colour import left_over, noise_colour


def test_white_noise_has_no_colour():
    residual = np.random.default_rng(0).standard_normal((4, 8192))
    # a median of 300 lines or more is known to 8 %
    assert noise_colour(residual, 512.0, np.array([30.0, 120.0])) == pytest.approx(1.0, abs=0.1)


def test_noise_below_a_low_pass_is_denser_by_what_is_cut_off():
    rng = np.random.default_rng(1)
    spectrum = np.fft.rfft(rng.standard_normal((4, 8192)), axis=1)
    spectrum[:, np.fft.rfftfreq(8192, 1 / 512.0) > 192.0] = 0.0
    residual = np.fft.irfft(spectrum, 8192, axis=1)
    assert noise_colour(residual, 512.0, np.array([30.0]))[0] == pytest.approx(256.0 / 192.0, rel=0.08)


def test_what_modes_of_known_paths_explain_is_taken_away():
    t = np.arange(2048) / 512.0
    waves = np.exp(np.array([-0.5 + 60j, -0.2 + 200j])[:, None] * t)
    signals = np.stack([(waves[0] * (1 + 2j) + waves[1] * 0.3j).real, (waves[1] * 0.2).real])
    assert np.abs(left_over(signals, waves)).max() < 1e-9
