"""The crest of a map that is drawn ends where it sinks into the noise."""

import numpy as np
import pytest

from identification.decay.identify import identify
from identification.decay.wavelet import morlet_transform
from testbed.identify.scalogram import crest_of, noise_beside, scalogram_of

FS, FREQ, NOISE = 512.0, 20.0, 1e-3
LINES = np.linspace(14.0, 26.0, 40)


def ringing(rate, size):
    t = np.arange(size) / FS
    noise = NOISE * np.random.default_rng(0).standard_normal(size)
    return np.exp(-rate * t) * np.cos(2.0 * np.pi * FREQ * t) + noise


def test_the_crest_is_the_mode_and_ends_where_the_noise_is_reached():
    rate = 2.0
    shown = morlet_transform(ringing(rate, 4096), FS, LINES)
    crest = crest_of(shown, LINES, np.full(len(LINES), NOISE))
    last = int(np.flatnonzero(np.isfinite(crest))[-1])
    assert np.isfinite(crest[: last + 1]).all()
    # exp(-rate t) is three times what is called noise at ln(1 / 0.003) / rate; what noise there is moves that a little
    assert last / FS == pytest.approx(np.log(1.0 / (3.0 * NOISE)) / rate, abs=0.2)
    np.testing.assert_allclose(crest[50 : last - 50], FREQ, rtol=0.02)


def test_without_noise_the_crest_ends_at_the_darkest_shade():
    t = np.arange(4096) / FS
    shown = morlet_transform(np.exp(-2.0 * t) * np.cos(2.0 * np.pi * FREQ * t), FS, LINES)
    last = int(np.flatnonzero(np.isfinite(crest_of(shown, LINES, np.zeros(len(LINES)))))[-1])
    assert last / FS == pytest.approx(np.log(1e3) / 2.0, abs=0.1)  # -60 dB; the predicted beginning is loudest


def test_the_noise_beside_a_mode_is_that_of_its_signal():
    found = identify([ringing(1.0, 4096)[None]], [0.0], FS, np.ones(1))
    (mode,) = found.decays[0].modes
    assert noise_beside(mode, FS) == pytest.approx(NOISE, rel=0.3)  # of the density about one mode
    drawn = scalogram_of(mode, FS)
    assert drawn.crest[0] == pytest.approx(FREQ, rel=0.02)
