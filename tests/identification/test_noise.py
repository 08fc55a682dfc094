"""The noise of known channels is found, by each of the ways, and what cannot be told is said."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import fft
from trial_records import FS, REFERENCE, measured, multisine, oscillator, sweep

from identification.hypothesis import Hypothesis
from identification.noise import estimate_noise, quiet_floor, unshared_density
from models.band_limit import recorder_gain
from models.excitations import half_sine_hammer

WITHIN = 0.15
"""Two to three standard deviations of the median of 33 to 100 free lines, in units of the noise."""


def low_passed(noise):
    """Noise that entered before the recorder's filter: the stopped band holds none."""
    freq = fft.rfftfreq(noise.shape[1], 1.0 / FS)
    return fft.irfft(fft.rfft(noise, axis=1) * recorder_gain(freq, FS), noise.shape[1], axis=1)


def filtered_record(high, share):
    """A beam that rattles in its sleeves, so that no band is quiet; its sensors' noise is a share of their rms."""
    record, _ = measured(Hypothesis(REFERENCE), multisine(8192, rms=10.0, high=high), noise=0.0)
    sensors = share * record.responses.std(axis=1)
    noise = sensors[:, None] * np.random.default_rng(3).standard_normal(record.responses.shape)
    return replace(record, responses=record.responses + low_passed(noise)), sensors


def test_what_does_not_repeat_is_noise():
    force = multisine(8 * 1024, periods=8, rms=5.0)
    record, truth = measured(Hypothesis(REFERENCE), force, noise=0.01, force_noise=0.005)

    found = estimate_noise(record)

    assert "period" in found.method
    np.testing.assert_allclose(found.sensors, truth.sensors, rtol=WITHIN)
    assert found.excitation == pytest.approx(truth.excitation, rel=WITHIN)


def test_a_period_of_a_few_samples_tells_the_noise_too():
    force = 20.0 * np.sin(2.0 * np.pi * np.arange(4096) / 5.0)
    record, truth = measured(Hypothesis(oscillator()), force, noise=0.01, force_noise=0.005)

    found = estimate_noise(record)

    assert "period" in found.method
    np.testing.assert_allclose(found.sensors, truth.sensors, rtol=WITHIN)


def test_the_stopped_band_holds_only_noise():
    record, truth = measured(Hypothesis(oscillator()), sweep(4096), noise=0.01, force_noise=0.01)

    found = estimate_noise(record)

    assert "stopped band" in found.method
    np.testing.assert_allclose(found.sensors, truth.sensors, rtol=WITHIN)
    assert found.excitation == pytest.approx(truth.excitation, rel=WITHIN)


@pytest.mark.parametrize("high", [250.0, 400.0])
@pytest.mark.parametrize("share", [0.003, 0.01])
def test_what_no_common_source_explains_is_noise(high, share):
    record, sensors = filtered_record(high, share)

    found = estimate_noise(record)

    assert "does not share" in found.method
    # A sensor on a sleeve sees a source that hardly any other sees: up to 1.3 times too much is left to it.
    assert np.median(found.sensors / sensors) == pytest.approx(1.0, abs=0.05)
    assert np.all(np.abs(np.log(found.sensors / sensors)) < np.log(1.3))
    # The quietest band alone would not have told.
    assert (
        np.median([np.sqrt(quiet_floor(c).density) / s for c, s in zip(record.responses, sensors, strict=True)]) > 1.5
    )


def test_too_few_sources_leave_signal_in_the_noise():
    record, sensors = filtered_record(400.0, 0.003)

    assert np.median(np.sqrt(unshared_density(record.responses, sources=1)) / sensors) > 1.0 + 2.0 * WITHIN


def test_the_excitation_that_fills_the_band_hides_its_noise_and_says_so():
    force = np.random.default_rng(5).standard_normal(4096)
    record, _ = measured(Hypothesis(oscillator()), force, force_noise=0.02)

    found = estimate_noise(record)

    assert found.excitation == 0.0
    assert "fills the whole band" in found.excitation_method


def test_a_free_decay_has_no_noise_of_excitation():
    record, truth = measured(Hypothesis(oscillator()), sweep(4096))

    found = estimate_noise(replace(record, excitation=None))

    assert (found.excitation, found.excitation_method) == (0.0, "no excitation channel")
    np.testing.assert_allclose(found.sensors, truth.sensors, rtol=WITHIN)


@pytest.mark.parametrize(("n", "within"), [(2048, 0.03), (16384, 0.01)])
def test_white_noise_reads_its_own_variance_on_average(n, within):
    rng = np.random.default_rng(6)

    found = [quiet_floor(0.3 * rng.standard_normal(n)).density for _ in range(40)]

    # Three standard deviations of the mean of 40; the least of the bands would read 40 % and 17 % too little.
    assert np.mean(found) == pytest.approx(0.09, rel=3.0 * within)
    assert np.std(found) < 0.3 * np.sqrt(2048 / n) * 0.09


def test_an_excitation_that_fills_the_band_and_repeats_shows_its_noise():
    force = multisine(8 * 1024, periods=8, rms=5.0, low=2.0, high=1020.0)
    record, truth = measured(Hypothesis(oscillator()), force, force_noise=0.02)

    found = estimate_noise(record)

    assert found.excitation == pytest.approx(truth.excitation, rel=WITHIN)
    assert not found.hidden


@pytest.mark.parametrize("starts", [(0.05,), (1.0,), (0.5, 2.5, 4.5, 6.5)])
@pytest.mark.parametrize("share", [0.005, 0.1])
def test_between_the_blows_of_a_hammer_its_noise_is_heard(starts, share):
    blows = sum(half_sine_hammer(FS, 16384, start, 0.002, 200.0) for start in starts)
    heard = np.random.default_rng(4).standard_normal(len(blows)) * share * blows.std()
    record, _ = measured(Hypothesis(oscillator()), blows)

    found = estimate_noise(replace(record, excitation=blows + heard))

    assert found.excitation == pytest.approx(heard.std(), rel=WITHIN)
    assert not found.hidden


def test_a_steady_excitation_is_never_silent():
    force = low_passed(np.random.default_rng(5).standard_normal((1, 8192)))[0]
    record, _ = measured(Hypothesis(oscillator()), force)

    assert estimate_noise(record).hidden
