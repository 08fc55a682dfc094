"""Modes of one window: found, drowned or astray."""

import numpy as np
import pytest
from tapped_scenes import FREQS, FS, RATIOS, WIDTH, poles_of, tapped

from identification.decay.window_fit import fit_window, near_home, standing_out

START = 100 + WIDTH
HOME = poles_of(FREQS * 1.01, RATIOS * 1.5)


def window(n=300, **choices):
    channels, _ = tapped(START + n, period=10**6, **choices)
    return channels[:, START:]


def test_exact_modes_are_found_from_poles_nearby():
    poles, modes = fit_window(window(), FS, HOME, HOME)
    assert modes.tolist() == [0, 1, 2]
    np.testing.assert_allclose(poles.values, poles_of(), rtol=1e-6)  # the search ends at a thousandth of a deviation


def test_modes_of_noise_are_told_from_others():
    signals = window(noise=0.02, amplitudes=(1.0, 0.0, 1.0))
    assert standing_out(signals, FS, poles_of()).tolist() == [True, False, True]
    poles, modes = fit_window(signals, FS, HOME, HOME)
    assert modes.tolist() == [0, 2]
    error = np.abs(poles.damping_ratios - RATIOS[[0, 2]]) / poles.damping_ratio_stds
    assert error.max() < 4.0


@pytest.mark.parametrize(("share", "expected"), [(0.5, False), (2.0, True)])
def test_a_mode_stands_out_above_a_tenth_of_error(share, expected):
    """The log-amplitude's variance is noise^2 / sum |shape|^2 over half the energy of the wave."""
    n, noise = 300, 0.1
    energy = 0.5 * np.sum(np.exp(2.0 * poles_of()[1].real * np.arange(n) / FS))
    shape = np.linalg.norm([0.6, -0.8, 0.3, 0.5])
    amplitude = share * noise * np.sqrt(100.0 + 8.0) / shape / np.sqrt(energy)
    found = standing_out(window(n, noise=noise, amplitudes=(0.0, amplitude, 0.0)), FS, poles_of())
    assert found.tolist() == [False, expected, False]


def test_noise_alone_has_no_modes():
    assert fit_window(window(noise=0.1, amplitudes=(0.0, 0.0, 0.0)), FS, HOME, HOME) is None


def test_a_window_shorter_than_its_unknowns_has_no_modes():
    assert fit_window(window()[:, :11], FS, HOME, HOME) is None


def test_a_pole_far_from_home_went_astray():
    home = poles_of([20.0, 40.0, 100.0])
    poles = poles_of([29.0, 51.0, 100.0])
    assert near_home(poles, np.arange(3), home).tolist() == [True, False, True]


def test_modes_that_went_astray_do_not_spoil_the_others():
    home = poles_of([20.0, 47.0, 75.0])  # the third is not there; the mode at 110 Hz is 17 Hz beyond its room
    found = fit_window(window(noise=1e-3), FS, home, home)
    assert found is not None
    assert 2 not in found[1]
