"""The floor of a spectrum has no bias, whether all of its bands are quiet or a few."""

import numpy as np
import pytest

from identification.floor import common_floor, expected_extreme, median_over_mean, scatter_of_medians, spectral_floor

REPEATS = 300


def densities(rng, n=640):
    return rng.exponential(size=n)


def test_the_median_of_exponential_numbers_is_known():
    medians = np.median(np.random.default_rng(1).exponential(size=(20000, 25)), axis=1)

    assert medians.mean() == pytest.approx(median_over_mean(25.0), rel=0.01)
    # The asymptotic scatter, 1 / (ln 2 sqrt(n)) of the median, is 3 % too large for 25.
    assert medians.std() / medians.mean() == pytest.approx(scatter_of_medians(25.0), rel=0.06)


def test_the_largest_of_normal_numbers_is_known():
    largest = np.random.default_rng(2).standard_normal((20000, 20)).max(axis=1)

    assert expected_extreme(20) == pytest.approx(largest.mean(), abs=0.02)


def test_a_floor_that_all_bands_share_has_no_bias():
    rng = np.random.default_rng(3)

    found = np.array([spectral_floor(densities(rng), 32, 1.0).density for _ in range(REPEATS)])
    least = np.array([densities(rng).reshape(20, 32).mean(axis=1).min() for _ in range(REPEATS)])

    assert found.mean() == pytest.approx(1.0, abs=0.03)
    assert least.mean() < 0.75


@pytest.mark.parametrize("quiet", [4, 8, 16])
def test_bands_with_signal_are_left_out(quiet):
    rng = np.random.default_rng(4)
    signal = np.where(np.arange(640) < 32 * quiet, 0.0, 10.0)

    found = np.array([spectral_floor(densities(rng) * (1.0 + signal), 32, 1.0).density for _ in range(REPEATS)])

    # A few floors stop early by chance; the mean shows it at four bands.
    assert found.mean() == pytest.approx(1.0, abs=0.07)


def test_signal_everywhere_leaves_few_lines():
    levels = 10.0 ** np.arange(8.0)

    found = common_floor(levels, 32.0)

    assert (found.density, found.n_bands, found.lines) == (1.0, 1, 32.0)
