"""Forces at a point: film, friction, hardening spring, hysteresis."""

from math import pi, sqrt

import numpy as np
import pytest
from effect_scenes import CONTACT, PLACES
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.gap_offset import GapOffset
from models.effects.protocol import Place
from models.effects.squeeze_film import SqueezeFilm
from models.ports import Port
from models.structure import Structure

BLOCK = Structure(0.0, 0.0, 1200.0, 3.0, (0.2, 0.0), 0.0)
displacements = st.floats(-1e-3, 1e-3)
velocities = st.floats(-1.0, 1.0)


def law_of(effect, contact=CONTACT):
    (law,) = effect.point_laws(contact if effect.place.sleeve else None, BLOCK)
    return law


def force(effect, q, v, z=0.0):
    law = law_of(effect)
    return law.force(0.0, q, v, z, law.parameters)


def film(damping=20.0):
    return SqueezeFilm(PLACES["sleeve"], damping=damping)


def friction(friction_force=2.0, slip_velocity=1e-3, against="base"):
    return CoulombFriction(Place(), friction_force, slip_velocity, against)


@pytest.mark.parametrize("eccentricity", [0.0, 0.3, 0.6, 0.9])
def test_the_film_is_that_of_reynolds_equation_for_a_long_bearing(eccentricity):
    """Pressure of a full film squeezed along the line of centres, integrated over the journal; the rest is in c_f."""
    pressure_force, _ = quad(lambda a: np.sin(a) ** 2 / (1.0 + eccentricity * np.cos(a)) ** 3, 0.0, 2.0 * pi)
    ratio = force(film(), eccentricity * CONTACT.clearance, 0.1) / force(film(), 0.0, 0.1)
    assert ratio == pytest.approx(pressure_force / pi, rel=1e-7)  # the quadrature's own error


def test_amid_the_gap_the_film_is_a_dashpot():
    assert force(film(), 0.0, 0.1) == -2.0


def test_at_the_wall_and_beyond_the_film_stays_as_it_is_at_095():
    at_limit = -20.0 * 0.1 / (1.0 - 0.95**2) ** 1.5
    for q in (0.95, 1.0, 1.5, -3.0):
        assert force(film(), q * CONTACT.clearance, 0.1) == pytest.approx(at_limit)


def test_the_film_has_the_shape_of_the_gap_that_other_effects_left():
    law = law_of(film(), GapOffset(PLACES["sleeve"], offset=1e-4).change_contact(CONTACT))
    assert law.force(0.0, 1e-4, 0.1, 0.0, law.parameters) == -2.0


def test_friction_is_the_friction_force_well_above_the_slip_velocity():
    assert force(friction(), 0.0, 0.1) == pytest.approx(-2.0)
    assert force(friction(), 0.0, -0.1) == pytest.approx(2.0)


def test_friction_is_a_dashpot_well_below_the_slip_velocity():
    assert force(friction(), 0.0, 1e-6) == pytest.approx(-2.0 * 1e-6 / 1e-3, rel=1e-6)  # (v / v_s)^2 / 3


def test_friction_against_the_ground_reads_absolute_motion():
    assert law_of(friction()).port == Port(None, frame="base")
    assert law_of(friction(against="ground")).port == Port(None, frame="ground")
    assert friction(against="ground").label() == "coulomb_friction against ground"


def test_a_sliding_block_loses_four_friction_forces_over_the_stiffness_a_cycle():
    """Free vibration of a mass on a spring: 4 F_c / k of amplitude a cycle, whatever the amplitude."""
    law, mass, stiffness = law_of(friction(2.0, 1e-5)), 3.0, 1200.0

    def motion(t, state):
        q, v = state
        return v, (law.force(t, q, v, 0.0, law.parameters) - stiffness * q) / mass

    period = 2.0 * pi * sqrt(mass / stiffness)
    end = solve_ivp(motion, (0.0, 3.0 * period), (0.1, 0.0), method="LSODA", rtol=1e-8, atol=1e-11).y[0, -1]
    # The smoothed sign and the tolerances leave about 1e-5 m; a cycle loses 6.7e-3 m.
    assert end == pytest.approx(0.1 - 3.0 * 4.0 * 2.0 / stiffness, abs=1e-4)


def test_the_cubic_spring():
    spring = CubicStiffness(PLACES["position"], stiffness=1e9)
    assert force(spring, 2e-3, 0.0) == pytest.approx(-8.0)
    assert force(spring, -2e-3, 5.0) == pytest.approx(8.0)


@given(q=displacements)
def test_the_cubic_spring_gives_back_what_it_takes(q):
    """The force is minus the slope of the energy k q^4 / 4 and knows no velocity."""
    spring, h = CubicStiffness(PLACES["position"], stiffness=1e9), 1e-6
    slope = 1e9 * ((q + h) ** 4 - (q - h) ** 4) / (8.0 * h)
    # Central difference: k q h^2.
    assert force(spring, q, 0.3) == pytest.approx(-slope, abs=1e9 * 1e-3 * h * h * 1.01)


@pytest.mark.parametrize("effect", [film(), friction(), friction(slip_velocity=0.5)], ids=lambda e: e.kind)
@given(q=displacements, v=velocities)
def test_film_and_friction_only_take_energy(effect, q, v):
    assert force(effect, q, v) * v <= 0.0


def cycled(effect, amplitude, frequency=5.0, cycles=3.0):
    """q, v and z of a hysteretic law under q = amplitude sin(2 pi frequency t)."""
    law, omega = law_of(effect), 2.0 * pi * frequency
    time = np.linspace(0.0, cycles / frequency, 6001)
    q, v = amplitude * np.sin(omega * time), amplitude * omega * np.cos(omega * time)

    def rate(t, z):
        return law.rate(
            t, amplitude * np.sin(omega * t), amplitude * omega * np.cos(omega * t), float(z[0]), law.parameters
        )

    end = time[-1]
    z = solve_ivp(rate, (0.0, end), [0.0], t_eval=time, max_step=end / 2000, rtol=1e-9, atol=1e-12).y[0]
    return q, v, z, time


def hysteresis(exponent=1.0):
    return BoucWen(PLACES["position"], force=2.0, yield_displacement=1e-4, exponent=exponent)


def test_from_rest_the_hysteretic_force_follows_the_exponential():
    """With exponent 1 and steady motion dz/dq = (1 - z) / u_y, so z = 1 - exp(-q / u_y)."""
    q, v, z, time = cycled(hysteresis(), 5e-4, cycles=0.24)
    np.testing.assert_allclose(z, 1.0 - np.exp(-q / 1e-4), atol=1e-7)
    assert law_of(hysteresis()).force(0.0, q[-1], v[-1], z[-1], (2.0, 1e-4, 1.0)) == -2.0 * z[-1]
    assert time[0] == z[0] == 0.0


def test_small_motion_meets_a_spring_of_force_over_yield_displacement():
    q, _, z, _ = cycled(hysteresis(exponent=2.0), 1e-6)
    np.testing.assert_allclose(z, q / 1e-4, atol=1e-2 * 1e-2)  # |z|^2 = 1e-4 of z = 1e-2


@pytest.mark.parametrize("exponent", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("amplitude", [3e-5, 1e-4, 2e-3])
def test_the_hysteretic_force_is_bounded_and_a_cycle_takes_energy(exponent, amplitude):
    _, v, z, time = cycled(hysteresis(exponent), amplitude)
    assert np.abs(z).max() <= 1.0 + 1e-6  # the integrator's tolerance
    last = time >= time[-1] * 2.0 / 3.0
    lost = np.trapezoid(2.0 * z[last] * v[last], time[last])
    assert lost > 0.0


def test_far_beyond_yield_a_cycle_takes_the_energy_of_dry_friction():
    """4 F A less about 4 F u_y (2 ln 2 - ...), a share of order u_y / A."""
    _, v, z, time = cycled(hysteresis(), 1e-2)
    last = time >= time[-1] * 2.0 / 3.0
    lost = np.trapezoid(2.0 * z[last] * v[last], time[last])
    assert lost == pytest.approx(4.0 * 2.0 * 1e-2, rel=2.0 * 1e-4 / 1e-2)


def test_the_loop_does_not_depend_on_speed():
    _, _, slow, _ = cycled(hysteresis(2.0), 2e-4, frequency=1.0)
    _, _, fast, _ = cycled(hysteresis(2.0), 2e-4, frequency=50.0)
    np.testing.assert_allclose(slow, fast, atol=1e-6)
