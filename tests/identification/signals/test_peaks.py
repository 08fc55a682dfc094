"""Modes found in a spectrum: those that are there, none that are not, and the cuts between them."""

import numpy as np
import pytest
from signal_scenes import BEAM, FS, modes, with_noise

from identification.signals.peaks import cut_frequencies, find_modes
from models.errors import InputError

TIME = np.arange(round(20.0 * FS)) / FS


def frequencies(found):
    return np.array([peak.frequency for peak in found.peaks])


@pytest.mark.parametrize(
    ("damping", "decibels"),
    [
        (0.0005, None),
        (0.0005, 0.0),
        (0.005, None),
        (0.005, 60.0),
        (0.005, 20.0),
        (0.005, 0.0),
        (0.02, None),
        (0.02, 20.0),
    ],
)
def test_the_modes_of_a_beam_and_no_others(damping, decibels):
    """Eight channels; at 0 dB the noise is as large as the modes are when they begin."""
    signals = modes(BEAM, damping).sum(axis=0)
    if decibels is not None:
        signals = with_noise(signals, decibels)
    found = find_modes(signals, FS)
    assert len(found.peaks) == 4
    np.testing.assert_allclose(frequencies(found), BEAM, rtol=0.5 * damping + 2e-4)  # a quarter of the width, and noise
    assert all(peak.false_alarm < 1e-3 for peak in found.peaks)


@pytest.mark.parametrize(
    ("pair", "fs", "seconds", "damping"),
    [
        ((9.0, 9.45), FS, 20.0, 0.003),
        ((9.0, 9.45), FS, 20.0, 0.01),
        ((181.0, 190.0), FS, 20.0, 0.003),
        ((2.0, 2.1), 256.0, 100.0, 0.002),
        ((2.0, 2.1), 256.0, 100.0, 0.01),
    ],
)
@pytest.mark.parametrize("decibels", [60.0, 20.0])
def test_two_modes_five_percent_apart_are_two(pair, fs, seconds, damping, decibels):
    found = find_modes(with_noise(modes(pair, damping, fs, seconds).sum(axis=0), decibels), fs)
    np.testing.assert_allclose(frequencies(found), pair, rtol=0.3 * damping + 2e-4)  # each on the other's skirt
    cut = cut_frequencies(found.peaks, found.spectrum)
    assert pair[0] * 1.015 < cut[0] < pair[1] / 1.015


def test_a_tone_cut_off_at_the_end_has_no_sidelobes():
    """At 100 dB the first sidelobe of a record without a window would stand 87 dB above the noise."""
    tone = np.cos(2.0 * np.pi * 50.3 * TIME)[None]
    found = find_modes(with_noise(tone, 100.0), FS)
    assert frequencies(found) == pytest.approx([50.3], abs=1e-3)
    assert found.peaks[0].drop == pytest.approx(0.0, abs=0.1)


def test_the_level_of_a_tone_is_that_of_the_window_and_the_noise():
    """Of amplitude a in noise of rms s: (a sum w)^2 / (4 s^2 sum w^2), which is a^2 N / (6 s^2) for this window."""
    found = find_modes(with_noise(np.cos(2.0 * np.pi * 50.3 * TIME)[None], 0.0), FS)
    assert found.peaks[0].level == pytest.approx(10.0 * np.log10(TIME.size / 6.0), abs=1.0)  # the floor's spread


def test_a_decay_drops_as_its_damping_says():
    """From one half of the record to the next by exp(-damping omega T / 2), 8.686 dB per neper."""
    found = find_modes(with_noise(modes((30.0,), 0.001)[0], 80.0), FS)
    assert found.peaks[0].drop == pytest.approx(8.686 * 0.001 * 2.0 * np.pi * 30.0 * 10.0, abs=0.1)


def test_the_width_of_a_damped_mode_is_that_of_half_power():
    """Twice damping times frequency, and a little for the window's 0.07 Hz."""
    found = find_modes(with_noise(modes((60.0,), 0.01)[0], 40.0), FS)
    assert found.peaks[0].width == pytest.approx(2.0 * 0.01 * 60.0, rel=0.05)


def test_a_mode_that_dies_at_once_is_found_in_the_records_first_part():
    """One channel; 1 % of the record holds the mode, and the whole record's noise hides it."""
    found = find_modes(with_noise(modes((190.0,), 0.02, n_channels=1)[0], 20.0), FS)
    assert frequencies(found) == pytest.approx([190.0], rel=0.02)
    assert found.peaks[0].part > 1


@pytest.mark.parametrize("kind", ["white", "shared", "random walk"])
def test_noise_alone_shows_no_mode(kind):
    """Of 150 records one in a thousand may: two or more of them have a chance of 1 %."""
    alarms = 0
    for seed in range(150):
        noise = np.random.default_rng(seed).normal(size=(1 if kind == "white" else 3, 4096))
        if kind == "shared":
            noise += 3.0 * noise[:1]
        elif kind == "random walk":
            noise = np.cumsum(noise, axis=1)
        alarms += bool(find_modes(noise, FS).peaks)
    assert alarms < 2


def test_two_knocks_make_no_modes_of_the_ripples_they_leave():
    """A second knock after five seconds ripples the skirts every 0.2 Hz, deep and far above the noise."""
    late = round(5.0 * FS)
    first, second = modes(BEAM, 0.005), modes(BEAM, 0.005, seed=7)
    second[..., late:] = second[..., :-late]
    second[..., :late] = 0.0
    found = find_modes(with_noise((first + second).sum(axis=0), 60.0), FS)
    np.testing.assert_allclose(frequencies(found), BEAM, atol=0.2)  # a ripple's spacing


def test_a_frequency_that_moves_by_five_percent_is_one_mode():
    phase = 2.0 * np.pi * np.cumsum(56.0 * (1.0 - 0.05 * (1.0 - TIME / TIME[-1]))) / FS
    signals = np.exp(-0.1 * TIME) * np.cos(phase + np.arange(4.0)[:, None])
    found = find_modes(with_noise(signals, 60.0), FS)
    assert len(found.peaks) == 1
    assert 53.0 < found.peaks[0].frequency < 56.0


def test_only_the_band_and_only_the_strongest():
    signals = with_noise(modes(BEAM, 0.005).sum(axis=0), 20.0)
    np.testing.assert_allclose(frequencies(find_modes(signals, FS, band=(40.0, 150.0))), BEAM[1:3], rtol=0.003)
    few = find_modes(signals, FS, most=2)
    levels = sorted(peak.level for peak in find_modes(signals, FS).peaks)
    assert sorted(peak.level for peak in few.peaks) == pytest.approx(levels[-2:])


def test_a_channel_in_another_unit_changes_nothing():
    signals = with_noise(modes(BEAM, 0.005).sum(axis=0), 20.0)
    scale = np.geomspace(1e-6, 1e6, 8)[:, None]
    plain, scaled = find_modes(signals, FS), find_modes(scale * signals, FS)
    np.testing.assert_allclose(frequencies(scaled), frequencies(plain), rtol=1e-9)


def test_cuts_lie_where_the_spectrum_is_lowest():
    found = find_modes(with_noise(modes(BEAM, 0.005).sum(axis=0), 20.0), FS)
    cuts = cut_frequencies(found.peaks, found.spectrum)
    between = np.sqrt(np.array(BEAM[:-1]) * np.array(BEAM[1:]))
    np.testing.assert_allclose(cuts, between, rtol=0.1)  # noise lies flat in the gaps, so their middles are taken
    near = np.abs(found.spectrum.frequency - cuts[:, None]) < 1.0
    assert all(np.mean(found.spectrum.power[lines]) < 3.0 for lines in near)  # multiples of the floor
    assert cut_frequencies(found.peaks[:1], found.spectrum).size == 0


def test_a_dead_channel_is_refused_by_its_number():
    signals = np.vstack((modes((50.0,), 0.01, n_channels=1)[0], np.zeros(TIME.size)))
    with pytest.raises(InputError, match=r"signals\[1\] is 0 throughout; a mode moves; leave the dead channel out"):
        find_modes(signals, FS)


@pytest.mark.parametrize("signals", [np.ones(4096), np.ones((2, 100)), np.full((1, 4096), np.nan)])
def test_signals_that_do_not_fit_are_refused(signals):
    with pytest.raises(InputError, match=r"they are \(n_channels, N\) finite samples, N 512 or more; pass one row"):
        find_modes(signals, FS)


@pytest.mark.parametrize("band", [(50.0, 60.0), (100.0, 50.0), (900.0, 5000.0)])
def test_a_band_too_narrow_to_tell_its_floor_is_refused(band):
    with pytest.raises(
        InputError, match=r"a band from .* Hz; it spans an octave or more between 0.4 and 921.6 Hz; wid"
    ):
        find_modes(np.random.default_rng(0).normal(size=(1, TIME.size)), FS, band=band)
