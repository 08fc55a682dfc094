"""A force over one step: its impulse and first moment, the motion halfway, the edge of a gap, and a steady force."""

import numpy as np
import pytest

from models.contact_forces import crossing, halfway, internal_state, part_step, steady_force
from models.effects import EFFECTS
from models.law import law_address


@pytest.mark.parametrize(
    ("start", "end", "first", "middle", "last"),
    [(0, 1, 3, 4.5, 5), (0.3, 1, 2, 5, 7), (0, 0.6, 4, 3.5, 1), (0, 1, -2, 3, 6), (0.2, 1, 5, 4, -1), (0, 1, 2, 3, -8)],
)
def test_the_straight_line_of_a_part_has_its_impulse_and_its_first_moment(start, end, first, middle, last):
    a, b = part_step(float(start), float(end), float(first), float(middle), float(last))
    s = np.linspace(0.0, 1.0, 200001)
    x = (s - start) / (end - start)
    parabola = first * (1 - x) * (1 - 2 * x) + 4 * middle * x * (1 - x) + last * x * (2 * x - 1)
    force = np.where((x >= 0) & (x <= 1), np.maximum(0.0, parabola), 0.0)
    assert (a + b) / 2 == pytest.approx(np.trapezoid(force, s), abs=1e-4)  # the sum's own step
    assert a / 6 + b / 3 == pytest.approx(np.trapezoid(force * s, s), abs=1e-4)


def test_a_force_that_would_pull_throughout_is_none():
    assert part_step(0.2, 1.0, -1.0, -2.0, -3.0) == (0.0, 0.0)


def test_a_force_that_would_pull_halfway_only_runs_straight():
    assert part_step(0.0, 1.0, 1.0, -0.5, 3.0) == pytest.approx((1.0, 3.0))


def test_halfway_is_exact_for_a_cubic():
    h, place = 0.3, np.polynomial.Polynomial([1.0, -2.0, 5.0, 7.0])
    speed = place.deriv()
    assert halfway(h, place(0.0), speed(0.0), place(h), speed(h)) == pytest.approx((place(h / 2), speed(h / 2)))


@pytest.mark.parametrize("root", [0.05, 0.5, 0.93])
def test_the_crossing_is_that_of_the_cubic(root):
    """p = (s - root)(1 + s^2) has one crossing."""
    p0, p1 = -root, 2.0 * (1.0 - root)
    r0, r1 = 1.0, 2.0 + 2.0 * (1.0 - root)
    s, slope = crossing(p0, r0, p1, r1)
    assert s == pytest.approx(root, abs=1e-9)
    assert slope == pytest.approx(1.0 + root**2, rel=1e-8)


def test_the_internal_state_is_carried_by_the_trapezoidal_rule():
    address, values, h = law_address(relaxing), np.array([300.0]), 1e-3
    z = internal_state(address, values, 0, h, h, 0.0, 0.0, 0.8, 0.0, 0.0)
    assert z == pytest.approx(0.8 * (1.0 - 0.15) / (1.0 + 0.15), rel=1e-12)


def relaxing(t, q, v, z, p):
    return -p[0] * z


@pytest.mark.parametrize("slip_velocity", [1e-1, 1e-4, 1e-9])
def test_a_steady_force_is_what_the_motion_at_the_end_asks_for(slip_velocity):
    """A mass of 3 kg at 2 mm/s, held by friction within a step: m v / h where that is within its means."""
    address, h, mass = law_address(EFFECTS["coulomb_friction"].force), 1e-3, 3.0
    values = np.array([100.0, slip_velocity])
    force, slope = steady_force(address, values, 0, h, 0.0, 2e-3, 0.5 * h * h / mass, h / mass, 0.0, 1e-9)
    assert force == pytest.approx(-100.0 * np.tanh((2e-3 + force * h / mass) / slip_velocity), abs=1e-5)
    assert slope > 0.0
    if slip_velocity < 1e-8:
        assert force == pytest.approx(-mass * 2e-3 / h, rel=1e-4)


def test_a_law_that_asks_for_more_the_more_it_is_given_is_left_alone():
    address, h, mass = law_address(EFFECTS["coulomb_friction"].force), 1e-3, 3.0
    force, slope = steady_force(address, np.array([-100.0, 1e-4]), 0, h, 0.0, 0.0, 0.0, h / mass, 1e-12, 1e-9)
    assert np.isfinite(force)
    assert slope == -1.0
