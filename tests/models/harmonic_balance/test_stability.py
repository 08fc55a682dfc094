"""Exponentials of blocks in closed form."""

import numpy as np
import pytest
from scipy.linalg import expm

from models.harmonic_balance.stability import _exponentials

BLOCKS = {
    "undamped": [[0.0, 3.0], [-3.0, 0.0]],
    "damped": [[0.0, 60.0], [-60.0, -2.0]],
    "critical": [[0.0, 1.0], [-4.0, -4.0]],
    "overdamped": [[0.0, 1.0], [-1.0, -50.0]],
    "free": [[0.0, 1.0], [0.0, 0.0]],
}


@pytest.mark.parametrize("name", BLOCKS)
def test_exponentials_are_those_of_the_matrices(name):
    block = 0.1 * np.array(BLOCKS[name])
    assert _exponentials(block[None])[0] == pytest.approx(expm(block), rel=1e-9, abs=1e-12)


def test_a_block_damped_beyond_measure_stays_finite():
    (power,) = _exponentials(2e-3 * np.array([[[0.0, 1.0], [-1e10, -1e6]]]))
    assert np.isfinite(power).all()
    slow = 0.5 * (-1e6 + np.sqrt(1e12 - 4e10)) * 2e-3
    assert np.abs(power).max() <= 2.0 * np.exp(slow) * 1e6
