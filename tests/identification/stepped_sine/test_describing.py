"""What a law is to a sine: closed forms, and energy against a simulated cycle."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from identification.stepped_sine.describing import describing_function
from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.end_stop import EndStop
from models.effects.point_damping import PointDamping
from models.effects.protocol import Place
from models.effects.quadratic_stiffness import QuadraticStiffness
from models.ports import PointLaw, Port
from models.structure import Structure

OMEGA = 500.0
AMPLITUDES = np.geomspace(1e-6, 1e-3, 7)
BLOCK = Structure(0.0, 0.0, 5e5, 2.0, (0.2, 0.0), 0.0)
ROUNDING = 1e-12


def kappa(effect, amplitude=AMPLITUDES, omega=OMEGA):
    (law,) = effect.point_laws(None, BLOCK)
    return describing_function(law, np.asarray(amplitude, float), omega)


def dashpot(t, q, v, z, p):
    return -p[0] * v


def test_a_dashpot_is_a_dashpot():
    law = PointLaw(Port(None), dashpot, (3.0,))
    np.testing.assert_allclose(describing_function(law, AMPLITUDES, OMEGA), 3.0j * OMEGA, rtol=ROUNDING)
    assert PointDamping.kind == "point_damping"


def test_a_cubic_spring_is_three_quarters_of_it_at_the_peak():
    np.testing.assert_allclose(kappa(CubicStiffness(Place(), 1e9)), 0.75e9 * AMPLITUDES**2, rtol=ROUNDING)


def test_a_quadratic_spring_has_no_first_harmonic():
    np.testing.assert_allclose(kappa(QuadraticStiffness(Place(), 1e9)), 0.0, atol=ROUNDING * 1e6)


def test_friction_is_four_over_pi_of_it_against_the_speed():
    slips_at = 1e-9  # far below every speed of the cycle, where the law is a sign
    expected = 4.0 * 2.0 / (pi * AMPLITUDES) * 1j
    # The reversal, at which the law jumps, is a point of Simpson's rule: 1e-7 with 128 points.
    np.testing.assert_allclose(kappa(CoulombFriction(Place(), 2.0, slips_at)), expected, rtol=1e-6, atol=1e-6)


def test_a_stop_stiffens_as_den_hartog_says():
    gap, ratio = 1e-4, np.array([0.5, 1.0, 1.25, 2.0, 5.0])
    reached = np.arccos(np.minimum(1.0 / ratio, 1.0))
    expected = 1e4 * (2.0 * reached - np.sin(2.0 * reached)) / pi
    # Simpson's rule does not see where between two of 128 points the stop is met.
    np.testing.assert_allclose(kappa(EndStop(Place(), 1e4, gap), gap * ratio).real, expected, atol=5e-4 * 1e4)


@pytest.mark.parametrize("exponent", [1.0, 1.7, 3.0])
@pytest.mark.parametrize("ratio", [0.1, 0.5, 1.0, 3.0, 20.0])
def test_hysteresis_loses_what_a_simulated_cycle_loses(exponent, ratio):
    force, yields = 2.0, 1e-4
    effect = BoucWen(Place(), force, yields, exponent)
    a = ratio * yields

    def motion(t, state):
        v = a * OMEGA * np.cos(OMEGA * t)
        rate = effect.rate(t, 0.0, v, state[0], (force, yields, exponent))
        return [rate, force * state[0] * v]

    period = 2.0 * pi / OMEGA
    step = period / 200
    cycles = 6 if ratio > 0.2 else 60  # a loop so small takes long to close
    state = solve_ivp(motion, (0.0, cycles * period), [0.0, 0.0], max_step=step, rtol=1e-8, atol=1e-10).y[:, -1]
    after = solve_ivp(motion, (0.0, period), [state[0], 0.0], max_step=step, rtol=1e-8, atol=1e-10).y[1, -1]
    # Energy per cycle of a complex stiffness is pi a^2 Im(kappa); 128 points meet a sharp corner within 1 %.
    assert pi * a**2 * kappa(effect, [a]).imag[0] == pytest.approx(after, rel=1e-2)


def pull(t, q, v, z, p):
    return -z


def slips_sooner_one_way(t, q, v, z, p):
    limit = p[1] if z > 0.0 else p[2]
    return v * p[0] * (1.0 - (abs(z) / limit if z * v > 0.0 else 0.0))


@pytest.mark.parametrize("limits", [(1.0, 1.0), (0.5, 2.0)], ids=["alike both ways", "not alike"])
def test_a_loop_has_the_first_harmonic_of_its_simulated_cycle_however_it_slips(limits):
    numbers, a = (2e4, *limits), 2e-4

    def rate(t, z):
        return [slips_sooner_one_way(0.0, 0.0, a * OMEGA * np.cos(OMEGA * t), z[0], numbers)]

    period = 2.0 * pi / OMEGA
    time = 30.0 * period + np.linspace(0.0, period, 4001)
    z = solve_ivp(rate, (0.0, 31.0 * period), [0.0], t_eval=time, max_step=period / 400, rtol=1e-8, atol=1e-10).y[0]
    # q = a sin: its quadrature leads by a quarter.
    turning = np.exp(-1j * (OMEGA * time - 0.5 * pi))
    expected = 2.0 / period * np.trapezoid(z * turning, time) / a
    (found,) = describing_function(PointLaw(Port(None), pull, numbers, slips_sooner_one_way), np.array([a]), OMEGA)
    assert found == pytest.approx(expected, rel=1e-4)


def test_small_hysteresis_is_a_spring_and_large_is_friction():
    effect = BoucWen(Place(), 2.0, 1e-4, 1.0)
    small, large = kappa(effect, [1e-8, 1e-2])
    assert small == pytest.approx(2.0 / 1e-4, rel=1e-3)  # slip share a / u_y = 1e-4
    assert large.imag == pytest.approx(4.0 * 2.0 / (pi * 1e-2), rel=2e-2)  # the elastic part after reversals, u_y / a


def test_nothing_gives_energy():
    for effect in (BoucWen(Place(), 2.0, 1e-4, 2.0), CoulombFriction(Place(), 1.0, 1e-2), EndStop(Place(), 1e4, 1e-5)):
        assert np.all(kappa(effect).imag >= -1e-9 * np.abs(kappa(effect)))
