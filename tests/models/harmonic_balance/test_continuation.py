"""Points of curves whose points are known, and how corrections fail."""

import numpy as np
import pytest

from models.harmonic_balance.continuation import STEPS, WANTED, Slopes, corrected, next_step


class Circle:
    """x^2 + y^2 = 1, folds at both ends."""

    def residual(self, u):
        return np.array([u @ u - 1.0])

    def slopes(self, u):
        return 2.0 * u[None, :]


class Corner:
    """y = 3 |x| + 0.01 x, whose slope jumps."""

    def residual(self, u):
        return np.array([u[1] - 3.0 * abs(u[0]) - 0.01 * u[0]])

    def slopes(self, u):
        return np.array([[-3.0 * np.sign(u[0]) - 0.01, 1.0]])


class Nothing:
    """x^2 + 1 = 0 for any y."""

    def residual(self, u):
        return np.array([u[0] ** 2 + 1.0])

    def slopes(self, u):
        return np.array([[2.0 * u[0], 0.0]])


@pytest.mark.parametrize("angle", [0.3, 0.5 * np.pi, 4.0])
def test_a_point_lies_on_the_curve_and_in_the_plane(angle):
    tangent = np.array([-np.sin(angle), np.cos(angle)])
    guess = 1.05 * np.array([np.cos(angle), np.sin(angle)]) + 0.02 * tangent
    point = corrected(Circle(), guess, tangent)
    assert point.u @ point.u == pytest.approx(1.0, abs=1e-9)
    assert (point.u - guess) @ tangent == pytest.approx(0.0, abs=1e-12)
    assert point.direction @ tangent == pytest.approx(1.0, abs=1e-2)
    assert 0.0 < point.contraction < 0.2


def test_behind_a_corner_slopes_are_found_again():
    guess, direction = np.array([0.05, -0.1]), np.array([1.0, 0.5]) / np.sqrt(1.25)
    point = corrected(Corner(), guess, direction, in_corner=True)
    assert Corner().residual(point.u)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("in_corner", [False, True])
def test_where_there_is_no_solution_none_is_found(in_corner):
    assert corrected(Nothing(), np.array([0.5, 0.0]), np.array([0.0, 1.0]), in_corner=in_corner) is None


def test_slopes_without_an_inverse_are_none():
    assert Slopes.of(np.array([[0.0, 1.0]]), np.array([0.0, 1.0])) is None


def test_steps_follow_the_contraction_and_at_most_double():
    assert next_step(0.01, WANTED) == pytest.approx(0.01)
    assert next_step(0.01, 0.0) == pytest.approx(0.02)
    assert next_step(0.01, 100.0) == pytest.approx(0.005)
    assert next_step(STEPS[2], 0.0) == STEPS[2]
