"""The verification's decays against closed forms, the equation of motion, and the noise's level."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from identification.decay.verification import (
    DURATION,
    MASS,
    OMEGA,
    SAMPLING_RATE,
    STIFFNESS,
    Piece,
    known_decay,
    noisy,
    verification_decay,
)
from models.errors import InputError

ROUNDING = 1e-11  # of 25600 steps, each rounded to 1e-16, on a phase of 1265 rad


def closed_form(damping, t, x=1.0, v=0.0):
    rate = 0.5 * damping / MASS
    omega = np.sqrt(OMEGA**2 - rate**2)
    return np.exp(-rate * t) * (x * np.cos(omega * t) + (v + rate * x) / omega * np.sin(omega * t))


@pytest.mark.parametrize("damping", [0.0, 0.06, 5.0])
def test_a_constant_damping_has_a_closed_form(damping):
    known = known_decay((Piece(0.0, damping, 0.0),))
    assert known.time.size == DURATION * SAMPLING_RATE
    np.testing.assert_allclose(known.signal, closed_form(damping, known.time), atol=ROUNDING)


def test_the_step_is_two_closed_forms():
    known = verification_decay("step")
    before = known.time <= 50.0
    h = 1e-5
    v = (closed_form(0.06, 50.0 + h) - closed_form(0.06, 50.0 - h)) / (2.0 * h)
    later = closed_form(0.01, known.time[~before] - 50.0, closed_form(0.06, 50.0), v)
    np.testing.assert_allclose(known.signal[before], closed_form(0.06, known.time[before]), atol=ROUNDING)
    np.testing.assert_allclose(known.signal[~before], later, atol=1e-9)  # the difference quotient's h^2 omega^3 / 6
    np.testing.assert_array_equal(known.damping, np.where(before, 0.06, 0.01))


def test_the_line_satisfies_its_equation_of_motion():
    """With the fourth-order differences of the displacement, whose errors are (omega h)^4 / 30."""
    known = verification_decay("line")
    x, h, i = known.signal, 1.0 / SAMPLING_RATE, slice(2, -2)
    v = (x[:-4] - 8.0 * x[1:-3] + 8.0 * x[3:-1] - x[4:]) / (12.0 * h)
    a = (-x[:-4] + 16.0 * x[1:-3] - 30.0 * x[i] + 16.0 * x[3:-1] - x[4:]) / (12.0 * h * h)
    left = MASS * a + known.damping[i] * v + STIFFNESS * x[i]
    assert np.abs(left).max() < STIFFNESS * (OMEGA * h) ** 4 / 30.0
    np.testing.assert_allclose(known.damping, 0.06 - 0.0002 * known.time, rtol=1e-12)


def test_a_steep_line_is_what_a_general_integrator_makes_of_it():
    known, slope = known_decay((Piece(0.0, 1.0, 2.0),)), 2.0

    def motion(t, x):
        return [x[1], -((1.0 + slope * t) * x[1] + STIFFNESS * x[0]) / MASS]

    times = known.time[:1280]
    found = solve_ivp(motion, (0.0, 5.0), [1.0, 0.0], "DOP853", times, rtol=1e-11, atol=1e-13).y[0]
    np.testing.assert_allclose(known.signal[:1280], found, atol=1e-9)  # its tolerance over ten periods


def test_the_lines_amplitude_falls_by_the_integral_of_its_damping():
    """At the turning points, but for (rate / omega)^2 = 2e-7."""
    known = verification_decay("line")
    crests = np.flatnonzero((known.signal[1:-1] > known.signal[:-2]) & (known.signal[1:-1] > known.signal[2:])) + 1
    expected = np.exp(-(0.06 * known.time - 0.0001 * known.time**2) / (2.0 * MASS))[crests]
    np.testing.assert_allclose(
        known.signal[crests], expected, rtol=4e-4
    )  # half a sample off the crest, (omega h/2)^2/2


def test_the_noise_has_the_level_asked_for_and_the_seed_decides_it():
    signal = verification_decay("step").signal
    noise = noisy(signal, 40.0, 3) - signal
    assert np.std(noise) / np.sqrt(np.mean(signal**2)) == pytest.approx(0.01, rel=0.02)  # 25600 samples
    np.testing.assert_array_equal(noisy(signal, 40.0, 3) - signal, noise)
    assert np.abs(noisy(signal, 40.0, 4) - signal - noise).max() > 0.0


def test_an_unknown_case_is_refused():
    with pytest.raises(InputError, match=r"case 'ramp'; the verification has step and line; choose one"):
        verification_decay("ramp")
