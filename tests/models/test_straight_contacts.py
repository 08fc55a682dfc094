"""Contacts that are straight in the motion weigh what any contact does, and are met by one step of Newton's."""

import numpy as np
import pytest
from numba import njit

from models.contact.kelvin_voigt import KelvinVoigt
from models.contact_forces import contact_step
from models.lanes import FOUR
from models.law import law_address
from models.straight_contacts import Straight, Weighed, inverses_of, straight_step


@njit
def both_steps(law, values, contact, t, h, p0, r0, side0, n0, q, v):
    ordinary = contact_step(law, values, 0, contact, 0, t, h, p0, r0, side0, n0, q, v)
    contacts = Straight(values[0], values[1], contact[0, 0], contact[0, 1], contact[0, 2], False, True)
    return ordinary, straight_step(contacts, t, h, Weighed(p0, r0, side0, n0), q, v)


@pytest.mark.parametrize("bilateral", [False, True])
def test_a_straight_contact_that_stays_closed_is_weighed_as_any_other(bilateral):
    rng, law, h, n_closed = np.random.default_rng(0), law_address(KelvinVoigt.normal_force), 1e-4, 0
    for _ in range(5000):
        values = np.array([10.0 ** rng.uniform(3.0, 6.0), 10.0 ** rng.uniform(0.0, 3.0)])
        clearance, growth = (0.0, 0.0) if bilateral else (1e-4 * rng.random(), 1e-2 * rng.random())
        contact = np.array([[clearance, 2e-4 * rng.uniform(-1.0, 1.0), growth, float(bilateral)]])
        t, side, p0, r0 = rng.random(), rng.choice([-1.0, 1.0]), 1e-4 * rng.random(), 0.3 * rng.standard_normal()
        n0 = values @ np.array([p0, r0])
        if n0 < 0.0 and not bilateral:
            continue
        reached = clearance + growth * (t - h) + p0 + h * r0 + 2e-5 * rng.standard_normal()
        q, v = contact[0, 1] + side * reached, side * (r0 + 0.3 * rng.standard_normal())
        ordinary, (*weights, p1, middle, last) = both_steps(law, values, contact, t, h, p0, r0, side, n0, q, v)
        if bilateral or (p1 > 0.0 and min(middle, last) >= 0.0):
            n_closed += 1
            size = abs(n0) + np.abs(ordinary).sum()
            assert np.abs(np.subtract(weights, ordinary)).max() < 1e-12 * size
    assert 500 < n_closed < (5001 if bilateral else 4000)


@njit
def asked_of_two(straight, contact, port, t, h, starts, q, v):
    weights = np.empty((2, 2))
    for j in range(2):
        contacts = Straight(straight[j, 1], straight[j, 2], contact[j, 0], contact[j, 1], contact[j, 2], False, True)
        start = Weighed(starts[j, 0], starts[j, 1], starts[j, 2], starts[j, 3])
        weights[0, j], weights[1, j], _, _, _ = straight_step(contacts, t, h, start, q[port[j]], v[port[j]])
    return weights


def test_the_weights_of_straight_contacts_are_met_in_one_step():
    h, rng = 1e-4, np.random.default_rng(1)
    straight, port = np.array([[1.0, 3e4, 15.0], [1.0, 2e5, 60.0]]), np.array([1, 0])
    contact = np.array([[1e-4, 0.0, 0.0, 0.0], [2e-4, 1e-5, 1e-3, 0.0]])
    starts = np.array([[2e-5, 0.05, 1.0, 7.0], [1e-5, 0.02, -1.0, 4.0]])
    q_start, q_end, v_start, v_end = (scale * rng.random((2, 2)) for scale in (1e-8, 1e-8, 1e-4, 1e-4))
    inverses = inverses_of(straight, port, h, q_start, q_end, v_start, v_end)

    def asked(weights):
        q, v = np.array([2e-4, 3e-4]), np.array([0.1, -0.2])
        for (a, b), i in zip(weights.T, port, strict=True):
            q, v = q + q_start[i] * a + q_end[i] * b, v + v_start[i] * a + v_end[i] * b
        return asked_of_two(straight, contact, port, 0.3, h, starts, q, v)

    for closed, own in ((1, [0]), (2, [1]), (3, [0, 1])):
        guess = np.array([[1.0, 5.0], [-2.0, 3.0]])
        fault = np.zeros((2, FOUR))
        fault[:, own] = (asked(guess) - guess)[:, own]
        found = guess + (fault.ravel() @ inverses[closed]).reshape(2, FOUR)[:, :2]
        assert np.abs(fault).max() > 1.0
        assert found[:, own] == pytest.approx(asked(found)[:, own], rel=1e-12)
        assert np.array_equal(np.delete(found, own, axis=1), np.delete(guess, own, axis=1))
