import numpy as np
import pytest

from identification.decay.followed import information_share, long_enough, why_untold
from identification.decay.poles import Poles, pole_covariance

FS = 4096.0


@pytest.mark.parametrize("loss", [1e-3, 0.3, 1.0, 3.0])
def test_the_share_is_that_of_the_integrals(loss):
    """Variance of time under the weight exp(-2 sigma t), in units of the endless one's, times the energy."""
    t = np.linspace(0.0, loss, 200001)  # sigma = 1
    weight = np.exp(-2.0 * t)
    energy, first, second = (np.trapezoid(weight * t**k, t) for k in range(3))
    assert information_share(loss) == pytest.approx(8.0 * (second - first**2 / energy), rel=1e-3)


def test_an_endless_decay_tells_all_and_none_nothing():
    assert information_share(0.0) == 0.0
    assert information_share(20.0) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(("ratio", "share"), [(0.01, 0.05), (0.02, 0.24), (0.09, 0.99)])
def test_what_eight_periods_tell(ratio, share):
    """The figures of docs/theory.md, section 11."""
    assert information_share(2.0 * np.pi * ratio * 8.0) == pytest.approx(share, abs=0.005)


@pytest.mark.parametrize("seconds", [0.02, 0.1, 0.5])
def test_the_bound_in_closed_form_is_that_of_the_poles(seconds):
    ratio, freq, noise = 0.05, 160.0, 1e-2
    pole = 2.0 * np.pi * freq * (1j * np.sqrt(1.0 - ratio**2) - ratio)
    values, shapes = np.array([pole]), np.ones((1, 1), dtype=complex)
    covariance = pole_covariance(values, shapes, np.array([noise]), FS, round(seconds * FS))
    exact = Poles(values, shapes, covariance, np.array([noise])).damping_ratio_stds[0] / ratio
    # sums over samples against integrals, and what the two conjugates share: some percent at three periods
    sigma = 2.0 * np.pi * freq * ratio
    bound = 4.0 * noise * np.sqrt(sigma / FS / information_share(sigma * seconds))
    assert bound == pytest.approx(exact, rel=0.08)


@pytest.mark.parametrize(
    ("ratio", "periods", "enough"),
    [(0.01, 8.1, True), (0.01, 7.9, False), (0.09, 6.3, True), (0.09, 4.9, False), (0.0, 7.0, False)],
)
def test_eight_periods_or_a_fall_of_thirty_decibels(ratio, periods, enough):
    assert long_enough(100.0, 2.0 * np.pi * 100.0 * ratio, periods / 100.0) is enough


def test_a_mode_that_was_lost_is_told_in_words():
    value = np.array([2.0 * np.pi * 153.2 * (1j - 0.06)])
    poles = Poles(value, np.ones((1, 1), dtype=complex), np.eye(2) * 1e-4, np.ones(1))
    assert why_untold(None, poles, 0, np.ones(1)) == (
        "(damping 6.0%) does not stand out of what the other modes leave for long enough to be followed"
    )
