"""A number with a value of its own in parts of the data, against what can be said in closed form."""

import numpy as np
import pytest

from identification.consistency.cells import Cell
from identification.consistency.own_values import Parts, inverse


def cells(values, slopes, prior=(0.0, 0.0), noise=1.0, seed=0):
    """Parts whose data are a slope times the part's value of number 0, and another number that all have in common."""
    rng = np.random.default_rng(seed)
    rows = []
    for k, (value, slope) in enumerate(zip(values, slopes, strict=True)):
        j = np.stack([slope * rng.standard_normal(200), rng.standard_normal(200)])
        residual = -j[0] * value - 0.7 * j[1] + noise * rng.standard_normal(200)
        rows.append(Cell(k, 0, j @ j.T, j @ residual))
    return Parts(tuple(rows), np.zeros(2), np.array(prior), in_time=False)


def test_values_of_their_own_are_recovered_beside_a_number_in_common():
    parts = cells([1.0, -2.0, 0.5], [1.0, 1.0, 1.0], noise=0.0)

    own = parts.own_values(0, (0, 1, 2), (0, 1, 2), {})

    np.testing.assert_allclose(own.x, [1.0, -2.0, 0.5], rtol=1e-6)
    assert own.groups == (0, 1, 2)


def test_the_chi_square_is_what_one_common_value_costs():
    parts = cells([0.0, 0.3], [1.0, 0.5])
    own = parts.own_values(0, (0, 1), (0, 1), {})

    def least(split):
        """Cost of the best numbers: half of g' N^-1 g less, whether number 0 has one value or two."""
        a, b = parts.cells
        if not split:
            normal, slope = a.information + b.information, a.score + b.score
        else:
            normal = np.array(
                [
                    [a.information[0, 0], 0.0, a.information[0, 1]],
                    [0.0, b.information[0, 0], b.information[0, 1]],
                    [a.information[0, 1], b.information[0, 1], a.information[1, 1] + b.information[1, 1]],
                ]
            )
            slope = np.array([a.score[0], b.score[0], a.score[1] + b.score[1]])
        return -slope @ np.linalg.solve(normal, slope)

    assert own.chi2 == pytest.approx(least(split=False) - least(split=True), rel=1e-4)
    assert own.sigma == pytest.approx(np.sqrt(own.chi2), rel=1e-6)


def test_without_a_difference_the_chi_square_is_its_degrees_of_freedom_on_average():
    drawn = [cells([0.4, 0.4, 0.4], [1.0, 0.3, 2.0], seed=seed) for seed in range(300)]
    found = [parts.own_values(0, (0, 1, 2), (0, 1, 2), {}) for parts in drawn]

    # 300 values of variance 4: their mean is known to 0.12.
    assert np.mean([own.chi2 for own in found]) == pytest.approx(2.0, abs=0.4)


def test_what_is_known_beforehand_of_the_number_does_not_draw_its_values_together():
    with_prior, without = (cells([3.0, -3.0], [0.1, 0.1], prior=(known, 0.0)) for known in (1.0, 0.0))

    rows = [parts.own_values(0, (0, 1), (0, 1), {}) for parts in (with_prior, without)]

    np.testing.assert_allclose(rows[0].x, rows[1].x)


def test_a_part_that_does_not_tell_the_number_is_left_out():
    own = cells([1.0, 5.0, 1.0], [1.0, 1e-3, 1.0]).own_values(0, (0, 1, 2), (0, 1, 2), {})

    assert own.groups == (0, 2)
    assert own.sigma < 3.0


def test_beside_a_number_that_drifts_another_one_that_imitates_it_does_not():
    rng = np.random.default_rng(1)
    rows = []
    for k, value in enumerate((0.0, 1.0)):
        first = rng.standard_normal(400)
        j = np.stack([first, first + 0.5 * rng.standard_normal(400)])
        rows.append(Cell(k, 0, j @ j.T, j @ (-j[0] * value + 0.1 * rng.standard_normal(400))))
    parts = Parts(tuple(rows), np.zeros(2), np.zeros(2), in_time=False)

    alone = parts.own_values(1, (0, 1), (0, 1), {})
    beside = parts.own_values(1, (0, 1), (0, 1), {0: (0, 1)})

    assert alone.sigma > 5.0
    assert beside.sigma < 3.0


def test_the_inverse_holds_for_units_of_very_different_sizes():
    matrix = np.array([[1e16, 3e8], [3e8, 10.0]])

    np.testing.assert_allclose(inverse(matrix) @ matrix, np.eye(2), atol=1e-7)
