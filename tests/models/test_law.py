"""A law compiled and called through its address is the Python function."""

from math import sin

import numpy as np
import pytest
from numba import njit

from models.law import law_address
from models.law_call import call_law


def spring_and_more(t, q, v, z, p):
    return -p[0] * q - p[1] * v + z * sin(p[2] * t)


def growing(t, q, v, z, p):
    if q > p[0]:
        return (q - p[0]) ** 1.5
    return 0.0


@njit
def called(address, motion, values, offset):
    return call_law(address, *motion, values, offset)


@pytest.mark.parametrize("offset", [0, 2])
def test_the_compiled_law_is_the_python_function(offset):
    values = np.array([9.0, 8.0, 1e4, 30.0, 2.0, 7.0])
    motion = (0.7, 1e-3, -0.2, 0.4)
    expected = spring_and_more(*motion, values[offset:])
    assert called(law_address(spring_and_more), motion, values, offset) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("q", [0.5, 2.0])
def test_a_law_may_branch(q):
    values = np.array([1.0])
    expected = growing(0.0, q, 0.0, 0.0, values)
    assert called(law_address(growing), (0.0, q, 0.0, 0.0), values, 0) == pytest.approx(expected, rel=1e-14)


def test_a_law_is_compiled_once():
    assert law_address(growing) == law_address(growing)
    assert law_address(growing) != law_address(spring_and_more)
