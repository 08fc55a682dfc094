"""What thinning leaves of a band, and how little it folds into it."""

import numpy as np
import pytest

from models.band_limit import STOP_EDGE
from models.thinning import LEAST_THINNED, WANTED, gain_of, thinned, thinned_to, thinning_taps

FACTORS = (6, 9, 12, 15, 24, 64)


def test_the_least_rate_that_divides_is_left():
    assert [thinned_to(factor) for factor in (1, 2, 3, 4, 5, 7, 13)] == [1, 2, 3, 4, 5, 7, 13]
    assert [thinned_to(factor) for factor in FACTORS] == [2, 3, 2, 3, 2, 2]
    assert all(factor // thinned_to(factor) >= LEAST_THINNED for factor in FACTORS)


@pytest.mark.parametrize("factor", FACTORS)
def test_what_would_be_folded_into_the_band_is_kept_out_and_the_band_is_let_through(factor):
    assert STOP_EDGE < WANTED
    left = thinned_to(factor)
    taps, band = thinning_taps(factor, left), np.linspace(0.0, WANTED, 200)
    assert len(taps) % 2 == 1
    np.testing.assert_allclose(taps, taps[::-1], atol=1e-18)
    images = [(sign * band + k * left) / factor for k in range(1, factor // left // 2 + 1) for sign in (1.0, -1.0)]
    assert max(np.abs(gain_of(taps, image)).max() for image in images) < 1e-9
    assert np.abs(gain_of(taps, band / factor) - 1.0).max() < 1e-6


@pytest.mark.parametrize("factor", FACTORS)
def test_a_tone_in_the_band_keeps_its_phase_and_has_the_known_gain(factor):
    left = thinned_to(factor)
    taps, every, freq = thinning_taps(factor, left), factor // left, 0.31 / factor
    tones = np.stack([np.cos(2.0 * np.pi * freq * np.arange(200 * factor) + phase) for phase in (0.3, 2.0)])
    found = thinned(tones, taps, every)
    inside = slice(len(taps), 200 * left - len(taps))
    np.testing.assert_allclose(found[:, inside], (gain_of(taps, freq) * tones[:, ::every])[:, inside], atol=1e-12)


def test_beyond_the_ends_is_nothing():
    taps = thinning_taps(6, 2)
    signal = np.zeros((1, 300))
    signal[0, [0, 299]] = 1.0
    half, found = len(taps) // 2, thinned(signal, taps, 3)[0]
    expected = np.convolve(signal[0], taps)[half : half + 300 : 3]
    np.testing.assert_allclose(found, expected, atol=1e-15)
