"""The summed spectrum: its floor in closed form, its chance level, and channels that share their noise."""

import numpy as np
import pytest
from scipy.special import gammaincc
from signal_scenes import FS

from identification.signals.spectrum import summed_spectrum

BAND = (10.0, 900.0)


def noise(n_channels, n=16384, seed=0):
    return np.random.default_rng(seed).normal(size=(n_channels, n))


def test_the_floor_of_white_noise_is_twice_its_variance_over_the_sampling_rate():
    size = np.array([[1.0], [3.0]])
    spectrum = summed_spectrum(size * noise(2), FS, BAND, 1e-3)
    expected = np.broadcast_to(2.0 * size**2 / FS, spectrum.floor.shape)
    np.testing.assert_allclose(spectrum.floor, expected, rtol=0.4)  # medians over 64 lines and more at the low edge
    np.testing.assert_allclose(spectrum.floor.mean(axis=1), expected[:, 0], rtol=0.05)
    assert spectrum.power.mean() == pytest.approx(1.0, abs=0.03)  # of 14 000 lines, half of them independent


@pytest.mark.parametrize("n_channels", [1, 3, 8])
def test_lines_of_noise_exceed_a_level_as_often_as_the_gamma_law_says(n_channels):
    spectrum = summed_spectrum(noise(n_channels, 65536), FS, BAND, 1e-3)
    assert spectrum.shape == pytest.approx(n_channels, rel=0.05)  # the quartiles of 57 000 lines
    for chance in (0.1, 0.01):
        level = np.quantile(np.random.default_rng(1).gamma(n_channels, 1.0 / n_channels, 10**6), 1.0 - chance)
        share = np.mean(spectrum.power > level)
        assert share == pytest.approx(chance, rel=0.3)  # 290 independent lines at 1 %: 6 %; the floors add as much
    assert spectrum.frequency.size * gammaincc(spectrum.shape, spectrum.shape * spectrum.threshold) == pytest.approx(
        1e-3
    )
    assert spectrum.false_alarm(spectrum.threshold) == pytest.approx(1e-3)


def test_channels_that_share_their_noise_count_as_one():
    shared = noise(1) + 0.1 * noise(6, seed=1)
    assert summed_spectrum(shared, FS, BAND, 1e-3).shape == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("slope", [-2, 0, 2])
def test_noise_of_any_colour_lies_level_over_its_floor(slope):
    """The mean power is one in every half octave, also at the lower edge, where the floor is carried outwards."""
    colour = {-2: np.cumsum, 0: np.multiply, 2: np.diff}[slope]
    means = []
    for seed in range(40):
        white = noise(1, 8192, seed)
        signals = colour(white, 1.0) if slope == 0 else colour(white, axis=1)
        spectrum = summed_spectrum(signals, FS, (2.0, 800.0), 1e-3)
        octave = np.floor(2.0 * np.log2(spectrum.frequency / 2.0)).astype(int)
        means.append(np.bincount(octave, spectrum.power) / np.bincount(octave))
    # At the edge the floor's own spread, 0.3 to 0.6, lifts the mean of one over it; higher, 1200 lines and more spread
    # by 3 % and the floor by 8 %.
    np.testing.assert_allclose(np.mean(means, axis=0)[:4], 1.0, atol=0.6)
    np.testing.assert_allclose(np.mean(means, axis=0)[5:], 1.0, atol=0.1)


def test_a_mean_and_a_straight_drift_leave_nothing():
    plain = noise(2)
    drifting = plain + 100.0 + np.linspace(0.0, 50.0, plain.shape[1])
    first, second = (summed_spectrum(x, FS, BAND, 1e-3).power for x in (plain, drifting))
    np.testing.assert_allclose(second, first, rtol=1e-6)  # rounding of 100 times the noise
