"""The describing function: what a force law is to a sine, a spring and a dashpot that depend on the amplitude.

For q = A cos(w t) the law's force has a first harmonic; its share of -q is kappa = k_eq + i w c_eq, with
kappa = -(1 / (pi A)) integral of F exp(-i theta) over a cycle.
Source: M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), section 2.2.
"""

from math import ceil, cos, pi, sin, sqrt

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.compiled import compiled
from models.law import law_address
from models.law_call import call_law
from models.ports import PointLaw

POINTS = 128
"""Points of a cycle, a multiple of 4: reversals of the motion are points, and Simpson's rule holds between them."""

MOST_CYCLES = 64
"""Cycles until the internal state repeats."""

REPEATS = 1e-6
"""Change of the internal state over a cycle, which is of the order of 1, that counts as none."""

ROUND_OFF = 1e-12
"""Share of a force by which it may differ from the opposite one half a cycle later."""

LARGEST_MOVE, MOST_PARTS = 0.5, 128
"""Of the internal state within a step, from which steps are divided; a state so fast follows its limit."""


def describing_function(law: PointLaw, amplitude: FloatArray, omega: float) -> ComplexArray:
    """(n,) N/m, the complex stiffness of a law for sines of its port.

    Args:
        law: its time is that of the first cycle.
        amplitude: (n,) of the port's displacement, m, positive.
        omega: rad/s.
    """
    rate = 0 if law.rate is None else law_address(law.rate)
    values = np.array(law.parameters, float)
    out = np.empty(len(amplitude), complex)
    _describe(law_address(law.force), rate, values, np.ascontiguousarray(amplitude), omega, out)
    return out


@compiled
def _describe(
    force: int, rate: int, values: FloatArray, amplitude: FloatArray, omega: float, out: ComplexArray
) -> None:
    states = np.empty(POINTS)
    for k in range(len(amplitude)):
        is_done = False
        if rate != 0:
            is_done, out[k] = _over(POINTS // 2, force, rate, values, amplitude[k], omega, states)
        if not is_done:
            _, out[k] = _over(POINTS, force, rate, values, amplitude[k], omega, states)


@compiled
def _over(
    n: int, force: int, rate: int, values: FloatArray, a: float, omega: float, states: FloatArray
) -> tuple[bool, complex]:
    """The complex stiffness from n points; of half a cycle only where the other half is the same upside down.

    Returns:
        whether it is, and the stiffness.
    """
    turn, h, way = 2.0 * pi / POINTS, 2.0 * pi / POINTS / omega, 1.0 if n == POINTS else -1.0
    move = abs(call_law(rate, 0.0, 0.0, a * omega, 0.0, values, 0)) * h if rate != 0 else 0.0
    z, before, real, imaginary = 0.0, 0.0, 0.0, 0.0
    for cycle in range(MOST_CYCLES):
        began, real, imaginary = z, 0.0, 0.0
        for i in range(n):
            # From the middle upwards, as a virgin loop begins.
            theta = i * turn - 0.5 * pi
            c, s = cos(theta), sin(theta)
            states[i] = z
            push = call_law(force, i * h, a * c, -a * omega * s, z, values, 0)
            weight = 4.0 if i % 2 else 2.0
            real += weight * push * c
            imaginary -= weight * push * s
            if rate != 0:
                fastest = move * sqrt(max(abs(s), abs(sin(theta + turn))))
                parts = min(max(1, ceil(fastest / LARGEST_MOVE)), MOST_PARTS)
                z = _moved(rate, values, a, omega, c, s, turn, parts, z)
        moved = way * z - began
        is_last = rate == 0 or abs(moved) < REPEATS or cycle == MOST_CYCLES - 1
        if n < POINTS and (cycle == 0 or is_last) and not _is_odd(n, force, rate, values, a, omega, states):
            return False, 0j
        if is_last:
            break
        z = way * z
        if cycle % 2 and abs(moved) < abs(before):
            z = began + moved / (1.0 - moved / before)  # Aitken's limit of what creeps
        before = moved
    return True, -(POINTS / n) * (turn / (3.0 * pi * a)) * complex(real, imaginary)


@compiled
def _is_odd(n: int, force: int, rate: int, values: FloatArray, a: float, omega: float, states: FloatArray) -> bool:
    """Whether force and rate are the opposite ones half a cycle later, when all that they depend on is."""
    turn, h = 2.0 * pi / POINTS, 2.0 * pi / POINTS / omega
    for i in range(n):
        theta, z = i * turn - 0.5 * pi, states[i]
        q, v = a * cos(theta), -a * omega * sin(theta)
        for law in (force, rate):
            here = call_law(law, i * h, q, v, z, values, 0)
            there = call_law(law, (i + n) * h, -q, -v, -z, values, 0)
            if abs(there + here) > ROUND_OFF * abs(here):
                return False
    return True


@compiled
def _moved(
    rate: int, values: FloatArray, a: float, omega: float, c: float, s: float, turn: float, parts: int, z: float
) -> float:
    """The internal state a turn after an angle of cosine c and sine s, by so many steps of Runge and Kutta's method."""
    h, speed = turn / parts / omega, -a * omega
    c_half, s_half = cos(0.5 * turn / parts), sin(0.5 * turn / parts)
    for _ in range(parts):
        middle_c, middle_s = c * c_half - s * s_half, s * c_half + c * s_half
        end_c, end_s = middle_c * c_half - middle_s * s_half, middle_s * c_half + middle_c * s_half
        k1 = call_law(rate, 0.0, a * c, speed * s, z, values, 0)
        k2 = call_law(rate, 0.0, a * middle_c, speed * middle_s, z + 0.5 * h * k1, values, 0)
        k3 = call_law(rate, 0.0, a * middle_c, speed * middle_s, z + 0.5 * h * k2, values, 0)
        k4 = call_law(rate, 0.0, a * end_c, speed * end_s, z + h * k3, values, 0)
        z += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        c, s = end_c, end_s
    return z
