"""Springs that are not straight: one that is stiffer to one side, and stops beyond a gap."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.effects.end_stop import EndStop
from models.effects.protocol import Place
from models.effects.quadratic_stiffness import QuadraticStiffness
from models.structure import Structure

BLOCK = Structure(0.0, 0.0, 1200.0, 3.0, (0.2, 0.0), 0.0)
GAP = 1e-4


def force(effect, q):
    (law,) = effect.point_laws(None, BLOCK)
    return law.force(0.0, q, 0.3, 0.0, law.parameters)


def test_a_quadratic_spring_pulls_one_way_whatever_the_side():
    up, down = (QuadraticStiffness(Place(), 5.0, stiffer) for stiffer in ("up", "down"))
    assert force(up, 2e-3) == force(up, -2e-3) == pytest.approx(-5.0 * 4e-6)
    assert force(down, 2e-3) == pytest.approx(5.0 * 4e-6)
    # Upwards its force grows against the motion: stiffer up.
    assert force(up, 2e-3) < force(up, 1e-3) < 0.0


def test_its_side_is_named():
    assert QuadraticStiffness(Place(), 5.0, "down").label() == "quadratic_stiffness stiffer down"


def test_a_stop_is_not_there_within_its_gap_and_linear_beyond():
    stop = EndStop(Place(), 1e4, GAP)
    assert force(stop, 0.9 * GAP) == 0.0
    assert force(stop, 3.0 * GAP) == pytest.approx(-1e4 * 2.0 * GAP)
    assert force(stop, -3.0 * GAP) == pytest.approx(1e4 * 2.0 * GAP)


@given(st.floats(-1e-3, 1e-3))
def test_a_stop_never_pulls_and_takes_no_energy(q):
    stop = EndStop(Place(), 1e4, GAP)
    assert force(stop, q) * q <= 0.0
    assert force(stop, q) == -force(stop, -q)
    there = np.linspace(0.0, q, 50)
    there_and_back = np.concatenate([there, there[::-1]])
    assert np.trapezoid([force(stop, x) for x in there_and_back], there_and_back) == pytest.approx(0.0, abs=1e-15)
