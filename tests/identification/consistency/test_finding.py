"""Significances: those of a normal number, however large, and larger where the noise's size is known."""

import numpy as np
import pytest
from scipy import stats

from identification.consistency.finding import least_sigma, sigmas_of


@pytest.mark.parametrize("sigma", [0.5, 2.0, 9.0, 30.0])
def test_one_degree_of_freedom_is_the_normal_number_itself(sigma):
    assert sigmas_of(sigma**2, 1) == pytest.approx(sigma, rel=1e-9)


@pytest.mark.parametrize("degrees", [1, 2, 9])
def test_beyond_what_a_float_holds_the_significance_goes_on_growing_smoothly(degrees):
    steps = np.diff([sigmas_of(chi2, degrees) for chi2 in range(1300, 1700, 10)])

    assert min(steps) > 0.0
    # Below 1e-308 the tail's first term stands for it: a share of degrees / chi2 is lost, 0.0002 of a sigma.
    assert np.abs(np.diff(steps)).max() < 0.001


def test_more_degrees_or_a_noise_less_known_make_the_same_chi_square_less_significant():
    assert sigmas_of(25.0, 9) < sigmas_of(25.0, 2) < sigmas_of(25.0, 1)
    assert sigmas_of(25.0, 1, known_by=10.0) < sigmas_of(25.0, 1, known_by=1e9)
    assert sigmas_of(25.0, 1, known_by=10.0) == pytest.approx(stats.norm.isf(stats.t.sf(5.0, 10.0)), rel=1e-6)


def test_nothing_speaks_where_nothing_is_compared():
    assert sigmas_of(25.0, 0) == 0.0
    assert sigmas_of(0.0, 3) == 0.0


def test_the_largest_of_many_exceeds_the_least_as_often_as_asked():
    assert 2.0 * stats.norm.sf(least_sigma(0.01, 20)) * 20 == pytest.approx(0.01)
