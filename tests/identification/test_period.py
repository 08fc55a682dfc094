"""An excitation that repeats is recognised through noise and a settling start; one that does not is not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from identification.period import find_period, split_periods
from models.errors import InputError

TIME = np.arange(20_000) / 1000.0


def multisine(period, count, lines, seed=0):
    """Random phases, unit amplitudes on ``lines``, cut to ``count`` periods (a fraction is allowed)."""
    spectrum = np.zeros(period // 2 + 1, complex)
    spectrum[lines] = np.exp(2j * np.pi * np.random.default_rng(seed).uniform(size=len(spectrum[lines])))
    return np.resize(period * np.fft.irfft(spectrum, period), round(count * period))


def with_noise(signal, ratio, seed=1):
    return signal + ratio * signal.std() * np.random.default_rng(seed).normal(size=signal.shape)


@given(period=st.integers(200, 1500), count=st.floats(2.0, 8.0), noise=st.sampled_from([0.0, 0.01, 0.02]))
def test_a_multisine_repeats(period, count, noise):
    assert find_period(with_noise(multisine(period, count, slice(1, period // 3)), noise)) == period


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01])
def test_a_multisine_far_below_the_sampling_rate_repeats(noise):
    """Neighbouring lags match within the noise here; the best of them is the period."""
    assert find_period(with_noise(multisine(4000, 4, slice(1, 6)), noise)) == 4000


@pytest.mark.parametrize("noise", [0.04, 0.1])
def test_a_multisine_whose_force_sensor_is_noisy_repeats(noise):
    assert find_period(with_noise(multisine(2000, 4, slice(10, 400)), noise)) == 2000
    assert find_period(with_noise(multisine(500, 2.5, slice(5, 100)), noise)) == 500


def test_what_changes_in_the_excited_band_does_not_repeat():
    """A tenth of the excitation is of its own in each period, at the frequencies of the rest."""
    steady, own = multisine(2000, 4, slice(10, 400)), multisine(8000, 1, slice(40, 1600), seed=2)
    assert find_period(with_noise(steady + 0.1 * own * steady.std() / own.std(), 0.001)) is None


def test_the_shortest_period_is_found_where_only_even_lines_are_excited():
    assert find_period(with_noise(multisine(1000, 5, slice(2, 300, 2)), 0.01)) == 500


def test_a_dominant_line_does_not_hide_the_weak_ones():
    """The strong line alone would repeat after 100 samples; the others hold 2 % of the rms."""
    signal = multisine(1000, 6, slice(1, 300))
    strong = 50.0 * np.sqrt(2.0) * signal.std() * np.sin(2.0 * np.pi * np.arange(signal.size) / 100.0)
    assert find_period(signal + strong) == 1000


def test_a_start_that_differs_is_forgiven():
    signal = np.concatenate((np.zeros(333), multisine(1000, 6, slice(1, 300))))
    assert find_period(with_noise(signal, 0.01)) == 1000


@pytest.mark.parametrize(
    "signal",
    [
        np.random.default_rng(0).normal(size=20_000),
        np.convolve(np.random.default_rng(0).normal(size=20_000), np.hanning(500)),
        np.sin(2.0 * np.pi * (5.0 + 4.0 * TIME) * TIME),
        np.exp(-(((TIME - 0.5) / 0.002) ** 2)),
        np.exp(-TIME),
        TIME,
        np.ones(500),
        with_noise(multisine(1000, 1.9, slice(1, 300)), 0.01),
    ],
    ids=["noise", "narrow-band noise", "sweep", "hammer", "decay", "ramp", "constant", "less than two periods"],
)
def test_what_does_not_repeat_has_no_period(signal):
    assert find_period(signal) is None


def test_several_channels_have_no_single_period():
    with pytest.raises(InputError, match=r"size \(2, 10\); it is one channel, \(N,\); pass one channel"):
        find_period(np.zeros((2, 10)))


def test_periods_are_aligned_to_the_end():
    signals = np.arange(2 * 25).reshape(2, 25) % 25 * 1.0
    periods = split_periods(np.tile(signals[:, -10:], 3)[:, 5:], 10)
    np.testing.assert_array_equal(periods, np.broadcast_to(signals[:, -10:], (2, 2, 10)))


@pytest.mark.parametrize(("noise", "kept"), [(0.0, 4), (0.01, 5)])
def test_unsteady_periods_are_left_out(noise, kept):
    """The transient's share of the rms in period p is 0.63 e^(-2.5 p): 0.05, 0.004 and 0.0004 for p = 1, 2, 3."""
    steady = with_noise(multisine(1000, 7, slice(1, 300)), noise)
    transient = 2.0 * steady.std() * np.exp(-2.5 * np.arange(7000) / 1000.0)
    assert len(split_periods(np.vstack((steady, steady + transient)), 1000)) == kept


def test_a_dead_channel_does_not_judge():
    signals = np.vstack((multisine(500, 4, slice(1, 100)), np.zeros(2000)))
    assert split_periods(signals, 500).shape == (4, 2, 500)


def test_fewer_than_two_periods_are_refused():
    with pytest.raises(InputError, match=r"1999 samples with a period of 1000; at least two whole periods.*; record"):
        split_periods(np.zeros((1, 1999)), 1000)
