from dataclasses import replace
from math import atan2, exp, pi, sqrt

import numpy as np
import pytest
from numba import njit
from scipy.integrate import solve_ivp

from models.contact.kelvin_voigt import KelvinVoigt
from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.fine.gauss import ORDER, modal_steps
from models.fine.response import move
from models.fine.system import build_system
from models.law import law_address
from models.law_call import call_law
from models.plant import Plant
from models.ports import Contact, PointLaw, Port
from models.structure import Structure

MASS, STIFFNESS = 2.0, 800.0
OMEGA = sqrt(STIFFNESS / MASS)
OSCILLATOR = Structure(0.0, 0.0, STIFFNESS, MASS, (0.0, 0.0), 0.0)
BEAM = Structure(1.469, 0.02, 1649.3, 2.466, (0.0, 0.0), 9.81)
STILL = np.zeros((4, 0))


def run(structure, duration, h, *, laws=(), contacts=(), force=None, base=STILL, start=None, bend=np.inf):
    """Motion of the port or of the oscillator itself, without known force unless one is given as f(t), f'(t)."""
    plant = Plant(structure, tuple(contacts), tuple(laws), None, (), ())
    system = build_system(plant, 40)
    time = np.arange(round(duration / h) + 1) * h
    known = np.zeros((2, len(time))) if force is None else np.stack([f(time) for f in force])
    rows = np.zeros((2, 2 * len(system.omega)))
    rows[0, : len(system.omega)] = rows[1, len(system.omega) :] = system.row(None)
    motion = move(system, plant, known, base, h, rows, bend_tolerance=bend, start=start, trace=True)
    return time, motion, system


def cubic(t, q, v, z, p):
    return -p[0] * q**3


def test_a_law_is_called_through_its_address_with_its_own_numbers():
    @njit
    def call(address, values, offset):
        return call_law(address, 0.0, 2.0, 0.0, 0.0, values, offset)

    assert call(law_address(cubic), np.array([9.0, 5.0, 7.0]), 1) == -40.0


def test_free_linear_motion_keeps_its_energy_and_its_phase():
    h, n = 0.2 / OMEGA, 2000
    (step,), _ = (np.moveaxis(table, -1, 0) for table in modal_steps(np.array([OMEGA]), np.zeros(1), h))
    state = np.array([1.0, 0.0])
    for _ in range(n):
        state = step[:, :2] @ state
    energy = (OMEGA * state[0]) ** 2 + state[1] ** 2
    assert energy == pytest.approx(OMEGA**2, rel=1e-11)
    phase = np.angle((state[0] - 1j * state[1] / OMEGA) * np.exp(-1j * 0.2 * n))
    assert abs(phase) == pytest.approx(n * 0.2**5 / 720.0, rel=0.01)  # the first term that the method leaves out


def test_the_observed_order_is_the_declared_one():
    law = PointLaw(Port(None), cubic, (3e5,))
    start = np.array([0.1 * sqrt(MASS), 0.0])
    ends = []
    for h in (4e-3, 2e-3, 2.5e-4):
        _, motion, _ = run(OSCILLATOR, 0.6, h, laws=[law], start=start)
        ends.append(motion.out[:, -1])
    coarse, fine = (np.linalg.norm(end - ends[2]) for end in ends[:2])
    assert np.log2(coarse / fine) == pytest.approx(ORDER, abs=0.15)


def test_a_hysteretic_spring_and_dry_friction_against_the_ground_agree_with_another_integrator():
    bouc_wen = PointLaw(Port(None), BoucWen.restoring_force, (20.0, 5e-4, 1.5), BoucWen.rate)
    friction = PointLaw(Port(None, 0, "ground"), CoulombFriction.force, (3.0, 5e-3))
    h, duration, freq = 2.5e-4, 1.5, 2 * pi * 3.0
    time = np.arange(round(duration / h) + 1) * h
    base = 0.01 * np.stack(
        [
            1 - np.cos(freq * time),
            freq * np.sin(freq * time),
            freq**2 * np.cos(freq * time),
            -(freq**3) * np.sin(freq * time),
        ]
    )
    structure = replace(OSCILLATOR, rayleigh=(1.5, 0.0))
    _, motion, _ = run(structure, duration, h, laws=[bouc_wen, friction], base=base, bend=1e-3)

    def slope(t, y):
        q, v, z = y
        ground = v + 0.01 * freq * np.sin(freq * t)
        force = bouc_wen.force(t, q, v, z, bouc_wen.parameters) + friction.force(t, q, ground, 0.0, friction.parameters)
        acceleration = (force - STIFFNESS * q) / MASS - 1.5 * v - 0.01 * freq**2 * np.cos(freq * t)
        return [v, acceleration, bouc_wen.rate(t, q, v, z, bouc_wen.parameters)]

    exact = solve_ivp(slope, (0, duration), [0, 0, 0], "LSODA", time, rtol=1e-10, atol=1e-13, max_step=1e-3).y
    for mine, other in zip(motion.out, exact[:2], strict=True):
        # Kinks of the hysteresis at each reversal cost the order there: (v / u_y h)^2 of a step.
        assert np.abs(mine - other).max() < 2e-5 * np.abs(other).max()


@pytest.mark.parametrize("damping", [0.0, 40.0])
def test_a_mass_bounces_off_a_wall_with_the_restitution_of_the_closed_form(damping):
    stiffness, clearance, speed = 1e5, 1e-3, 0.3
    wall = Contact("wall", 0.0, KelvinVoigt(stiffness, damping), clearance)
    free = replace(OSCILLATOR, bending_stiffness=0.0)
    _, motion, _ = run(free, 0.02, 1.0 / 32768, contacts=[wall], start=np.array([0.0, speed * sqrt(MASS)]))
    delta, omega = damping / (2 * MASS), sqrt(stiffness / MASS - (damping / (2 * MASS)) ** 2)
    # p = v / omega exp(-delta t) sin(omega t); the wall lets go where p'' = 0.
    release = atan2(2 * delta * omega, delta**2 - omega**2) / omega
    back = speed * exp(-delta * release) * (np.cos(omega * release) - delta / omega * np.sin(omega * release))
    # An event is placed to h / 256 = 0.12 us, the dashpot's jump is 12 N: 1.4e-6 N s of 1.2 N s.
    assert motion.out[1, -1] == pytest.approx(back, rel=3e-6)
    assert motion.q[0].max() > clearance
    assert motion.force.max() == 0.0  # never pulls


def test_a_bilateral_support_pulls_and_pushes():
    support = Contact("support", 0.0, KelvinVoigt(5e3, 0.0), 0.0)
    start = np.array([0.01 * sqrt(MASS), 0.0])
    time, motion, _ = run(OSCILLATOR, 0.5, 1e-3, contacts=[support], start=start)
    omega = sqrt((STIFFNESS + 5e3) / MASS)
    np.testing.assert_allclose(motion.out[0], 0.01 * np.cos(omega * time), atol=1e-6)  # (omega h)^5 / 720 a step


def test_a_growing_clearance_is_met_later():
    wall = Contact("wall", 0.0, KelvinVoigt(1e5, 0.0), 1e-3, 0.0, 0.1)
    free = replace(OSCILLATOR, bending_stiffness=0.0)
    time, motion, _ = run(free, 0.02, 1e-5, contacts=[wall], start=np.array([0.0, 0.3 * sqrt(MASS)]))
    assert time[np.argmax(motion.force[0] < 0.0)] == pytest.approx(1e-3 / (0.3 - 0.1), abs=2e-5)


def test_a_beam_that_rattles_in_lossless_sleeves_keeps_its_energy():
    stiffness, clearance = 1e5, 1.5e-4
    contacts = [Contact(str(x), x, KelvinVoigt(stiffness, 0.0), clearance) for x in (0.45, 1.0)]
    plant = Plant(BEAM, tuple(contacts), (), None, (), ())
    n = len(build_system(plant, 40).omega)
    start = np.zeros(2 * n)
    start[n : n + 3] = 0.05, -0.08, 0.06
    _, motion, system = run(BEAM, 0.5, 1.0 / 32768, contacts=contacts, start=start)

    def energy(state, q):
        place, rate = state[:n] + system.rest, state[n:]
        stored = sum(0.5 * stiffness * max(0.0, abs(x) - clearance) ** 2 for x in q)
        return 0.5 * rate @ rate + 0.5 * np.sum((system.omega * place) ** 2) + 9.81 * system.carried @ place + stored

    before, after = energy(start, motion.q[:, 0]), energy(motion.state, motion.q[:, -1])
    at_rest = energy(np.zeros(2 * n), system.port_rows @ system.rest)
    impacts = np.count_nonzero(np.diff((motion.force != 0.0).astype(int), axis=1))
    assert impacts > 50
    assert after - at_rest == pytest.approx(before - at_rest, rel=1e-5)  # about 1e-7 an impact


def test_what_is_taken_out_of_a_damped_beam_is_what_the_force_put_in():
    structure = replace(BEAM, rayleigh=(2.0, 6e-6)).with_dashpot(0.8, 30.0)
    h = 1.0 / 32768
    freq = 2 * pi * 40.0
    plant = Plant(structure, (), (), None, (), ())
    system = build_system(plant, 40)
    n = len(system.omega)
    time = np.arange(round(0.3 / h) + 1) * h
    known = np.stack([np.sin(freq * time) ** 2, freq * np.sin(2 * freq * time)])
    rows = np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), np.hstack([np.zeros(n), system.row(0.8)])])
    motion = move(system, plant, known, STILL, h, rows)
    rates = motion.out[:n]
    put_in = np.trapezoid(known[0] * (system.row(None) @ rates), dx=h)
    taken = np.trapezoid((system.damping[:, None] * rates**2).sum(axis=0) + 30.0 * motion.out[n] ** 2, dx=h)
    kept = 0.5 * motion.state[n:] @ motion.state[n:] + 0.5 * np.sum((system.omega * motion.state[:n]) ** 2)
    assert put_in == pytest.approx(taken + kept, rel=1e-5)
