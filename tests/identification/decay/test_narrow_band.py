"""The inverse transform of a band against the plain inverse FFT of the whole spectrum."""

import numpy as np
import pytest
from scipy.fft import ifft, rfft

from identification.decay.narrow_band import (
    LANES,
    inverse_of_band,
    n_samples,
    tables,
    transform_length,
    workspace,
)

ROUNDING = 1e-13  # of transforms of a few thousand points
RNG = np.random.default_rng(0)
BANDS = {
    "narrow": (40, 60),
    "one bin": (300, 1),
    "below 0": (-50, 200),
    "past the middle": (2000, 900),
    "whole": (0, 4352),
    "more than whole": (-3000, 9000),
}


def plainly(signal, gains, first, n):
    """The same by folding the gains onto n bins, and a full transform."""
    spectrum = np.fft.fft(signal, n)
    weights = np.zeros(n)
    np.add.at(weights, np.arange(first, first + len(gains)) % n, gains)
    return n * ifft(spectrum * weights)


def by_band(signal, gains, first, n, length, size):
    out = np.empty(size, complex)
    inverse_of_band(rfft(signal, n), gains, first, tables(n, length), workspace(n), out)
    return out


@pytest.mark.parametrize("length", [512, 256, 128, 2])
@pytest.mark.parametrize("name", BANDS)
def test_every_band_and_every_length_of_transform_give_the_plain_inverse(name, length):
    first, n_bins = BANDS[name]
    n = n_samples(4100)
    assert n == 4608
    signal, gains = RNG.normal(size=4000), RNG.normal(size=n_bins)
    expected = plainly(signal, gains, first, n)[:4000]
    found = by_band(signal, gains, first, n, length, 4000)
    np.testing.assert_allclose(found, expected, atol=ROUNDING * np.abs(expected).max())


@pytest.mark.parametrize("least", [1, 2, 7, 100, 4097, 52030])
def test_all_samples_come_out_whatever_their_number(least):
    n = n_samples(least)
    assert least <= n <= max(1.125 * least, least + 1)
    signal, gains = RNG.normal(size=least), RNG.normal(size=3)
    length = transform_length(n, 3)
    assert n % length == 0
    expected = plainly(signal, gains, 0, n)
    np.testing.assert_allclose(
        by_band(signal, gains, 0, n, length, n), expected, atol=ROUNDING * np.abs(expected).max()
    )


def test_a_wide_band_gets_long_transforms_and_a_narrow_one_short_ones():
    n = n_samples(52000)
    assert transform_length(n, 100) < transform_length(n, 20000)
    assert n // transform_length(n, n) >= LANES // 2
