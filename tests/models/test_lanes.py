"""Vectors in compiled code against the same on arrays."""

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

from models.lanes import EIGHT, FOUR, LANES, at, chosen, digits, eight, four, four_of, lanes, put, total

ROW, ROWS = np.array([3.0, -1.0, 0.0, 2.0, -4.0, 0.5, 7.0, -2.0, 1.0]), np.arange(-15.0, 15.0).reshape(2, 15)


@njit(error_model="numpy")
def four_ways(row, rows, out):
    x, y = four(row, 1), four(rows, (1, 3))
    put(out, (0, 0), x + y)
    put(out, (1, 0), x - y)
    put(out, (2, 0), x * y)
    put(out, (3, 0), x / y)
    put(out, (4, 0), 2.0 - x)
    put(out, (5, 0), x * 3.0 + 1.0)
    put(out, (6, 0), 1.0 / y)


def test_vectors_are_reckoned_with_number_by_number():
    out, x, y = np.full((7, FOUR + 1), 99.0), ROW[1:5], ROWS[1, 3:7]
    four_ways(ROW, ROWS, out)
    np.testing.assert_allclose(out[:, :FOUR], [x + y, x - y, x * y, x / y, 2.0 - x, x * 3.0 + 1.0, 1.0 / y], rtol=1e-14)
    assert (out[:, FOUR] == 99.0).all()


@njit
def compared(row, rows, out):
    x, y = four(row, 1), four(rows, (0, 11))
    put(out, (0, 0), chosen((x < y) | (x >= 1.0) & (y <= -1.0), x, -9.0))
    put(out, (1, 0), chosen(x < 0.0, 5.0, y))
    return digits(x < y), digits(x <= 0.0), digits(x > y), digits(x >= 0.0)


def test_vectors_are_compared_number_by_number():
    out, x, y = np.empty((2, FOUR)), ROW[1:5], ROWS[0, 11:]
    found = compared(ROW, ROWS, out)
    masks = (x < y, x <= 0.0, x > y, x >= 0.0)
    assert found == tuple(int(np.sum(mask * [1, 2, 4, 8])) for mask in masks)
    assert len(set(found)) == 4
    np.testing.assert_array_equal(out[0], np.where((x < y) | ((x >= 1.0) & (y <= -1.0)), x, -9.0))
    np.testing.assert_array_equal(out[1], np.where(x < 0.0, 5.0, y))


@njit
def gathered(row, places, out):
    put(out, 0, four_of(row, places, 1))


@pytest.mark.parametrize("kind", [np.int64, np.uint64])
def test_numbers_are_gathered_from_their_places(kind):
    out = np.zeros(FOUR)
    gathered(ROW, np.array([5, 8, 0, 2, 2], kind), out)
    np.testing.assert_array_equal(out, ROW[[8, 0, 2, 2]])


@njit
def summed(row):
    wide, middle = lanes(row, 1), eight(row, 2)
    return total(wide), total(middle), at(middle, 0), at(middle, 7)


def test_wider_vectors_are_read_summed_and_taken_apart():
    row = np.random.default_rng(0).standard_normal(LANES + 3)
    found = summed(row)
    expected = (row[1 : 1 + LANES].sum(), row[2 : 2 + EIGHT].sum(), row[2], row[9])
    np.testing.assert_allclose(found, expected, rtol=1e-13)


@njit
def of_no_number(row):
    x = four(row, 0)
    return digits(x < 1.0), digits(x >= 1.0)


def test_what_is_no_number_compares_as_neither():
    assert of_no_number(np.array([np.nan, 0.0, 2.0, np.nan])) == (2, 4)


@pytest.mark.parametrize("row", [np.zeros(20)[::2], np.asfortranarray(np.zeros((4, 20))), np.zeros(20, np.float32)])
def test_numbers_that_do_not_lie_side_by_side_are_refused(row):
    with pytest.raises(TypingError, match="contiguous arrays of doubles"):
        of_no_number(row)


def test_places_that_are_no_integers_are_refused():
    with pytest.raises(TypingError, match="64-bit integers"):
        gathered(ROW, np.zeros(5, np.int32), np.zeros(FOUR))
