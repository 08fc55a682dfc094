"""Every window is an even weight of the same width; half-widths that are known in closed form."""

import numpy as np
import pytest

from identification.decay.windows import GAUSSIAN_REACH, WINDOWS, window_named
from models.errors import InputError

SAMPLING = 2e-3  # the sum over 1000 samples to a side beside the integral, of a weight that ends with a step
HALF_WIDTHS = {
    "gaussian": GAUSSIAN_REACH,
    "hann": 1.0 / np.sqrt(1.0 / 3.0 - 2.0 / np.pi**2),
    "triangular": np.sqrt(6.0),
    "parabolic": np.sqrt(5.0),
    "rectangular": np.sqrt(3.0),
}


@pytest.mark.parametrize("name", WINDOWS)
def test_the_scale_is_the_standard_deviation(name):
    taps = window_named(name).taps(400.0)
    away = np.arange(len(taps)) - len(taps) // 2
    assert np.sqrt(taps @ away**2 / taps.sum()) == pytest.approx(400.0, rel=SAMPLING)


@pytest.mark.parametrize("name", WINDOWS)
def test_a_window_is_an_even_weight_that_is_1_in_the_middle(name):
    taps = window_named(name).taps(33.3)
    assert len(taps) % 2 == 1
    np.testing.assert_array_equal(taps, taps[::-1])
    assert taps[len(taps) // 2] == pytest.approx(1.0, rel=1e-14)
    assert taps.min() >= 0.0


@pytest.mark.parametrize("name", HALF_WIDTHS)
def test_half_widths_in_closed_form(name):
    # The Gaussian is cut where it is 1.5e-8, which takes 4e-7 of its variance.
    assert window_named(name).half_width == pytest.approx(HALF_WIDTHS[name], rel=1e-6)


def test_an_unknown_window_is_refused_with_those_there_are():
    with pytest.raises(InputError, match=r"window = 'flat'; the windows are gaussian, hann, .*rectangular; choose"):
        window_named("flat")
