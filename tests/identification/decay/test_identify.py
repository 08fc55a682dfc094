import os
from pathlib import Path

import numpy as np
import pytest
from decay_scenes import noisy, rest_modes, ringing

from identification.decay.attempt import Settings
from identification.decay.course import integral_of
from identification.decay.identify import identify
from models.errors import InputError
from models.rig_file import read_rig

FS = 2048.0
LIGHT = 2.0 * np.pi * np.array([9.25, 39.75, 91.15, 189.3]) * (1j - 0.004)
SHAPES = np.random.default_rng(3).uniform(0.3, 1.0, (4, 8)) * np.exp(2j * np.pi * np.arange(4)[:, None] / 7)


@pytest.fixture(scope="module")
def decay():
    return noisy(ringing(LIGHT, SHAPES, FS, 4 * 2048), 40.0, 0)


@pytest.fixture(scope="module")
def found(decay):
    return identify([decay], [0.0], FS, np.ones(8))


def test_the_chain_finds_and_follows_all_modes(found):
    modes = found.decays[0].modes
    freqs = np.abs(LIGHT) / 2.0 / np.pi
    for mode, freq in zip(modes, freqs, strict=True):
        assert abs(mode.natural_freq - freq) < 4.0 * mode.natural_freq_std
        assert abs(mode.damping_ratio - 0.004) < 4.0 * mode.damping_ratio_std
    assert len(found.cuts) == 3
    assert ((freqs[:-1] < found.cuts) & (found.cuts < freqs[1:])).all()


def test_what_stays_is_called_steady(found):
    assert {cause.verdict for cause in (*found.damping_causes, *found.frequency_causes)} == {"steady"}


def test_a_mode_that_stays_has_one_number_and_one_interval(found):
    for mode in found.decays[0].modes:
        for course, value, std in (
            (mode.frequency, mode.natural_freq, mode.natural_freq_std),
            (mode.damping, mode.damping_ratio, mode.damping_ratio_std),
        ):
            assert set(course.value) == {value}
            np.testing.assert_allclose(course.high - value, 1.959964 * std, rtol=1e-6)
            np.testing.assert_allclose(value - course.low, 1.959964 * std, rtol=1e-6)
            assert len(course.times) == len(course.value)


def test_the_ridge_stands_beside_the_smoother(found):
    for mode, freq in zip(found.decays[0].modes, np.abs(LIGHT) / 2.0 / np.pi, strict=True):
        early = mode.skeleton.time < 5.0 / freq
        # the ridge of a mode among others, at 40 dB, in its first periods
        assert np.median(mode.skeleton.frequency[early]) == pytest.approx(freq, rel=2e-3)


def test_a_mode_that_makes_no_peak_is_found_in_what_the_others_leave():
    rig = read_rig("tests/data/reference_rig.toml")
    poles, shapes = rest_modes(rig, 2)
    heavy = np.append(poles, 2.0 * np.pi * 85.0 * (1j - 0.12))
    shape = np.vstack([shapes, 0.3 * np.ones(shapes.shape[1])])
    signals = noisy(ringing(heavy, shape, FS, 4096), 50.0, 0)
    found = identify([signals], [0.0], FS, np.ones(len(signals)))
    freqs = [mode.natural_freq for mode in found.decays[0].modes]
    assert freqs == pytest.approx(np.abs(heavy) / 2.0 / np.pi, rel=5e-3)


def test_a_band_holds_its_mode_alone(decay):
    found = identify([decay], [0.0], FS, np.ones(8), Settings(band=(60.0, 130.0)))
    (mode,) = found.decays[0].modes
    # predicted ends leave some 0.1 % of the amplitude there at 40 dB
    assert mode.natural_freq == pytest.approx(91.15, rel=1e-4)
    assert mode.damping_ratio == pytest.approx(0.004, rel=0.01)
    assert found.decays[0].fs == pytest.approx(FS / 6)


def test_named_modes_are_begun_from(decay):
    found = identify([decay], [0.0], FS, np.ones(8), Settings(freqs=(9.2, 39.8, 91.0, 189.4)))
    assert [m.natural_freq for m in found.decays[0].modes] == pytest.approx(np.abs(LIGHT) / 2.0 / np.pi, rel=1e-4)


def test_noise_alone_has_no_modes():
    silence = np.random.default_rng(0).standard_normal((2, 4096))
    with pytest.raises(InputError, match=r"no mode stands out .*; name the modes with --mode, or another stretch"):
        identify([silence], [0.0], FS, np.ones(2))


def test_a_band_that_is_none_is_refused(decay):
    with pytest.raises(InputError, match=r"a band from 130 to 60 Hz; .* begins below its end; name its lower edge"):
        identify([decay], [0.0], FS, np.ones(8), Settings(band=(130.0, 60.0)))


def test_a_decay_too_short_for_its_mode_is_refused(decay):
    with pytest.raises(InputError, match=r"a mode about 9.25 Hz; modes of a decay of 0.5 s .* from 16 to 1024 Hz"):
        identify([decay[:, :1024]], [0.0], FS, np.ones(8), Settings(freqs=(9.25,)))


def close(spacing, ratio, snr_db, n_channels, seed=0):
    """(n_channels, N) two modes of one damping ratio at 50 Hz and a share above, and their poles."""
    poles = 2.0 * np.pi * 50.0 * np.array([1.0, 1.0 + spacing]) * (1j * np.sqrt(1.0 - ratio**2) - ratio)
    shapes = np.random.default_rng(seed).uniform(0.4, 1.0, (2, n_channels))
    return noisy(ringing(poles, shapes, 512.0, 8192), snr_db, seed), poles


@pytest.mark.parametrize(
    ("spacing", "ratio", "snr_db", "n_channels"),
    [
        *[(0.05, 0.01, 30.0, 1), (0.05, 0.01, 40.0, 8), (0.03, 0.003, 40.0, 4)],
        *[(0.03, 0.01, 40.0, 4), (0.05, 0.015, 40.0, 1)],  # one peak each: a pole has to be split
    ],
)
def test_close_modes_are_two_and_steady(spacing, ratio, snr_db, n_channels):
    signals, poles = close(spacing, ratio, snr_db, n_channels)
    found = identify([signals], [0.0], 512.0, np.ones(n_channels))
    for mode, pole in zip(found.decays[0].modes, poles, strict=True):
        assert abs(mode.natural_freq - np.abs(pole) / 2.0 / np.pi) < 4.0 * mode.natural_freq_std
        assert abs(mode.damping_ratio - ratio) < 4.0 * mode.damping_ratio_std
    assert {cause.verdict for cause in (*found.damping_causes, *found.frequency_causes)} == {"steady"}


def test_a_mode_that_slows_down_with_drag_is_not_taken_for_two():
    t = np.arange(8192) / 512.0
    signal = (np.cos(100.0 * np.pi * t) / (1.0 + 0.5 * t))[None]
    found = identify([noisy(signal, 40.0, 0)], [0.0], 512.0, np.ones(1))
    assert len(found.decays[0].modes) == 1
    assert (found.damping_causes[0].verdict, found.damping_causes[0].law.power) == ("amplitude", 1.0)
    assert found.frequency_causes[0].verdict == "steady"


def test_heavy_damping_alone_makes_no_peak_and_is_found():
    pole = 2.0 * np.pi * 30.0 * (1j * np.sqrt(1.0 - 0.15**2) - 0.15)
    found = identify(
        [noisy(ringing(np.array([pole]), np.ones((1, 1)), 512.0, 2048), 40.0, 0)], [0.0], 512.0, np.ones(1)
    )
    (mode,) = found.decays[0].modes
    assert mode.natural_freq == pytest.approx(30.0, rel=1e-3)
    assert mode.damping_ratio == pytest.approx(0.15, rel=5e-3)


def test_a_named_mode_that_is_none_is_told_and_the_others_stay(decay):
    found = identify([decay], [0.0], FS, np.ones(8), Settings(freqs=(60.0,)))
    assert [m.natural_freq for m in found.decays[0].modes] == pytest.approx(np.abs(LIGHT) / 2.0 / np.pi, rel=1e-4)
    assert "there is no mode about 60 Hz beside those found" in found.findings


def test_a_tone_that_does_not_decay_is_told():
    tone = np.sin(60.0 * np.pi * np.arange(4096) / 512.0)[None]
    found = identify([noisy(tone, 40.0, 0)], [0.0], 512.0, np.ones(1))
    assert any("hardly decays" in finding for finding in found.findings)


def test_two_decays_share_their_modes_and_their_cause(decay):
    weaker = noisy(0.3 * ringing(LIGHT, SHAPES, FS, 4 * 2048), 40.0, 1)
    found = identify([decay, weaker], [0.0, 5.0], FS, np.ones(8))
    assert [d.start for d in found.decays] == [0.0, 5.0]
    assert {cause.verdict for cause in (*found.damping_causes, *found.frequency_causes)} == {"steady"}


@pytest.mark.real_data
@pytest.mark.slow
def test_the_bolted_beam_depends_on_amplitude():
    """Chen et al., MSSP 166 (2022) 108401: first mode of a beam with a lap joint after a blow."""
    from scipy.io import loadmat

    held = loadmat(Path(os.environ["TESTBED_DATA"], "brake_reuss_beam", "HammerImpact.mat"), squeeze_me=True)["HIdata"]
    time, signal = held["time"].item(), held["acc1"].item()
    fs = 1.0 / (time[1] - time[0])
    after = round(0.06 * fs)
    found = identify([signal[None, after:]], [0.06], fs, np.ones(1), Settings(band=(60.0, 110.0)))
    (decay,), (mode,) = found.decays, found.decays[0].modes
    assert found.damping_causes[0].verdict == "amplitude"
    assert found.frequency_causes[0].verdict == "amplitude"
    amplitude = np.exp(mode.watched_decay.log_amplitude)
    times = mode.smoothed.blocks.times
    loud, quiet = (np.interp(-np.log(level), -np.log(amplitude), times) for level in (32.8, 1.1))
    assert mode.smoothed.natural_freq.at(np.array([loud, quiet])) == pytest.approx([80.28, 80.58], abs=0.03)
    assert mode.smoothed.damping_ratio.at(np.array([loud, quiet])) == pytest.approx([0.00284, 0.00145], rel=0.05)
    courses = mode.smoothed.decay, mode.smoothed.turning
    t = np.arange(decay.signals.shape[1]) / decay.fs
    losing, phasing = (integral_of(course.times, course.rate, t) for course in courses)
    wave = np.exp(losing + 1j * phasing)
    basis = np.stack([wave.real, -wave.imag], axis=1)
    left = decay.signals[0] - basis @ np.linalg.lstsq(basis, decay.signals[0], rcond=None)[0]
    linear = np.exp(decay.poles.values[0] * t)
    columns = np.stack([linear.real, -linear.imag], axis=1)
    left_linear = decay.signals[0] - columns @ np.linalg.lstsq(columns, decay.signals[0], rcond=None)[0]
    assert left_linear.std() > 0.5
    assert left.std() < 0.123
