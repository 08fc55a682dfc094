"""The recorder's low-pass, and interpolation between samples, on signals whose continuation is known."""

import numpy as np
import pytest
from scipy import fft

from models.band_limit import PAD, continued, raise_rate, record_channels, recorder_gain

FS, N = 1000.0, 1200
INSIDE = slice(200, -200)  # beyond the reach of the continuation
RIPPLE = 1e-5  # what the ends still cast there


def sine(freq, factor=1, phase=0.3, n=N):
    return np.sin(2.0 * np.pi * freq * np.arange(n * factor) / (FS * factor) + phase)


def inside(fine, factor):
    return fine[..., 200 * factor : (N - 200) * factor]


@pytest.mark.parametrize(("freq", "gain"), [(0, 1), (370, 1), (385, 0.853553), (400, 0.5), (430, 0), (500, 0)])
def test_the_recorders_gain(freq, gain):
    assert recorder_gain(np.array([float(freq)]), FS)[0] == pytest.approx(gain, abs=1e-6)


def test_a_continued_signal_is_odd_about_its_ends_and_fades():
    signal = np.arange(10.0) ** 2 + 3.0
    long = continued(signal, 4, 21)
    assert not long[18:].any()
    long = long[:18]
    np.testing.assert_array_equal(long[4:-4], signal)
    taper = 0.5 * (1.0 + np.cos(np.pi * np.arange(1, 5) / 5))
    np.testing.assert_allclose(long[3::-1], (2 * 3.0 - signal[1:5]) * taper)
    np.testing.assert_allclose(long[-4:], (2 * 84.0 - signal[-2:-6:-1]) * taper)


@pytest.mark.parametrize("factor", [1, 2, 3, 5, 8])
def test_interpolation_passes_through_the_samples(factor):
    signal = np.random.default_rng(0).standard_normal(N)
    np.testing.assert_allclose(raise_rate(signal, factor)[::factor], signal, atol=1e-12)


@pytest.mark.parametrize("freq", [3.0, 120.0, 350.0])
@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_interpolation_of_a_sine_is_the_sine(freq, derivative):
    factor, omega = 4, 2.0 * np.pi * freq / FS
    found = raise_rate(sine(freq), factor, derivative=derivative)
    expected = omega**derivative * sine(freq, factor, phase=0.3 + derivative * np.pi / 2)
    tolerance = 2e-3 * max(omega**derivative, 1.0)  # a sine that is cut off at the ends rings there
    np.testing.assert_allclose(inside(found, factor), inside(expected, factor), atol=tolerance)


@pytest.mark.parametrize("factor", [1, 3, 4])
@pytest.mark.parametrize("cycles", [7, 300, 420])
def test_samples_held_linearly_have_the_spectrum_of_the_signal(factor, cycles):
    """Straight lines between samples multiply a spectrum by sinc^2 of the fine rate; the samples make up for it."""
    bell = np.exp(-(((np.arange(N) - N / 2) / (N / 10)) ** 2))
    signal = bell * np.cos(2.0 * np.pi * cycles * np.arange(N) / N)
    held = np.fft.rfft(raise_rate(signal, factor, for_linear_hold=True))[: N // 2] / factor
    held *= np.sinc(np.arange(N // 2) / (N * factor)) ** 2
    exact = np.fft.rfft(signal)[: N // 2]
    np.testing.assert_allclose(held, exact, atol=1e-9 * np.abs(exact).max())


IN_BAND = [(5.0, 1.0), (365.0, 1.0), (400.0, 0.5), (440.0, 0.0)]
BEYOND = [(620.0, 0.0), (1000.0, 0.0)]


@pytest.mark.parametrize(
    ("factor", "freq", "gain"), [(1, *pair) for pair in IN_BAND] + [(4, *pair) for pair in IN_BAND + BEYOND]
)
def test_the_recorder_passes_its_band_and_folds_nothing_into_it(factor, freq, gain):
    recorded = record_channels(sine(freq, factor)[None], factor, N, FS)[0]
    np.testing.assert_allclose(recorded[INSIDE], gain * sine(freq)[INSIDE], atol=5e-3)  # the ends ring


def test_the_recorder_differentiates_in_its_filter():
    factor, omega = 4, 2.0 * np.pi * 60.0
    fine = np.stack([sine(60.0, factor)] * 3)
    found = record_channels(fine, factor, N, FS, derivatives=np.array([0.0, 1.0, 2.0]))
    for order in range(3):
        expected = omega**order * sine(60.0, phase=0.3 + order * np.pi / 2)
        np.testing.assert_allclose(found[order, INSIDE], expected[INSIDE], atol=2e-3 * omega**order)


def test_a_steady_channel_stays_as_it_is():
    recorded = record_channels(np.full((1, 4 * N), 0.7), 4, N, FS)[0]
    np.testing.assert_allclose(recorded[INSIDE], 0.7, rtol=RIPPLE)
    np.testing.assert_allclose(recorded, 0.7, rtol=2e-3)  # the taper of the continuation bends in slowly


@pytest.mark.parametrize("more", [0, 1, 3])
def test_what_lies_beyond_the_last_sample_is_not_seen(more):
    factor = 4
    fine = np.random.default_rng(1).standard_normal((2, (N - 1) * factor + 1 + more))
    least = record_channels(fine[:, : (N - 1) * factor + 1], factor, N, FS)
    np.testing.assert_array_equal(record_channels(fine, factor, N, FS), least)


@pytest.mark.parametrize("n", [2, 5, 40])
def test_short_records_are_filtered_too(n):
    recorded = record_channels(np.ones((1, 3 * n)), 3, n, FS)
    assert recorded.shape == (1, n)
    assert np.isfinite(recorded).all()
    assert raise_rate(np.ones(n), 3).shape == (3 * n,)


@pytest.mark.parametrize(("factor", "n"), [(6, 129), (6, N), (9, N), (12, 500), (64, 300)])
def test_thinning_before_the_transform_changes_nothing_that_is_seen(factor, n):
    """Against one transform of all samples; impacts reach the end of the spectrum."""
    rng = np.random.default_rng(factor)
    fine = np.cumsum(rng.standard_normal((2, (n - 1) * factor + 1)) * (rng.random((n - 1) * factor + 1) < 0.02), axis=1)
    pad = min(PAD, n - 1)
    length = fft.next_fast_len(n + 2 * pad, real=True)
    spectrum = fft.rfft(continued(fine, pad * factor, length * factor))[:, : length // 2 + 1]
    freq = np.arange(length // 2 + 1) * (FS / length)
    for order in (0, 1):
        lines = spectrum * recorder_gain(freq, FS) / factor * (2j * np.pi * freq) ** order
        whole = fft.irfft(lines, length)[:, pad : pad + n]
        found = record_channels(fine, factor, n, FS, derivatives=np.full(2, order))
        np.testing.assert_allclose(found, whole, atol=1e-8 * np.abs(whole).max())


def test_a_record_as_short_as_what_is_continued_is_not_thinned():
    fine = np.random.default_rng(0).standard_normal((1, 6 * PAD))
    spectrum = fft.rfft(continued(fine[:, : 6 * (PAD - 1) + 1], 6 * (PAD - 1), 6 * 384))
    assert fft.next_fast_len(PAD + 2 * (PAD - 1), real=True) == 384
    freq = np.arange(193) * (FS / 384)
    whole = fft.irfft(spectrum[:, :193] * recorder_gain(freq, FS) / 6, 384)[:, PAD - 1 : 2 * PAD - 1]
    np.testing.assert_allclose(record_channels(fine, 6, PAD, FS), whole, atol=1e-13)
