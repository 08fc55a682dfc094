"""Bands of planned tests."""

import pytest

from identification.next_experiment.candidates import about


@pytest.mark.parametrize("centre", [0.0, 3.0, 5.0, 20.0, 60.0, 108.0, 253.0])
@pytest.mark.parametrize("band", [(5.0, 108.0), (0.0, 400.0), (5.0, 7.5)])
def test_a_narrow_band_lies_within_the_excitations_wherever_the_model_fails(centre, band):
    low, high = about(centre, band)

    assert band[0] <= low < high <= band[1]


def test_it_holds_the_frequency_where_that_was_excited():
    assert about(60.0, (5.0, 108.0)) == pytest.approx((60.0 / 1.3, 60.0 * 1.3))
    assert about(253.0, (5.0, 108.0)) == pytest.approx((108.0 / 1.3, 108.0))
