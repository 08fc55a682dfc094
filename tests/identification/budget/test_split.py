"""How a record splits: polynomials and filters in closed form, noise within its interval, false alarms as stated."""

import numpy as np
import pytest
from budget_scenes import FS, PERIOD, line_powers, multisine, record, resonator, steady
from scipy.stats import binom, chi2

from identification.budget.pooled import FALSE_ALARM
from identification.budget.split import split_record

PERIODS = 6
ROUNDING = 1e-6  # of sums of squares of FFTs, and of the interpolation's doubt about a flat response


def test_a_polynomial_puts_its_powers_on_odd_and_even_lines():
    drive = multisine(1, PERIODS)
    a2, a3 = 0.05, 0.02
    split = split_record(record(drive, drive + a2 * drive**2 + a3 * drive**3))
    # The products of the spectrum with itself, of which the second order falls on even lines and the third on odd ones.
    spectrum = np.fft.fft(drive[:PERIOD]) / PERIOD
    second = np.array([np.sum(spectrum * np.roll(spectrum[::-1], k + 1)) for k in range(PERIOD)])
    third = np.array([np.sum(second * np.roll(spectrum[::-1], k + 1)) for k in range(PERIOD)])
    for cause, products in (("even", a2 * second), ("odd", a3 * third)):
        on = split.lines_of(cause)
        expected = 2.0 * np.abs(products[1 : len(on) + 1][on]) ** 2
        assert np.allclose(split.lines.distortion[0, on], expected, rtol=ROUNDING, atol=1e-9 * expected.max())
        assert split.shares[cause].found.any()


@pytest.mark.parametrize(("power", "other"), [(2, "odd"), (3, "even")])
def test_one_parity_leaves_the_lines_of_the_other_empty(power, other):
    drive = multisine(2, PERIODS)
    motion = steady(resonator, drive)
    split = split_record(record(drive, motion + 0.05 * motion**power, noise=1e-4))
    found = {cause: split.shares[cause].found.any() for cause in ("odd", "even")}
    assert found == {other: False, "even" if other == "odd" else "odd": True}


def test_odd_distortion_on_excited_lines_is_that_of_the_detection_lines():
    """A pure cube: what the best linear approximation leaves of it on excited lines, over many realisations."""
    told, true = [], []
    for seed in range(24):
        drive = multisine(seed, 3)
        split = split_record(record(drive, drive + 0.05 * drive**3))
        told.append(split.shares["odd"].total[0])
        # For a Gaussian input of variance s^2 the best linear gain of x^3 is 3 s^2 (Bussgang); the rest is distortion.
        rest = line_powers(0.05 * (drive**3 - 3.0 * np.mean(drive**2) * drive))[: len(split.periods.frequency)]
        true.append(rest[0::2].sum())
    # A multisine of some 50 lines is Gaussian but for one in the number of lines; 24 phases scatter by 8 %.
    assert np.mean(told) == pytest.approx(np.mean(true), rel=0.25)


def test_noise_is_found_within_its_interval():
    drive, size = multisine(3, PERIODS), 0.01
    split = split_record(record(drive, steady(resonator, drive), noise=size))
    inside = 0.35  # share of fs up to which lines are kept, of 0.5
    freedom = 2.0 * (split.n_periods - 1) * len(split.periods.frequency)
    low, high = chi2.ppf([0.005, 0.995], freedom) / freedom
    assert low < split.lines.noise.sum() / (size**2 * 2.0 * inside) < high


def test_a_linear_rig_is_accused_as_rarely_as_stated():
    """Noise on excitation and responses, starting from rest, with four periods used or six."""
    runs, alarms = 80, {"odd": 0, "even": 0, "time_variation": 0}
    for seed in range(runs):
        drive = multisine(seed, 5 + seed % 2)
        motions = [resonator(drive, freq) for freq in (30.0, 62.0, 100.0)]
        split = split_record(record(drive, *motions, noise=3e-3, excitation_noise=5e-3, seed=seed))
        for cause in alarms:
            alarms[cause] += bool(split.shares[cause].found.any())
    most = binom.ppf(0.999, runs, FALSE_ALARM)
    assert max(alarms.values()) <= most, alarms


def test_a_transient_after_switching_on_is_no_distortion_and_is_found():
    drive = multisine(4, PERIODS)
    slow = [resonator(drive, freq, 0.002) for freq in (25.3, 61.1)]
    split = split_record(record(drive, *slow, noise=1e-3))
    assert split.shares["transient"].found.any()
    assert not split.shares["odd"].found.any()
    assert not split.shares["even"].found.any()
    ended = steady(lambda u: resonator(u, 25.3, 0.002), np.tile(drive, 8))[: len(drive)]
    first = split.periods.start
    died = (slow[0] - ended)[first : first + split.n_periods * PERIOD]
    assert split.shares["transient"].total[0] == pytest.approx(np.mean(died**2), rel=0.1)  # 5 periods, noise 1e-3
    assert np.abs(split.bla[0]).max() == pytest.approx(np.abs(_gain(split, 25.3, 0.002)).max(), rel=0.02)


def _gain(split, freq, damping_ratio):
    w = 2.0 * np.pi * freq / FS
    z = np.exp(2j * np.pi * split.periods.frequency[split.periods.excited] / FS)
    r = np.exp(-damping_ratio * w)
    return (1.0 - 2.0 * r * np.cos(w) + r * r) / (1.0 - 2.0 * r * np.cos(w) / z + r * r / z**2)


def test_a_gain_that_grows_with_time_is_recovered():
    drive = multisine(5, PERIODS)
    motion = steady(resonator, drive)
    rate = 0.01  # over the record
    split = split_record(record(drive, motion * (1.0 + rate * np.linspace(0.0, 1.0, len(drive))), noise=3e-4))
    assert split.shares["time_variation"].found.any()
    # From the middle of the first period used to that of the last, as a share of the gain midway.
    midway = 1.0 + rate * (split.periods.start / PERIOD + split.n_periods / 2.0) / PERIODS
    over = rate * (split.n_periods - 1) / PERIODS / midway
    assert split.drift.gain[0] == pytest.approx(over, abs=5.0 * split.drift.std[0])
    assert split.drift.std[0] < 0.1 * over
    assert abs(split.drift.phase[0]) < 5.0 * split.drift.std[0]


def test_what_the_excitation_itself_repeats_elsewhere_is_no_distortion():
    """A shaker that bends its force: harmonics on all lines of the band, measured, through a linear rig."""
    wanted = multisine(6, PERIODS)
    force = wanted + 0.03 * wanted**2 + 0.02 * wanted**3
    split = split_record(record(force, steady(lambda u: resonator(u, 40.0, 0.05), force), noise=1e-4))
    assert split.periods.plan == "odd_detection"
    assert not split.shares["odd"].found.any()
    assert not split.shares["even"].found.any()
    # Above the band no linear response is known, and the lines with force on them are not judged.
    above = split.periods.frequency > 125.0
    assert split.told[above & (np.abs(split.excitation) ** 2 < 1e-20)].all()
    assert not split.told[above & (np.abs(split.excitation) ** 2 > 1e-8)].any()


def test_without_detection_lines_odd_distortion_is_told_above_the_band_alone():
    drive = multisine(7, PERIODS, "odd")
    split = split_record(record(drive, drive + 0.05 * drive**3, noise=1e-4))
    centres = 0.5 * (split.bands[1:] + split.bands[:-1])
    assert split.periods.plan == "odd"
    assert np.isnan(split.shares["odd"].power[0, (centres > 5.0) & (centres < 118.0)]).all()
    assert split.shares["odd"].found[0, centres > 122.0].any()


def test_where_all_lines_are_excited_distortion_above_the_band_has_no_parity():
    drive = multisine(8, PERIODS, "full")
    split = split_record(record(drive, drive + 0.05 * drive**2, noise=1e-4))
    assert split.periods.plan == "mixed"
    assert np.isnan(split.shares["odd"].total).all()
    assert split.shares["odd_or_even"].found.any()


@pytest.mark.parametrize("periods", [2, 3, 100])
def test_few_periods_and_many(periods):
    time = np.arange(periods * 64) / FS
    drive = np.sin(2.0 * np.pi * 8.0 * time)
    split = split_record(record(drive, drive + 0.1 * drive**2, noise=1e-3))
    assert split.n_periods >= min(periods, 2)
    assert split.shares["even"].total[0] == pytest.approx(0.5 * 0.05**2, rel=0.1)  # cos(2 w t) / 20


def test_what_does_not_repeat_is_not_split():
    rng = np.random.default_rng(9)
    drive = rng.standard_normal(4096)
    assert split_record(record(drive, resonator(drive))) is None


@pytest.mark.parametrize("periods", [7, 8, 12])
def test_a_record_of_which_the_spared_end_leaves_no_two_periods_is_not_split(periods):
    """Short periods: the recorder's filter spoils 128 samples, more than there are but for one period or two."""
    drive = np.tile(
        np.sin(2.0 * np.pi * np.arange(20) / 20.0 * 3.0) + np.cos(2.0 * np.pi * np.arange(20) / 10.0), periods
    )

    split = split_record(record(drive, drive, noise=1e-3))

    assert (split is None) == (20 * periods - 128 < 2 * 20)
