"""The Morlet transform against its own sum, tones and exponentials in closed form; what the ends do to it."""

import numpy as np
import pytest

from identification.decay.wavelet import REACH, morlet_transform, noise_of_amplitude, scale_of
from models.errors import InputError

FS = 200.0
ROUNDING = 1e-13  # of sums of a thousand numbers of size 1
RNG = np.random.default_rng(0)
FREQUENCIES = np.array([1.0, 7.0, 20.0, 45.0, 99.0])


def by_definition(signal, frequency, centre, b):
    a = centre * FS / (2.0 * np.pi * frequency)
    t = (np.arange(len(signal)) - b) / a
    psi = np.exp(-0.5 * t**2 + 1j * centre * t)
    return 2.0 / (a * np.sqrt(2.0 * np.pi)) * np.sum(signal * psi.conj())


@pytest.mark.parametrize("centre", [3.0, 6.0, 20.0])
def test_it_is_the_sum_that_defines_it(centre):
    """At 99 Hz the wave reaches far beyond half the sampling rate; the sum over samples does not mind."""
    signal = RNG.normal(size=1000)
    found = morlet_transform(signal, FS, FREQUENCIES, centre, ends="zero")
    for row, frequency in zip(found, FREQUENCIES, strict=True):
        expected = [by_definition(signal, frequency, centre, b) for b in range(0, 1000, 37)]
        np.testing.assert_allclose(row[::37], expected, atol=ROUNDING)


def test_its_modulus_on_the_ridge_is_the_amplitude_and_its_argument_the_phase():
    t = np.arange(2000) / FS
    found = morlet_transform(3.0 * np.cos(2.0 * np.pi * 20.0 * t + 0.4), FS, np.array([20.0]))[0, 500:1500]
    expected = 3.0 * np.exp(1j * (2.0 * np.pi * 20.0 * t[500:1500] + 0.4))
    # The image at -20 Hz is exp(-2 omega_0^2) = 1e-31; the sampled Gaussian's sum is its integral to rounding.
    np.testing.assert_allclose(found, expected, atol=3.0 * ROUNDING)


def test_off_the_ridge_it_falls_as_the_gaussian_spectrum():
    t = np.arange(4000) / FS
    frequencies = np.array([18.0, 20.0, 23.0])
    found = np.abs(morlet_transform(np.cos(2.0 * np.pi * 20.0 * t), FS, frequencies)[:, 2000])
    np.testing.assert_allclose(found, np.exp(-0.5 * (6.0 * (20.0 / frequencies - 1.0)) ** 2), rtol=1e-10)


def test_a_decay_keeps_its_logarithmic_slope_exactly():
    """A Gaussian weighs exp(-sigma t) into itself times exp((sigma a)^2 / 2)."""
    t, sigma = np.arange(2000) / FS, 0.8
    found = morlet_transform(np.exp(-sigma * t) * np.cos(2.0 * np.pi * 20.0 * t), FS, np.array([20.0]))[0, 500:1500]
    a = scale_of(np.array(20.0), FS) / FS
    expected = np.exp(-sigma * t[500:1500] + 0.5 * (sigma * a) ** 2)
    np.testing.assert_allclose(np.abs(found), expected, rtol=1e-10)


def test_channels_do_not_meet_and_keep_their_places():
    signals = RNG.normal(size=(2, 3, 500))
    found = morlet_transform(signals, FS, FREQUENCIES, ends="mirror")
    assert found.shape == (2, 3, 5, 500)
    alone = morlet_transform(signals[1, 2], FS, FREQUENCIES, ends="mirror")
    np.testing.assert_allclose(found[1, 2], alone, atol=ROUNDING)


def test_a_mirror_gives_what_the_longer_even_signal_gives():
    signal = RNG.normal(size=400)
    longer = np.concatenate((signal[:0:-1], signal, signal[-2::-1]))
    frequencies = np.array([10.0, 30.0])  # whose waves reach 162 samples at most
    assert REACH * scale_of(frequencies, FS).max() < 399
    found = morlet_transform(signal, FS, frequencies, ends="mirror")
    np.testing.assert_allclose(found, morlet_transform(longer, FS, frequencies, ends="zero")[:, 399:799], atol=ROUNDING)


def test_a_predicted_decay_has_no_edges():
    t = np.arange(2000) / FS
    signal = np.exp(-0.2 * t) * np.cos(2.0 * np.pi * 20.0 * t)
    inside = slice(300, 1700)
    errors = {}
    for ends in ("zero", "mirror", "predicted"):
        found = np.abs(morlet_transform(signal, FS, np.array([20.0]), ends=ends)[0]) / np.exp(-0.2 * t)
        error = np.abs(found - np.median(found[inside]))
        assert error[inside].max() < 1e-9
        errors[ends] = error.max()
    assert errors["zero"] > 0.4  # half of the wave is over the edge
    assert errors["predicted"] < 1e-3  # the prediction fades out over 16 reaches


def test_white_noise_adds_what_is_said():
    frequencies = np.array([7.0, 20.0, 45.0])
    found = morlet_transform(0.5 * RNG.normal(size=(20, 4000)), FS, frequencies, ends="zero")[..., 200:-200]
    rms = np.sqrt(np.mean(np.abs(found) ** 2, axis=(0, 2)))
    # 20 times 18 s hold 1200 windows at 7 Hz, whose mean square is told to 3 %
    np.testing.assert_allclose(rms, noise_of_amplitude(scale_of(frequencies, FS), 0.5), rtol=0.04)


def test_bad_input_is_refused():
    signal = np.ones(100)
    with pytest.raises(InputError, match=r"150 Hz at a sampling rate of 200 Hz; .* between 0 and 100 Hz; pass"):
        morlet_transform(signal, FS, np.array([20.0, 150.0]))
    with pytest.raises(InputError, match=r"frequencies of size \(0,\) at a sampling rate"):
        morlet_transform(signal, FS, np.array([]))
    with pytest.raises(InputError, match=r"centre frequency of 2; a Morlet wave has omega_0 = 3 or more; ask for 6"):
        morlet_transform(signal, FS, FREQUENCIES, 2.0)
    with pytest.raises(InputError, match=r"1 samples that are not finite; .*; cut the record"):
        morlet_transform(np.append(signal, np.nan), FS, FREQUENCIES)
    with pytest.raises(
        InputError, match=r"ends = 'periodic'; a signal is continued by zero, mirror, predicted; choose"
    ):
        morlet_transform(signal, FS, FREQUENCIES, ends="periodic")
