"""A contact that begins to touch, as samples see it."""

import numpy as np
import pytest

from models.harmonic_balance.forces import closing, point_force
from models.law import law_address

H, RATE = 2e-4, 0.3


@pytest.mark.parametrize("rate", [RATE, -RATE])
def test_wherever_samples_fall_about_the_touch_they_see_the_same_of_it(rate):
    """A jump of a dashpot, its slope and a spring's impulse, summed over the samples: as without samples."""
    beside = np.arange(-4.0, 5.0)
    for shift in np.linspace(0.0, 1.0, 7):
        times = (beside + shift) * H
        shares, amid = np.transpose([closing(rate * t, rate, H) for t in times])
        nudged = [closing(rate * t + 1e-9, rate, H)[0] for t in times]
        assert ((nudged - shares) / 1e-9).sum() == pytest.approx(1.0 / (H * RATE), rel=2e-4)
        edge = 4.0 - shift if rate < 0.0 else 4.0 + shift
        assert shares.sum() == pytest.approx(edge + 0.5, abs=1e-3)  # the last sample stands for half a step beyond
        # The sum over the samples behind the touch, and the hat's own second moment.
        spring = H * RATE * (0.5 * edge * (edge + 1.0) + 1.0 / 6.0)
        assert (shares * amid).sum() == pytest.approx(spring, abs=1e-3 * H * RATE)


def resisting(t, p, rate, z, c):
    """A normal force that is the same on the way in and out, so that only the number of samples counts."""
    return c[0] * abs(rate)


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5, 0.9])
def test_a_gap_narrower_than_a_sample_is_crossed_from_wall_to_wall(shift):
    """Beyond one wall lie as many samples more than beyond the other as twice the shift says."""
    contact, law, values = np.array([1.0, 0.0, 0.3 * H * RATE, 0.0, 0.0]), law_address(resisting), np.array([50.0])
    places = (np.arange(-6.0, 7.0) + shift) * H * RATE
    forces = [point_force(law, values, 0, contact, place, RATE, H) for place in places]
    assert sum(forces) == pytest.approx(-50.0 * RATE * 2.0 * shift, abs=0.01 * 50.0 * RATE)


def test_closed_and_open_contacts_are_left_alone():
    assert closing(2.0 * H * RATE, RATE, H) == (1.0, 2.0 * H * RATE)
    assert closing(-2.0 * H * RATE, RATE, H) == (0.0, 0.0)
