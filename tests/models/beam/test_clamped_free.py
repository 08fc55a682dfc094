"""The modes of the clamped-free beam against the published roots and the properties that define them."""

import numpy as np
import pytest

from models.beam.clamped_free import clamped_free_modes, wave_numbers

NODE, WEIGHT = np.polynomial.legendre.leggauss(400)
X, WEIGHT = 0.5 * (NODE + 1.0), 0.5 * WEIGHT  # exact for 40 modes: four points to the shortest wave and more
N = 40


def test_the_first_roots_are_those_of_the_tables():
    published = [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839]  # Blevins (1979), table 8-1
    np.testing.assert_allclose(wave_numbers(5), published, atol=5e-9)  # the digits printed


def test_every_root_solves_the_characteristic_equation():
    b = wave_numbers(60)
    np.testing.assert_allclose(np.cos(b), -1.0 / np.cosh(b), atol=1e-13)  # round-off of b itself
    assert np.all(np.diff(b) > 0.89 * np.pi)


def test_shapes_are_orthonormal():
    value = clamped_free_modes(X, N)
    np.testing.assert_allclose(value.T @ (WEIGHT[:, None] * value), np.eye(N), atol=1e-12)


def test_the_bending_energy_of_a_mode_is_the_fourth_power_of_its_wave_number():
    bent = clamped_free_modes(X, N, derivative=2)
    energy = bent.T @ (WEIGHT[:, None] * bent)
    fourth = wave_numbers(N) ** 4
    np.testing.assert_allclose(energy / np.sqrt(np.outer(fourth, fourth)), np.eye(N), atol=1e-12)


def test_the_clamp_holds_and_the_end_is_free():
    ends = np.array([0.0, 1.0])
    value, slope, bent = (clamped_free_modes(ends, N, derivative=d) for d in range(3))
    b = wave_numbers(N)
    assert np.abs(value[0]).max() < 1e-14
    assert np.abs(slope[0] / b).max() < 1e-14
    assert np.abs(bent[1] / b**2).max() < 1e-14
    np.testing.assert_allclose(np.abs(value[1]), 2.0, atol=1e-13)


@pytest.mark.parametrize("derivative", [1, 2])
def test_a_derivative_is_the_slope_of_the_one_below(derivative):
    x, h = np.linspace(0.05, 0.95, 7), 1e-5
    above, below = (clamped_free_modes(x + s, 6, derivative - 1) for s in (h, -h))
    exact = clamped_free_modes(x, 6, derivative)
    np.testing.assert_allclose((above - below) / (2 * h), exact, atol=1e-6 * np.abs(exact).max())  # b^2 h^2 / 6


def test_two_hundred_modes_stay_finite():
    value = clamped_free_modes(np.linspace(0.0, 1.0, 50), 200)
    assert np.isfinite(value).all()
    assert np.abs(value).max() < 2.1
