import numpy as np
import pytest

from identification.decay.own_scale import noise_of_rate, own_scale

FS = 256.0


def test_the_noise_is_that_of_the_weights():
    """Sums over the samples of a Gaussian window against the integrals."""
    scale = 40.0
    tau = np.arange(-400, 401)
    weights = tau * np.exp(-0.5 * (tau / scale) ** 2)
    g = weights / np.sum(tau * weights)
    expected = 0.02 * FS * np.sqrt(2.0 * np.sum(g**2))
    assert noise_of_rate(scale, FS, np.array([0.02]))[0] == pytest.approx(expected, rel=1e-9)


def test_a_steady_rate_asks_for_the_longest_window_that_fits():
    chosen = own_scale(FS, 2.0, np.full(25600, -0.01), np.full(25600, 0.01))
    assert chosen * 12.0 < 25600
    assert chosen > 1500.0


def test_more_noise_asks_for_a_longer_window():
    rate = np.where(np.arange(25600) < 12800, -0.006, -0.001)
    quiet, loud = (own_scale(FS, 2.0, rate, np.full(25600, share)) for share in (1e-3, 3e-2))
    assert quiet < loud
