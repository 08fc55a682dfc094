"""The assumed shapes: orthonormal, and exact where a force acts."""

from itertools import pairwise

import numpy as np
import pytest

from models.beam.basis import beam_basis
from models.beam.clamped_free import wave_numbers

LOADS = (0.306, 0.68, 0.885)
SMALL_DIFFERENCE = (
    1e-8  # a static shape is what the modes leave of it, 1e-5 of the whole and so 1e5 times its round-off
)


def basis(n_modes=10, loads=LOADS, hinges=(), *, turns=False):
    return beam_basis(n_modes, loads, hinges, clamp_turns=turns)


def unit_load(x, a):
    """Deflection of a clamped beam of unit length and bending stiffness under a unit load at a."""
    near, far = np.minimum(x, a), np.maximum(x, a)
    return near**2 * (3.0 * far - near) / 6.0


def test_the_plain_beams_mass_is_the_identity_and_its_stiffness_diagonal():
    found = basis()
    n = len(found.resultant)
    root = np.sqrt(np.diag(found.stiffness))
    np.testing.assert_allclose(found.gram, np.eye(n), atol=SMALL_DIFFERENCE)
    np.testing.assert_allclose(found.stiffness / np.outer(root, root), np.eye(n), atol=SMALL_DIFFERENCE)
    np.testing.assert_allclose(np.diag(found.stiffness)[:10], wave_numbers(10) ** 4, rtol=1e-12)


@pytest.mark.parametrize("n_modes", [1, 4, 24])
@pytest.mark.parametrize("place", LOADS)
def test_the_deflection_under_a_load_is_exact_however_few_the_modes(n_modes, place):
    found = basis(n_modes)
    amplitudes = np.linalg.solve(found.stiffness, found.row(place))
    x = np.linspace(0.0, 1.0, 23)
    np.testing.assert_allclose(found.shapes(x) @ amplitudes, unit_load(x, place), atol=1e-11)
    bent = found.shapes(x, derivative=2) @ amplitudes
    np.testing.assert_allclose(bent, np.maximum(place - x, 0.0), atol=1e-9)


def test_the_deflection_under_its_own_weight_is_exact():
    found = basis(loads=())
    amplitudes = np.linalg.solve(found.stiffness, found.resultant)
    x = np.linspace(0.0, 1.0, 9)
    np.testing.assert_allclose(found.shapes(x) @ amplitudes, x**2 * (6.0 - 4.0 * x + x**2) / 24.0, atol=1e-12)


def test_without_static_shapes_a_load_is_carried_too_stiffly():
    modes_only = np.sum(basis().row(0.68)[:10] ** 2 / wave_numbers(10) ** 4)
    assert modes_only < 0.999999 * unit_load(0.68, 0.68)


def test_a_second_load_at_the_same_place_adds_no_shape():
    once, twice = basis(loads=(0.5,)), basis(loads=(0.5, 0.5 + 1e-9))
    assert len(twice.resultant) == len(once.resultant)


def test_the_slope_stiffness_is_that_of_the_slopes():
    found = basis()
    node, weight = np.polynomial.legendre.leggauss(100)
    total = np.zeros_like(found.slope_stiffness)
    for start, end in pairwise([0.0, *LOADS, 1.0]):
        slope = found.shapes(start + 0.5 * (end - start) * (node + 1.0), derivative=1)
        total += slope.T @ (0.5 * (end - start) * weight[:, None] * slope)
    np.testing.assert_allclose(found.slope_stiffness, total, atol=SMALL_DIFFERENCE * np.abs(total).max())


def test_a_turning_clamp_and_a_kink_cost_no_bending():
    found = basis(hinges=(0.4,), turns=True)
    turn, kink = found.turn(), found.kinks()[0]
    assert np.count_nonzero(turn) == np.count_nonzero(kink) == 1
    free = (turn != 0) | (kink != 0)
    assert np.abs(found.stiffness[free]).max() < 1e-12
    x = np.array([0.0, 0.2, 0.39, 0.41, 1.0])
    np.testing.assert_allclose(found.shapes(x)[:, turn != 0][:, 0], x, atol=1e-15)
    np.testing.assert_allclose(found.shapes(x)[:, kink != 0][:, 0], np.maximum(x - 0.4, 0.0), atol=1e-15)


def test_all_other_shapes_are_clamped_and_smooth():
    found = basis(hinges=(0.4,), turns=True)
    held = (found.turn() == 0) & (found.kinks()[0] == 0)
    slope = found.shapes(np.array([0.0, 0.4 - 1e-9, 0.4 + 1e-9]), derivative=1)[:, held]
    np.testing.assert_allclose(slope[0], 0.0, atol=1e-8)
    np.testing.assert_allclose(slope[1], slope[2], atol=1e-4)  # the largest curvature times the distance


def test_a_row_is_kept_and_cannot_be_spoilt():
    found = basis()
    assert found.row(0.3) is found.row(0.3)
    with pytest.raises(ValueError, match="read-only"):
        found.row(0.3)[0] = 1.0
