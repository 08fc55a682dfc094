"""Laws more general than the library's: each holds simple ones within it, and is the sum of its pieces."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numba import njit

from models.effects import EFFECTS, Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.protocol import Scene
from models.general_laws import (
    DIRECTED_SPEEDS,
    GENERAL_LAWS,
    SHARES,
    SPEEDS,
    DampingCurve,
    DirectedSpeedCurve,
    FrictionCurve,
    Lag,
    Memory,
    SpeedCurve,
    SpringCurve,
)
from models.law import law_address
from models.law_call import call_law

SCENE = Scene(
    Place(position=0.7), None, None, 2e-3, 0.1, 5.0, 0.0, 8.0, driven_base=False, rest=1e-3, natural_freqs=(9.0, 50.0)
)
MOTIONS = [(q, v) for q in np.linspace(-3e-3, 5e-3, 17) for v in np.linspace(-0.5, 0.5, 11)]


@njit
def called(address, motion, values):
    return call_law(address, *motion, values, 0)


def force(law, q, v, z=0.0):
    return law.law(0.0, q, v, z, law.numbers())


@pytest.mark.parametrize("kind", GENERAL_LAWS.values())
def test_it_is_compiled_as_it_is_written(kind):
    for law in kind.trials(SCENE):
        values = np.array(law.numbers())
        for q, v in MOTIONS:
            compiled = called(law_address(law.law), (0.0, q, v, 0.3), values)
            assert compiled == pytest.approx(force(law, q, v, 0.3), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("kind", [SpeedCurve, DirectedSpeedCurve, SpringCurve, DampingCurve, FrictionCurve])
def test_a_curve_is_the_sum_of_its_pieces(kind):
    pieces = list(kind.pieces(SCENE))
    for law in kind.trials(SCENE):
        for q, v in MOTIONS:
            parts = [value / SHARES[0] * force(each, q, v) for value, each in zip(law.values, pieces, strict=True)]
            assert sum(parts) == pytest.approx(force(law, q, v), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("law", "simple"),
    [
        (
            SpeedCurve.with_values(SCENE, [0.4 * speed for speed in SPEEDS]),
            lambda q, v: -0.4 * SCENE.force * v / SCENE.velocity if abs(v) < 0.3 else None,
        ),
        (
            DirectedSpeedCurve.with_values(
                SCENE, [0.4 * s for s in DIRECTED_SPEEDS] + [0.1 * s for s in DIRECTED_SPEEDS]
            ),
            lambda q, v: -(0.4 if v > 0.0 else 0.1) * SCENE.force * v / SCENE.velocity if abs(v) < 0.3 else None,
        ),
        (
            DirectedSpeedCurve.with_values(SCENE, [1.0] * 4 + [0.0] * 4),
            lambda q, v: (-SCENE.force if v > 0.0 else 0.0) if abs(v) > 0.03 * SCENE.velocity else None,
        ),
        (
            SpringCurve.with_values(SCENE, [0.02, 0.05, 0.1] * 2),
            lambda q, v: -0.1 * SCENE.force * (q - SCENE.rest) / SCENE.displacement,
        ),
        (DampingCurve.with_values(SCENE, [0.2] * 5), lambda q, v: -0.2 * SCENE.force * v / SCENE.velocity),
        (
            FrictionCurve.with_values(SCENE, [0.2] * 5),
            lambda q, v: CoulombFriction.force(0.0, q, v, 0.0, (0.2 * SCENE.force, 0.1 * SCENE.velocity)),
        ),
    ],
)
def test_it_holds_a_simple_law_within_it(law, simple):
    for q, v in MOTIONS:
        expected = simple(q, v)
        if expected is not None:
            assert force(law, q, v) == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_a_curve_stays_what_it_was_beyond_its_last_speed():
    law = SpeedCurve.with_values(SCENE, (0.1, 0.2, 0.3, 0.4, 0.5))
    assert force(law, 0.0, 1.0) == force(law, 0.0, 2.0) == pytest.approx(-0.5 * SCENE.force)
    directed = DirectedSpeedCurve.with_values(SCENE, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8))
    assert force(directed, 0.0, 1.0) == force(directed, 0.0, 2.0) == pytest.approx(-0.4 * SCENE.force)
    assert force(directed, 0.0, -1.0) == force(directed, 0.0, -2.0) == pytest.approx(0.8 * SCENE.force)


@pytest.mark.parametrize("turn", [1e-3, 1.0, 1e3])
def test_a_force_with_a_memory_is_a_dashpot_when_slow_and_a_spring_when_fast(turn):
    """Moved as exp(i w t), z is i w tau / (1 + i w tau) of that; ``turn`` is w tau."""
    memory = Memory(Place(position=0.7), stiffness=300.0, relaxation_time=0.02)
    omega = turn / memory.relaxation_time

    share = 1j * turn / (1.0 + 1j * turn)
    moving = memory.rate(0.0, 1.0, 0.0, share.real, memory.numbers())
    still = memory.rate(0.0, 0.0, omega, share.imag, memory.numbers())

    assert moving + 1j * still == pytest.approx(1j * omega * share, rel=1e-9)
    stiffness = -memory.law(0.0, 1.0, 0.0, share.real, memory.numbers())
    loss = -memory.law(0.0, 0.0, omega, share.imag, memory.numbers())
    if turn > 100.0:
        assert stiffness == pytest.approx(memory.stiffness, rel=1e-5)
    if turn < 0.01:
        assert loss == pytest.approx(memory.stiffness * memory.relaxation_time * omega, rel=1e-5)


def stiffness_of(law, omega):
    """(complex) stiffness of a law that is linear, moved as exp(i w t) about rest, N/m."""
    by_q, by_v = (law.rate(0.0, *motion, 0.0, law.numbers()) for motion in ((1.0, 0.0), (0.0, 1.0)))
    by_z = law.rate(0.0, 0.0, 0.0, 1.0, law.numbers())
    z = (by_q + 1j * omega * by_v) / (1j * omega - by_z)
    rest = getattr(law, "rest", 0.0)
    at_rest = force(law, rest, 0.0)
    parts = (force(law, rest + 1.0, 0.0), force(law, rest, 1.0), force(law, rest, 0.0, 1.0))
    by_q, by_v, by_z = (part - at_rest for part in parts)
    return -(by_q + 1j * omega * by_v + z * by_z)


@pytest.mark.parametrize("omega", [5.0, 50.0, 200.0])
def test_a_force_that_lags_holds_a_spring_that_answers_late(omega):
    """To second order in w T, by the Pade approximant of exp(-i w T)."""
    late = 5e-3
    law = Lag.with_values(SCENE, (0.2, 0.0, -0.4), late / 2.0)
    spring, turn = 0.2 * SCENE.force / SCENE.displacement, omega * late
    assert stiffness_of(law, omega) == pytest.approx(spring * (1.0 - 0.5j * turn) / (1.0 + 0.5j * turn), rel=1e-9)
    assert abs(stiffness_of(law, omega) / spring - np.exp(-1j * turn)) < turn**3 / 12.0 + 1e-9


@pytest.mark.parametrize("omega", [5.0, 50.0, 500.0])
def test_a_force_that_lags_holds_a_memory_and_is_the_sum_of_its_pieces(omega):
    spring, dashpot, *memories = Lag.pieces(SCENE)
    for memory in memories:
        time = memory.relaxation_time
        alone = Memory(SCENE.place, SHARES[0] * SCENE.force / SCENE.displacement, time)
        assert stiffness_of(memory, omega) == pytest.approx(stiffness_of(alone, omega), rel=1e-9)
        law = Lag.with_values(SCENE, (-0.03, 0.06, 0.09), time)
        parts = (-stiffness_of(spring, omega), 2.0 * stiffness_of(dashpot, omega), 3.0 * stiffness_of(memory, omega))
        assert stiffness_of(law, omega) == pytest.approx(sum(parts), rel=1e-9)


def test_none_of_them_is_a_kind_of_the_library():
    assert not set(GENERAL_LAWS) & set(EFFECTS)


def test_relaxation_times_lie_about_the_periods_of_the_modes():
    times = sorted({law.relaxation_time for law in Memory.pieces(SCENE)})
    assert times == sorted({law.relaxation_time for law in Lag.trials(SCENE)})
    assert times[0] == pytest.approx(1.0 / (3.0 * 2.0 * pi * 50.0))
    assert times[-1] == pytest.approx(3.0 / (2.0 * pi * 9.0))
    without = replace(SCENE, natural_freqs=())
    assert all(law.relaxation_time > 0.0 for law in Memory.trials(without))
