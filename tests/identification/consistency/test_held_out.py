"""A record held out: what the others' numbers leave there, and how often that happens by chance."""

from types import SimpleNamespace

import numpy as np
import pytest

from identification.consistency.cells import Cell
from identification.consistency.held_out import held_out
from identification.consistency.own_values import Parts

N, P = 300, 4


def scene(shift, seed=0, own=False):
    """Three records of a linear model with four numbers; the last has numbers shifted by so much."""
    rng = np.random.default_rng(seed)
    rows = [rng.standard_normal((P, N)) / 10.0 for _ in range(3)]
    if own:  # the last number concerns the last record alone
        rows[0][-1] = rows[1][-1] = 0.0
    if own:
        rows[2][-1] += 3.0 * rows[2][0]
    residuals = [rng.standard_normal(N) for _ in rows]
    residuals[2] = residuals[2] - shift @ rows[2]
    joined, rest = np.concatenate(rows, axis=1), np.concatenate(residuals)
    step = -np.linalg.solve(joined @ joined.T, joined @ rest)
    data = [SimpleNamespace(rest=r + step @ j, plain=r + step @ j) for r, j in zip(residuals, rows, strict=True)]
    cells = [Cell(k, 0, j @ j.T, j @ d.rest) for k, (j, d) in enumerate(zip(rows, data, strict=True))]
    return data, Parts(tuple(cells), step, np.zeros(P), in_time=False), rows, residuals


def test_the_prediction_is_that_of_a_fit_without_the_record():
    data, parts, rows, residuals = scene(np.array([2.0, 0.0, -1.0, 0.0]))
    joined, rest = np.concatenate(rows[:2], axis=1), np.concatenate(residuals[:2])
    others = -np.linalg.solve(joined @ joined.T, joined @ rest)
    left = residuals[2] + others @ rows[2]

    held = held_out(data, parts, 2, np.zeros(P, dtype=bool))

    assert held.predicted == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-6)
    assert held.fitted == pytest.approx(np.sqrt(np.mean(data[2].rest ** 2)))
    assert held.chi2 > 8.0


def test_where_nothing_differs_the_chi_square_is_its_degrees_of_freedom_on_average():
    found = [held_out(*scene(np.zeros(P), seed=seed)[:2], 2, np.zeros(P, dtype=bool)) for seed in range(300)]

    # 300 values of variance 8: their mean is known to 0.16.
    assert {held.degrees for held in found} == {P}
    assert np.mean([held.chi2 for held in found]) == pytest.approx(P, abs=0.6)


def test_a_number_of_the_record_alone_is_fitted_to_it_and_speaks_for_nothing():
    shift = np.array([0.0, 0.0, 0.0, 30.0])
    data, parts, _, _ = scene(shift, own=True)

    held = held_out(data, parts, 2, np.array([False, False, False, True]))

    assert held.degrees == P - 1
    assert held.chi2 < 16.0  # of 3 degrees of freedom: one in a thousand is larger
    assert held.predicted < 1.2
