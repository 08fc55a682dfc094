import numpy as np
import pytest
from decay_scenes import FS, MASS, OMEGA

from identification.decay.cramer_rao import decay_floor, information_inverse, stepped, straight

OF = {"omega": OMEGA, "phase": 0.0, "fs": FS, "n_samples": 25600}


def test_a_straight_line_has_the_textbook_variance():
    t = np.arange(100.0)
    bound = information_inverse(np.stack([np.ones(100), t - t.mean()]), 0.25)
    assert np.diag(bound) == pytest.approx([0.25 / 100, 0.25 / np.sum((t - t.mean()) ** 2)])


def test_frequency_of_an_undamped_sine_has_the_textbook_variance():
    """Kay 1993, example 3.14: var(omega) = 12 s^2 / (A^2 / 2 N (N^2 - 1)) fs^2, away from 0 and fs / 2."""
    floor = decay_floor(straight(0.0, 0.0), snr_db=40.0, **{**OF, "omega": 2.0 * np.pi * 40.0})
    t = np.arange(25600) / FS
    s2 = 0.5e-4
    columns = np.stack([np.cos(80 * np.pi * t), -np.sin(80 * np.pi * t), -t * np.sin(80 * np.pi * t)])
    variance = information_inverse(columns, s2)[2, 2]
    assert variance == pytest.approx(12.0 * s2 * FS**2 / (0.5 * 25600 * (25600.0**2 - 1.0)), rel=1e-3)
    assert floor.rms > 0.0


def test_gradients_of_the_forms_are_their_differences():
    t = np.linspace(0.0, 100.0, 997)
    for form in (straight(0.006, -2e-5), stepped(0.006, 0.001, 50.03)):
        exact = form.gradient(form.values, t)
        for i, size in enumerate(1e-6 * np.abs(form.values)):
            nudge = np.eye(len(form.values))[i] * size
            slope = (form.loss(form.values + nudge, t) - form.loss(form.values - nudge, t)) / (2.0 * size)
            assert exact[i] == pytest.approx(slope, abs=1e-3 * np.abs(slope).max())


@pytest.mark.parametrize(("snr_db", "expected"), [(40.0, 0.00102), (60.0, 0.00032)])
def test_the_floor_of_the_step(snr_db, expected):
    """Independent figures for the article's step, given to two or three digits."""
    floor = decay_floor(stepped(0.006, 0.001, 50.0), snr_db=snr_db, **OF)
    assert 2.0 * MASS * floor.rms == pytest.approx(expected, rel=0.02)
    assert floor.mean_rms < floor.rms


@pytest.mark.parametrize(("snr_db", "expected"), [(40.0, 0.000054), (60.0, 0.0000054)])
def test_the_floor_of_the_line(snr_db, expected):
    floor = decay_floor(straight(0.006, -2e-5), snr_db=snr_db, **OF)
    assert 2.0 * MASS * floor.rms == pytest.approx(expected, rel=0.02)
