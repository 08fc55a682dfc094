"""Modes separated at cut frequencies: the theorem, closed forms, sums, and what the treatment of the ends is worth."""

import numpy as np
import pytest
from scipy.signal import hilbert
from signal_scenes import BEAM, FS, modes, rms, with_noise

from identification.signals.separate import EXTENSION_CYCLES, separate, split
from models.errors import InputError

BEAM_CUTS = np.array([22.0, 82.0, 151.0])


def end_errors(parts, truth, fs, frequencies, cycles=10):
    """Error of each part over its mode's first periods, as a share of the mode."""
    errors = []
    for part, mode, frequency in zip(parts, truth, frequencies, strict=True):
        n = round(cycles * fs / frequency)
        errors.append(rms((part - mode)[:, :n]) / rms(mode[:, :n]))
    return np.array(errors)


def untreated(signals, fs, cuts, mode):
    """The parts where the record is put between zeros or between its mirror images."""
    n = signals.shape[-1]
    length = min(round(EXTENSION_CYCLES * fs / cuts.min()), n - 1)
    padded = np.pad(signals, ((0, 0), (length, length)), mode=mode)
    held = np.repeat(cuts[:, None], padded.shape[-1], axis=1)
    return split(padded, fs, held)[..., length : length + n]


def test_it_is_the_theorem_of_chen_and_wang():
    """sin H[x cos] - cos H[x sin] of a record that is periodic, where Hilbert transforms by FFT are exact."""
    n = 4096
    time = np.arange(n) / FS
    signal = np.cos(2.0 * np.pi * 20.0 * time + 0.3) + 0.7 * np.sin(2.0 * np.pi * 31.0 * time)
    theta = 2.0 * np.pi * 25.0 * time
    low = np.sin(theta) * hilbert(signal * np.cos(theta)).imag - np.cos(theta) * hilbert(signal * np.sin(theta)).imag
    parts = split(signal, FS, np.full((1, n), 25.0))
    np.testing.assert_allclose(parts[0], low, atol=1e-11)  # rounding of four transforms
    np.testing.assert_allclose(parts[0], np.cos(2.0 * np.pi * 20.0 * time + 0.3), atol=1e-11)


def test_nothing_folds_at_half_the_sampling_rate():
    """x cos(theta) would fold 900 Hz + 300 Hz at 1024 Hz; turning the analytic signal back does not."""
    n = 4096
    time = np.arange(n) / FS
    low, high = np.cos(2.0 * np.pi * 150.0 * time), np.cos(2.0 * np.pi * 900.0 * time)
    parts = split(low + high, FS, np.full((1, n), 300.0))
    np.testing.assert_allclose(parts, [low, high], atol=1e-11)  # rounding


@pytest.mark.parametrize("cuts", [BEAM_CUTS, np.array([9.2]), np.empty(0)], ids=["three", "one", "none"])
def test_the_parts_sum_to_the_signal(cuts):
    signals = with_noise(modes(BEAM, 0.005, seconds=4.0).sum(axis=0), 20.0) + 3.0
    parts = separate(signals, FS, cuts)
    assert parts.shape == (cuts.size + 1, *signals.shape)
    np.testing.assert_allclose(parts.sum(axis=0), signals, atol=1e-14 * np.abs(signals).max())  # rounding of a sum


def test_a_mean_belongs_to_the_lowest_part():
    parts = separate(np.full((2, 3000), 5.0), FS, np.array([50.0]))
    np.testing.assert_allclose(parts[0, :, 300:-300], 5.0, rtol=1e-3)  # the steps down at the extension's ends


@pytest.mark.parametrize(
    ("damping", "decibels", "worst", "gain"),
    # Without noise the error is the taper's skirt, and grows with damping, which shortens the taper. Under noise it is
    # the noise that the part itself holds, the most in the highest, from 151 to 1024 Hz.
    [
        (0.001, None, 1e-6, 1e5),
        (0.005, None, 3e-5, 5000.0),
        (0.02, None, 2e-3, 150.0),
        (0.005, 60.0, 2e-3, 80.0),
        (0.005, 20.0, 0.2, 1.4),
    ],
)
def test_ends_continued_by_poles_leave_less_error_than_zeros_or_mirrors(damping, decibels, worst, gain):
    """Over each mode's first ten periods; zeros and mirrors leave 4 to 26 % there."""
    truth = modes(BEAM, damping)
    signals = truth.sum(axis=0)
    if decibels is not None:
        signals = with_noise(signals, decibels)
    poles = end_errors(separate(signals, FS, BEAM_CUTS), truth, FS, BEAM)
    zeros, mirrors = (
        end_errors(untreated(signals, FS, BEAM_CUTS, mode), truth, FS, BEAM) for mode in ("constant", "reflect")
    )
    assert poles.max() < worst
    assert np.all(gain * poles < np.minimum(zeros, mirrors))


@pytest.mark.parametrize(
    ("frequencies", "fs", "seconds", "damping"),
    [
        ((9.0, 9.45), 2048.0, 20.0, 0.003),
        ((181.0, 190.0), 2048.0, 20.0, 0.003),
        ((2.0, 2.1), 256.0, 100.0, 0.002),
        ((9.0, 9.45, 56.0, 190.0), 2048.0, 20.0, 0.003),
    ],
)
@pytest.mark.parametrize("decibels", [None, 40.0])
def test_modes_five_percent_apart(frequencies, fs, seconds, damping, decibels):
    """Within 2 % of each over its first ten periods, where zeros and mirrors leave 20 % and more."""
    truth = modes(frequencies, damping, fs, seconds)
    signals = truth.sum(axis=0)
    if decibels is not None:
        signals = with_noise(signals, decibels)
    cuts = np.sqrt(np.array(frequencies[:-1]) * np.array(frequencies[1:]))
    errors = end_errors(separate(signals, fs, cuts), truth, fs, frequencies)
    assert errors.max() < 0.02  # the taper's skirts reach over a cut 2.5 % away; measured 0.003 to 0.01
    for mode in ("constant", "reflect"):
        assert end_errors(untreated(signals, fs, cuts, mode), truth, fs, frequencies).max() > 0.2


def test_a_cut_that_moves_parts_tones_whose_bands_overlap():
    """A tone falls from 60 to 30 Hz, another from 100 to 50 Hz: no constant cut parts them."""
    time = np.arange(round(8.0 * FS)) / FS
    share = time / time[-1]
    lower, upper = 60.0 - 30.0 * share, 100.0 - 50.0 * share
    tones = np.stack([np.cos(2.0 * np.pi * np.cumsum(f) / FS) for f in (lower, upper)])[:, None]
    inside = slice(round(0.5 * FS), round(7.5 * FS))

    def worst(cuts):
        parts = separate(tones.sum(axis=0), FS, cuts)
        return max(rms((part - tone)[:, inside]) for part, tone in zip(parts, tones, strict=True)) / rms(tones[0])

    assert worst(np.sqrt(lower * upper)[None]) < 0.01  # the chirp's skirts; measured 0.002
    assert worst(np.array([55.0])) > 0.3


def test_a_tone_that_comes_and_goes():
    """A second tone of a tenth, there for two of eight seconds, is found at its time and size, and not elsewhere."""
    time = np.arange(round(8.0 * FS)) / FS
    steady = np.exp(-0.2 * time) * np.cos(2.0 * np.pi * 40.0 * time)
    there = np.clip(np.minimum(time - 3.0, 5.0 - time) / 0.25, 0.0, 1.0)
    guest = 0.1 * np.sin(0.5 * np.pi * there) ** 2 * np.cos(2.0 * np.pi * 52.0 * time)
    parts = separate((steady + guest)[None], FS, np.array([46.0]))
    assert rms(parts[1, 0] - guest) / rms(guest) < 0.01  # skirts of a rise over a quarter of a second, at 6 Hz
    away = (time < 2.5) | (time > 5.5)
    assert rms(parts[1, 0, away]) < 0.001 * 0.1  # the same, half a second away
    assert rms(parts[0, 0] - steady) / rms(steady) < 0.001


def test_a_row_alone_gives_what_it_gives_among_copies_of_itself():
    signal = modes(BEAM, 0.005, seconds=4.0, n_channels=1).sum(axis=0)
    alone = separate(signal[0], FS, BEAM_CUTS)
    twice = separate(np.repeat(signal, 2, axis=0), FS, BEAM_CUTS)
    np.testing.assert_allclose(twice, np.repeat(alone[:, None], 2, axis=1), atol=1e-5)  # poles from squares, see extend


@pytest.mark.parametrize(
    ("cuts", "message"),
    [
        (np.ones((1, 5)), r"cuts of size \(1, 5\) for signals of size \(2, 400\); .*\(n_modes - 1, 400\); pass"),
        (np.array([0.0, 5.0]), r"cuts from 0 to 5 Hz; a cut lies between 0 and half the sampling rate, 1024 Hz; cut"),
        (np.array([5.0, 2000.0]), r"cuts from 5 to 2000 Hz"),
        (np.array([9.0, 5.0]), r"cuts that meet or change order; each cut is higher .*; sort"),
        (np.array([np.nan]), r"cuts from nan to nan Hz"),
    ],
)
def test_cuts_that_do_not_fit_are_refused(cuts, message):
    with pytest.raises(InputError, match=message):
        separate(np.ones((2, 400)), FS, cuts)


def test_gaps_are_refused():
    with pytest.raises(InputError, match=r"NaN or infinite samples; samples are finite; cut the gap out"):
        separate(np.array([1.0, np.nan, 0.0]), FS, np.array([5.0]))
