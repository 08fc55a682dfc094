"""The damping between two Morlet waves: exact for a decay that stays, a curvature for one that does not."""

import numpy as np
import pytest

from identification.decay.morlet_wave import morlet_wave_damping
from models.errors import InputError

FS, FREQ = 256.0, 8.0
OMEGA = 2.0 * np.pi * FREQ
T = np.arange(4096) / FS


@pytest.mark.parametrize("ratio", [0.003, 0.01])
@pytest.mark.parametrize("periods", [20, 40])
def test_a_decay_that_stays_is_found_over_the_whole_record(ratio, periods):
    found = morlet_wave_damping(np.exp(-ratio * OMEGA * T) * np.cos(OMEGA * T + 0.4), FS, FREQ, periods)
    assert found.shape == T.shape
    # The fourth cumulant of the cut wave, over its variance times (xi omega s)^2 / 24.
    np.testing.assert_allclose(found, ratio, rtol=5e-3)


def test_a_wave_without_ends_gives_the_published_form():
    """The variance of a wave of spread 10 that is cut at 3.5 standard deviations is 0.6 % below s^2."""
    signal = np.exp(-0.01 * OMEGA * T) * np.cos(OMEGA * T)
    k, (n_1, n_2) = 40, (10.0, 20.0)
    half = round(0.5 * k * FS / FREQ)
    t = np.arange(-half, half + 1) / FS
    integrals = []
    for n in (n_1, n_2):
        s = np.sqrt(2.0) * k / (FREQ * n)
        wave = np.exp(-0.5 * (t / s) ** 2 - 1j * OMEGA * t) / s
        integrals.append(np.abs(np.sum(signal[2048 - half : 2048 + half + 1] * wave)))
    published = n_1 * n_2 / (2.0 * np.pi * k) * np.sqrt(np.log(integrals[0] / integrals[1]) / (n_2**2 - n_1**2))
    assert morlet_wave_damping(signal, FS, FREQ, k)[2048] == pytest.approx(published, rel=0.03)


def test_a_decay_that_changes_is_misread():
    """ln of the weighed mean of A is (sigma^2 - sigma') v / 2: a falling rate sigma passes for a higher damping."""
    sigma, slope = 0.3, -0.01
    log_amplitude = -(sigma * (T - 8.0) + 0.5 * slope * (T - 8.0) ** 2)
    found = morlet_wave_damping(np.exp(log_amplitude) * np.cos(OMEGA * T), FS, FREQ, 30)[2048] * OMEGA
    assert found == pytest.approx(np.sqrt(sigma**2 - slope), rel=5e-3)


def test_a_growing_mean_gives_zero():
    noise = np.random.default_rng(0).normal(size=T.size)
    assert morlet_wave_damping(np.cos(OMEGA * T) + 1e-3 * noise, FS, FREQ, 20).min() == 0.0


def test_waves_longer_than_the_record_are_refused():
    with pytest.raises(InputError, match=r"waves of 200 periods, 25 s, in a record of 16 s; .*; ask for 127 periods"):
        morlet_wave_damping(T, FS, FREQ, 200)
