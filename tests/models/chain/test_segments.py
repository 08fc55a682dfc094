import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models.chain.segments import CLAMP_HINGES, Segments

LENGTH = 1.3


def angles_and_heights(segments, w):
    """What the chain's segments show of a beam's deflection: theta = w' - h^2 w'''/24 and z = w + h^2 w''/24 there."""
    x, h = segments.centres, segments.h
    return w.deriv(1)(x) - h**2 / 24.0 * w.deriv(3)(x), w(x) + h**2 / 24.0 * w.deriv(2)(x)


def test_the_clamp_hinges_make_good_what_the_relations_ask_for():
    assert sum(CLAMP_HINGES) == pytest.approx(2.0 - 1.0 / 24.0, abs=1e-15)
    assert sum(p**2 for p in CLAMP_HINGES) == pytest.approx(2.5, abs=1e-15)


def test_segments_cover_the_beam_beyond_the_clamps_half():
    segments = Segments(LENGTH, 7)
    lengths = np.diff(segments.spans, axis=1)[:, 0]
    np.testing.assert_allclose(lengths[:-1], segments.h)
    assert lengths[-1] == pytest.approx(0.5 * segments.h)
    assert segments.spans[0, 0] == pytest.approx(0.5 * segments.h)
    assert segments.spans[-1, 1] == LENGTH


@pytest.mark.parametrize("derivative", [0, 1])
def test_a_cubic_is_read_exactly_amid_the_beam(derivative):
    segments = Segments(LENGTH, 9)
    w = Polynomial([0.0, 0.0, 1.3, -0.4])
    theta, z = angles_and_heights(segments, w)
    for position in np.linspace(1.6 * segments.h, LENGTH - 1.6 * segments.h, 40):
        heights, slopes = segments.reading(position, derivative)
        assert heights @ z + slopes @ theta == pytest.approx(w.deriv(derivative)(position), abs=1e-13)


@pytest.mark.parametrize("derivative", [0, 1])
def test_bending_that_varies_straight_is_read_exactly_at_the_clamp(derivative):
    """The first hinges turn by h w'' at their own places, and the readings there give the beam back."""
    segments = Segments(LENGTH, 9)
    w = Polynomial([0.0, 0.0, 0.5, -0.7])
    turns = segments.h * w.deriv(2)(segments.hinges)
    theta = np.cumsum(turns)
    for position in np.linspace(0.0, 1.49 * segments.h, 10):
        heights, slopes = segments.reading(position, derivative)
        assert not heights.any()
        assert slopes @ theta == pytest.approx(w.deriv(derivative)(position), abs=1e-14)


def test_the_clamp_itself_does_not_move():
    heights, slopes = Segments(LENGTH, 9).reading(0.0)
    assert not heights.any()
    assert not slopes.any()
