"""The describing function: what a force law is to a sine, a spring and a dashpot that depend on the amplitude.

For q = A cos(w t) the law's force has a first harmonic; its share of -q is kappa = k_eq + i w c_eq, with
kappa = -(1 / (pi A)) integral of F exp(-i theta) over a cycle.
Source: M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), section 2.2.
"""

from math import ceil, cos, pi, sin

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
    turn, h = 2.0 * pi / POINTS, 2.0 * pi / POINTS / omega
    for k in range(len(amplitude)):
        a = amplitude[k]
        z, parts, before = 0.0, 1, 0.0
        if rate != 0:
            move = abs(call_law(rate, 0.0, 0.0, a * omega, 0.0, values, 0)) * h
            parts = min(max(1, ceil(move / LARGEST_MOVE)), MOST_PARTS)
        for cycle in range(MOST_CYCLES):
            began, real, imaginary = z, 0.0, 0.0
            for i in range(POINTS):
                # From the middle upwards, as a virgin loop begins.
                theta = i * turn - 0.5 * pi
                push = call_law(force, i * h, a * cos(theta), -a * omega * sin(theta), z, values, 0)
                weight = 4.0 if i % 2 else 2.0
                real += weight * push * cos(theta)
                imaginary -= weight * push * sin(theta)
                for j in range(parts if rate != 0 else 0):
                    z = _moved(rate, values, a, omega, theta + j * turn / parts, turn / parts, z)
            moved = z - began
            if rate == 0 or abs(moved) < REPEATS:
                break
            if cycle % 2 and abs(moved) < abs(before):
                z = began + moved / (1.0 - moved / before)  # Aitken's limit of what creeps
            before = moved
        out[k] = -(turn / (3.0 * pi * a)) * complex(real, imaginary)


@compiled
def _moved(rate: int, values: FloatArray, a: float, omega: float, theta: float, turn: float, z: float) -> float:
    """The internal state a turn later, by the classical method of Runge and Kutta."""
    h, middle, end = turn / omega, theta + 0.5 * turn, theta + turn
    k1 = call_law(rate, 0.0, a * cos(theta), -a * omega * sin(theta), z, values, 0)
    q, v = a * cos(middle), -a * omega * sin(middle)
    k2 = call_law(rate, 0.0, q, v, z + 0.5 * h * k1, values, 0)
    k3 = call_law(rate, 0.0, q, v, z + 0.5 * h * k2, values, 0)
    k4 = call_law(rate, 0.0, a * cos(end), -a * omega * sin(end), z + h * k3, values, 0)
    moved: float = z + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    return moved
