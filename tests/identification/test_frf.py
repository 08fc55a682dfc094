"""FRFs of an oscillator in closed form, under noise and under a multisine; what measurement noise does to H1 and H2."""

import numpy as np
import pytest

from identification.frf import estimate_frf, estimate_frf_per_level
from models.errors import InputError

FS = 200.0
N = 2**16
ROUNDING = 1e-9  # of two FFTs and a division
# Leakage at a half-power width of 2 Hz falls with its square; 0.25 Hz leaves 2 %, and 160 averages 1 % on top.
LEAKAGE = 0.04


def oscillator(frequency):
    """Receptance of 20 Hz and 5 % damping, with unit stiffness."""
    r = np.asarray(frequency) / 20.0
    return 1.0 / (1.0 - r**2 + 0.1j * r)


def response(excitation):
    """The steady response, exact for a periodic excitation."""
    frequency = np.fft.rfftfreq(excitation.size, 1.0 / FS)
    return np.fft.irfft(oscillator(frequency) * np.fft.rfft(excitation), excitation.size)


def noise(level, seed, size=N):
    return level * np.random.default_rng(seed).normal(size=size)


def multisine(period, count, lines, seed=0):
    spectrum = np.zeros(period // 2 + 1, complex)
    spectrum[lines] = np.exp(2j * np.pi * np.random.default_rng(seed).uniform(size=len(spectrum[lines])))
    return np.tile(period * np.fft.irfft(spectrum, period), count)


def near_resonance(frequency):
    return (frequency > 10.0) & (frequency < 35.0)


def worst_error(estimate, values):
    lines = near_resonance(estimate.frequency)
    return np.abs(values[0] / oscillator(estimate.frequency) - 1.0)[lines].max()


def test_random_noise_gives_the_closed_form():
    x = noise(3.0, 0)
    estimate = estimate_frf(x, response(x)[np.newaxis], FS, resolution=0.25)
    assert worst_error(estimate, estimate.h1) < LEAKAGE
    assert worst_error(estimate, estimate.h2) < LEAKAGE
    assert estimate.coherence[0, near_resonance(estimate.frequency)].min() > 0.96
    assert estimate.period is None
    assert estimate.n_averages == 162
    assert estimate.level == pytest.approx(3.0, rel=0.01)  # rms of 65536 random samples


def test_leakage_falls_as_the_resolution_gets_finer():
    x = noise(1.0, 0)
    y = response(x)[np.newaxis]
    estimates = [estimate_frf(x, y, FS, resolution=r) for r in (1.0, 0.5, 0.25)]
    coarse, middle, fine = (worst_error(e, e.h1) for e in estimates)
    assert coarse > 2.0 * middle > 4.0 * fine


def test_a_multisine_gives_the_closed_form_exactly_and_only_on_its_lines():
    lines = np.arange(3, 370, 2)
    x = multisine(1000, 4, lines)
    estimate = estimate_frf(x, np.vstack((response(x), -2.0 * response(x))), FS, resolution=1.0)
    expected = oscillator(estimate.frequency) * np.array([[1.0], [-2.0]])
    np.testing.assert_allclose(estimate.frequency, lines * 0.2, rtol=ROUNDING)
    np.testing.assert_allclose(estimate.h1, expected, rtol=ROUNDING)
    np.testing.assert_allclose(estimate.h2, expected, rtol=ROUNDING)
    np.testing.assert_allclose(estimate.coherence, 1.0, rtol=ROUNDING)
    assert (estimate.period, estimate.n_averages) == (1000, 4)
    assert estimate.level == pytest.approx(np.sqrt(2.0 * lines.size), rel=ROUNDING)


def test_silent_lines_are_left_out_under_noise_too():
    lines = np.arange(5, 300, 3)
    x = multisine(1000, 10, lines) + noise(0.1, 1, 10_000)
    estimate = estimate_frf(x, response(x)[np.newaxis], FS, resolution=1.0)
    np.testing.assert_allclose(estimate.frequency, lines * 0.2, rtol=ROUNDING)


def test_the_transient_of_a_start_from_rest_does_not_bias_a_multisine():
    x = multisine(1000, 6, slice(3, 370))
    t = np.arange(x.size) / FS
    transient = 40.0 * np.exp(-0.05 * 2.0 * np.pi * 20.0 * t) * np.sin(2.0 * np.pi * 20.0 * t)
    estimate = estimate_frf(x, (response(x) + transient)[np.newaxis], FS, resolution=1.0)
    assert estimate.n_averages == 5
    np.testing.assert_allclose(estimate.h1[0], oscillator(estimate.frequency), rtol=1e-6)


def test_a_model_that_settles_later_does_not_choose_the_periods_of_a_record():
    """Two models beside one record share its lines, whatever the transients that they foresee."""
    x = multisine(1000, 6, slice(3, 370))
    t = np.arange(x.size) / FS
    late = 40.0 * np.exp(-0.01 * 2.0 * np.pi * 20.0 * t) * np.sin(2.0 * np.pi * 20.0 * t)
    beside = [np.stack([response(x) + more]) for more in (0.0, late)]
    one, other = (estimate_frf(x, response(x)[np.newaxis], FS, resolution=1.0, besides=each) for each in beside)
    assert one.n_averages == other.n_averages == 6
    np.testing.assert_array_equal(one.frequency, other.frequency)
    np.testing.assert_allclose(one.h1[1], one.h1[0], rtol=1e-9)


def test_a_sensor_offset_does_not_matter():
    x = noise(1.0, 0)
    y = response(x)[np.newaxis]
    plain, shifted = (estimate_frf(x, y + offset, FS, resolution=0.25) for offset in (0.0, 1e3))
    np.testing.assert_allclose(shifted.h1, plain.h1, rtol=1e-7)  # 1e3 times the rounding of y, over small |H|


@pytest.mark.parametrize("ratio", [0.1, 0.5])
def test_noise_on_the_force_biases_h1_low_by_its_power_and_leaves_h2(ratio):
    """H1 = H / (1 + Snn / Sxx), coherence = 1 / (1 + Snn / Sxx)."""
    x = noise(1.0, 0)
    estimate = estimate_frf(x + noise(ratio, 1), response(x)[np.newaxis], FS, resolution=0.25)
    lines = near_resonance(estimate.frequency)
    h = np.abs(oscillator(estimate.frequency[lines]))
    expected = 1.0 / (1.0 + ratio**2)
    # The mean over 100 lines of 160 averages each; what is left is the leakage at the peak.
    assert np.mean(np.abs(estimate.h1[0, lines]) / h) == pytest.approx(expected, abs=0.01)
    assert np.mean(np.abs(estimate.h2[0, lines]) / h) == pytest.approx(1.0, abs=0.01)
    assert np.mean(estimate.coherence[0, lines]) == pytest.approx(expected, abs=0.01)


def test_noise_on_the_response_biases_h2_high_and_leaves_h1():
    """H2 = H (1 + Snn / Syy), coherence = 1 / (1 + Snn / Syy)."""
    x = noise(1.0, 0)
    estimate = estimate_frf(x, (response(x) + noise(0.5, 1))[np.newaxis], FS, resolution=0.25)
    lines = near_resonance(estimate.frequency)
    h = np.abs(oscillator(estimate.frequency[lines]))
    expected = 1.0 + 0.25 / h**2
    assert np.mean(np.abs(estimate.h1[0, lines]) / h) == pytest.approx(1.0, abs=0.01)
    assert np.mean(np.abs(estimate.h2[0, lines]) / h / expected) == pytest.approx(1.0, abs=0.01)
    assert np.mean(estimate.coherence[0, lines] * expected) == pytest.approx(1.0, abs=0.01)


def test_noise_lowers_the_coherence_of_a_multisine():
    x = multisine(1000, 10, slice(3, 370))
    y = response(x)
    estimate = estimate_frf(x, (y + noise(0.3 * y.std(), 1, y.size))[np.newaxis], FS, resolution=1.0)
    assert np.all(estimate.coherence <= 1.0)
    assert estimate.coherence.mean() < 0.9


def test_each_level_has_its_own_frf():
    """A system whose gain is 2 at the high level and 1 at the low, with a pause between them."""
    high, low = noise(10.0, 0, 20_000), noise(1.0, 1, 20_000)
    pause = np.zeros(4000)
    x = np.concatenate((low, pause, high))
    y = np.concatenate((low, pause, 2.0 * high))[np.newaxis]
    loud, *_, quiet = estimate_frf_per_level(x, y, FS, resolution=1.0)
    np.testing.assert_allclose(loud.h1, 2.0, rtol=0.01)  # the segment at the seam holds both
    np.testing.assert_allclose(quiet.h1, 1.0, rtol=ROUNDING)
    assert (loud.level, quiet.level) == pytest.approx((10.0, 1.0), rel=0.05)


@pytest.mark.parametrize("x", [noise(2.0, 0), multisine(1000, 4, slice(3, 370))], ids=["noise", "multisine"])
def test_one_level_gives_the_estimate_of_the_whole(x):
    y = response(x)[np.newaxis]
    whole, levels = estimate_frf(x, y, FS, resolution=0.5), estimate_frf_per_level(x, y, FS, resolution=0.5)
    assert len(levels) == 1
    np.testing.assert_array_equal(levels[0].h1, whole.h1)


def test_sizes_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match=r"size \(100,\) and responses of size \(100,\); .*one time base; pass"):
        estimate_frf(np.ones(100), np.ones(100), FS, resolution=1.0)


def test_a_silent_channel_is_refused_by_its_number():
    signals = np.vstack((noise(1.0, 0, 2000), np.zeros(2000)))
    with pytest.raises(InputError, match=r"responses\[1\] is 0 throughout; an FRF needs motion; leave"):
        estimate_frf(noise(1.0, 1, 2000), signals, FS, resolution=1.0)


def test_a_resolution_that_leaves_one_segment_is_refused_with_one_that_works():
    x = noise(1.0, 0, 2000)
    with pytest.raises(InputError, match=r"0.1 Hz for a record of 10 s; two .*; ask for 0.2 Hz or coarser"):
        estimate_frf(x, x[np.newaxis], FS, resolution=0.1)
    assert estimate_frf(x, x[np.newaxis], FS, resolution=0.2).n_averages == 3
