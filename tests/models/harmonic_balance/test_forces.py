"""A contact that begins to touch, as samples see it."""

import numpy as np
import pytest

from models.harmonic_balance.forces import closing

H, RATE = 2e-4, 0.3


@pytest.mark.parametrize("rate", [RATE, -RATE])
def test_wherever_samples_fall_about_the_touch_they_see_the_same_of_it(rate):
    """A jump of a dashpot, its slope and a spring's impulse, summed over the samples: as without samples."""
    beside = np.arange(-4.0, 5.0)
    for shift in np.linspace(0.0, 1.0, 7):
        times = (beside + shift) * H
        shares, amid = np.transpose([closing(rate * t, rate, H) for t in times])
        nudged = [closing(rate * t + 1e-9, rate, H)[0] for t in times]
        after = times[times * rate > 0.0]
        assert ((nudged - shares) / 1e-9).sum() == pytest.approx(1.0 / (H * RATE), rel=2e-4)
        edge = 4.0 - shift if rate < 0.0 else 4.0 + shift
        assert shares.sum() == pytest.approx(edge + 0.5, abs=1e-3)  # the last sample stands for half a step beyond
        assert (shares * amid).sum() - (rate * after).sum() == pytest.approx(0.0, abs=0.25 * H * RATE)


def test_closed_and_open_contacts_are_left_alone():
    assert closing(2.0 * H * RATE, RATE, H) == (1.0, 2.0 * H * RATE)
    assert closing(-2.0 * H * RATE, RATE, H) == (0.0, 0.0)
