"""Modes followed to the ends of their records, and ridges that cross noise and louder transients."""

import numpy as np
import pytest

from identification.decay.ridge import CENTRE_FREQUENCY, EDGES, TILT, find_ridge, follow_mode
from identification.decay.verification import MASS, OMEGA, SAMPLING_RATE, noisy, verification_decay
from identification.decay.wavelet import morlet_transform
from identification.decay.windows import WINDOWS
from models.errors import InputError

FS = 200.0
T = np.arange(4000) / FS
BY_SHAPE = pytest.mark.parametrize("shape", WINDOWS)


def decay(ratio, freq=10.0, t=T):
    omega = 2.0 * np.pi * freq
    return 2.0 * np.exp(-ratio * omega * t) * np.cos(omega * t + 0.3)


def worst(skeleton, ratio, freq=10.0):
    """Largest errors of the damping ratio, of the frequency and of the amplitude, the last two relative."""
    omega = 2.0 * np.pi * freq
    return (
        np.abs(skeleton.damping_ratio - ratio).max(),
        np.abs(skeleton.frequency / freq - 1.0).max(),
        np.abs(skeleton.amplitude / (2.0 * np.exp(-ratio * omega * skeleton.time)) - 1.0).max(),
    )


@BY_SHAPE
@pytest.mark.parametrize("ratio", [0.0, 2e-4, 1e-3, 1e-2, 3e-2])
def test_a_decay_is_found_at_its_ends_as_in_its_middle(shape, ratio):
    """A decay within a window below TILT is taken for a line, which misses its square; above, it is fitted again."""
    found = follow_mode(decay(ratio)[:1000], FS, 10.0, 30.0, shape)
    within = ratio * 2.0 * np.pi * 10.0 * 0.15
    ratio_error, freq_error, amplitude_error = worst(found, ratio)
    assert ratio_error < 1.5 * min(within, TILT) * ratio + 1e-12
    assert max(freq_error, amplitude_error) < 1.5 * within * min(within, TILT) + 1e-10
    assert (found.window, found.shape, found.edges) == (0.15, shape, "fitted")


@pytest.mark.parametrize("off", [0.98, 1.02])
def test_a_frequency_known_to_two_percent_is_enough(off):
    assert max(worst(follow_mode(decay(2e-3), FS, 10.0 * off, 30.0), 2e-3)) < 1e-4


def test_a_sweep_is_followed_along_its_ridge():
    freq = 10.0 + 0.3 * T
    phase = 2.0 * np.pi * (10.0 * T + 0.15 * T**2)
    found = follow_mode(np.exp(-0.05 * T) * np.cos(phase), FS, freq, 30.0)
    # The phase bends by pi 0.3 0.15^2 = 0.02 rad within a window, which the square brings into amplitude and slope.
    np.testing.assert_allclose(found.frequency, freq, rtol=1e-3)
    np.testing.assert_allclose(found.decay_rate, 0.05, atol=1e-3)


@pytest.mark.parametrize("edges", EDGES)
def test_only_the_ends_depend_on_their_treatment(edges):
    found, fitted = follow_mode(decay(1e-3), FS, 10.0, 30.0, edges=edges), follow_mode(decay(1e-3), FS, 10.0, 30.0)
    inside = slice(200, -200)
    np.testing.assert_allclose(found.damping_ratio[inside], fitted.damping_ratio[inside], rtol=1e-5)
    assert found.edges == edges


def test_fitted_ends_are_better_than_every_continuation():
    """A missing half of a window seems a decay within its width; a mirror breaks the phase; a prediction fades out."""
    errors = {edges: worst(follow_mode(decay(5e-3), FS, 10.0, 30.0, edges=edges), 5e-3)[0] for edges in EDGES}
    assert errors["fitted"] < 1e-2 * errors["predicted"]
    assert errors["predicted"] < 1e-2 * min(errors["mirror"], errors["zero"])
    assert errors["zero"] == pytest.approx(np.sqrt(2.0 / np.pi) / (2.0 * np.pi * 10.0 * 0.15), rel=0.1)


def test_noise_enters_as_the_window_says():
    """std of the slope = sqrt(0.141 2 sigma^2 / (A^2 a^3 fs)), a in seconds: the Gaussian's, of white noise."""
    a, sigma = 0.15, 1e-3
    signal = decay(0.0) + sigma * np.random.default_rng(0).normal(size=T.size)
    found = follow_mode(signal, FS, 10.0, a * FS).decay_rate[200:-200]
    expected = np.sqrt(2.0 * sigma**2 / (4.0 * np.sqrt(np.pi) * 4.0 * a**3 * FS))
    assert np.std(found) == pytest.approx(expected, rel=0.3)  # 80 independent windows


def test_a_break_keeps_the_windows_apart():
    """A decay rate that steps where two signals are joined: with the break, each side is as if it were alone."""
    first, second = decay(1e-3, t=T[:2000]), decay(4e-3, t=T[:2000])
    found = follow_mode(np.concatenate((first, second)), FS, 10.0, 30.0, breaks=(10.0,))
    alone = [follow_mode(part, FS, 10.0, 30.0).damping_ratio for part in (first, second)]
    np.testing.assert_array_equal(found.damping_ratio, np.concatenate(alone))
    assert np.abs(found.damping_ratio[:2000] - 1e-3).max() < 1e-4


def test_without_a_scale_the_window_suits_the_mode_and_a_short_record():
    assert follow_mode(decay(1e-3), FS, 10.0).centre_frequency == pytest.approx(CENTRE_FREQUENCY, rel=1e-3)
    assert follow_mode(decay(1e-3)[:200], FS, 10.0).window == pytest.approx(1.0 / 8.0)


@pytest.mark.parametrize(("case", "bar"), [("step", 0.0019), ("line", 0.00105)])
def test_the_verification_at_the_scale_of_the_article(case, bar):
    """Smearing a jump and passing noise cost 0.0018 N s/m together at 60 dB; without a jump the noise alone is left."""
    known, errors = verification_decay(case), []
    for seed in range(3):
        measured = noisy(known.signal, 60.0, seed)
        found = follow_mode(measured, SAMPLING_RATE, OMEGA / (2.0 * np.pi), 2.0**6.68)
        errors.append(np.sqrt(np.mean((2.0 * MASS * found.decay_rate - known.damping) ** 2)))
    assert 0.9 * bar < np.mean(errors) < bar


def test_a_ridge_runs_along_a_sweep():
    freq = 20.0 + 0.5 * T
    signal = np.cos(2.0 * np.pi * (20.0 * T + 0.25 * T**2))
    lines = np.geomspace(15.0, 40.0, 60)
    scalogram = morlet_transform(signal, FS, lines, 12.0)
    # The crest of |W| lies within a twentieth of a line of the sweep, but for the ends.
    np.testing.assert_allclose(find_ridge(scalogram, lines)[50:-50], freq[50:-50], rtol=1e-3)
    np.testing.assert_allclose(find_ridge(scalogram[::-1], lines[::-1])[50:-50], freq[50:-50], rtol=1e-3)


def test_a_louder_knock_does_not_lead_a_ridge_astray():
    knock = 4.0 * np.exp(-0.5 * ((T - 10.0) / 0.1) ** 2) * np.cos(2.0 * np.pi * 25.0 * T)
    lines = np.linspace(8.0, 30.0, 89)
    scalogram = morlet_transform(decay(0.0) + knock, FS, lines, ends="predicted")
    np.testing.assert_allclose(find_ridge(scalogram, lines), 10.0, rtol=0.02)
    assert find_ridge(scalogram, lines, 0.0).max() > 24.0


def test_a_ridge_at_the_border_stays_in_the_band():
    lines = np.linspace(11.0, 14.0, 10)
    ridge = find_ridge(morlet_transform(decay(0.0), FS, lines), lines)
    assert ridge.min() >= 11.0
    assert ridge.max() <= lines[1]


def test_bad_input_is_refused():
    signal = decay(1e-3)
    with pytest.raises(InputError, match=r"size \(2, 4000\), 0 samples not finite; a mode is followed in one channel"):
        follow_mode(np.stack((signal, signal)), FS, 10.0)
    with pytest.raises(InputError, match=r"1 frequencies from 120 to 120 Hz; .*between 0 and 100 Hz; pass"):
        follow_mode(signal, FS, 120.0)
    with pytest.raises(InputError, match=r"7 frequencies from 10 to 10 Hz; a ridge is one frequency, or one for each"):
        follow_mode(signal, FS, np.full(7, 10.0))
    with pytest.raises(InputError, match=r"scale of 0.5 samples; a window holds several samples; ask for 1"):
        follow_mode(signal, FS, 10.0, 0.5)
    with pytest.raises(InputError, match=r"edges = 'cut'; the ends of a record are fitted, zero, mirror, predicted"):
        follow_mode(signal, FS, 10.0, edges="cut")
    with pytest.raises(InputError, match=r"0.1 s from 10 s on, and a window of 0.15 s; .* twice; take a smaller scale"):
        follow_mode(signal, FS, 10.0, 30.0, breaks=(10.0, 10.1))
    with pytest.raises(InputError, match=r"scalogram of size \(5, 10\) and 4 frequencies; .*three lines or more; pass"):
        find_ridge(np.ones((5, 10), complex), np.arange(4.0))
    with pytest.raises(InputError, match=r"stiffness of -1; it is 0 or more; ask for 10"):
        find_ridge(np.ones((3, 10), complex), np.arange(1.0, 4.0), -1.0)
