"""Backbone curves: Duffing's closed form, and that they pass through the tops of the nonlinear FRFs."""

import numpy as np
import pytest
from balance_scenes import CUBIC, MASS, OSCILLATOR, STIFFNESS, sleeved

from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.errors import InputError
from models.harmonic_balance import backbone, nonlinear_frf
from models.plant import build_plant


def test_duffing_has_the_backbone_of_its_free_motion():
    """omega^2 = k / m + 3 k3 a^2 / (4 m) - k3^2 a^4 / ..., Nayfeh and Mook, equation 4.1.19, to first order."""
    curve = backbone(build_plant(OSCILLATOR, [CubicStiffness(Place(), CUBIC)]), "mass", 0.4, (8.0, 12.0), 500.0)
    a = np.abs(curve.read(["mass"])[:, 0, 1])
    omega = np.sqrt((STIFFNESS + 0.75 * CUBIC * a**2) / MASS)
    assert curve.freqs == pytest.approx(omega / (2 * np.pi), rel=1e-3)
    assert curve.amplitudes[0] == pytest.approx(4e-4)
    assert curve.amplitudes[-1] >= 0.4
    assert curve.freqs[-1] > 10.4


def test_it_passes_through_the_tops():
    plant, tip = build_plant(sleeved()), "displacement"
    spine = backbone(plant, tip, 2.0, (6.0, 16.0), 400.0)
    assert spine.ended == ""
    steps = np.linspace(0.0, len(spine.freqs) - 1.0, 2000)
    freqs, sizes = (
        np.interp(steps, np.arange(len(spine.freqs)), course)
        for course in (spine.freqs, np.abs(spine.read([tip])[:, 0, 1]))
    )
    for amplitude in (0.1, 0.3):
        curve = nonlinear_frf(plant, amplitude, (6.0, 16.0), 400.0)
        size = np.abs(curve.read([tip])[:, 0, 1])
        top = size.argmax()
        # Damping is small, so the largest motion and phase resonance are close, but not the same.
        assert np.hypot(freqs / curve.freqs[top] - 1.0, sizes / size[top] - 1.0).min() < 0.02


def test_no_resonance_in_the_band_is_told():
    with pytest.raises(InputError, match="phase resonance"):
        backbone(build_plant(OSCILLATOR), "mass", 1.0, (11.0, 14.0), 100.0)
