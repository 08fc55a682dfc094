"""Backbone curves: where a phase-locked test settles as its force grows, one curve a mode.

At phase resonance the driven structure's motion stands at right angles to the force, which then does no more than make
up for the damping: the curve is that of the free motion as long as damping is small.

Source: S. Peter, R. I. Leine, Excitation power quantities in phase resonance testing of nonlinear systems with phase-
locked-loop excitation, Mechanical Systems and Signal Processing 96 (2017) 139.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from models.errors import InputError
from models.harmonic_balance.curve import PeriodicCurve
from models.harmonic_balance.equations import Equations
from models.harmonic_balance.follow import HARMONICS, Follower
from models.harmonic_balance.frf import ACCURACY, LEAST_SHARE, MOST_POINTS, SURVEYED, linear_motion
from models.harmonic_balance.problem import Motion, Problem, Quadrature, Span
from models.modal import build_modal
from models.plant import Plant
from models.point_forces import spring_and_dashpot
from models.ports import PointLaw, Port


def backbone(
    plant: Plant,
    sensor: str,
    amplitude: float,
    band: tuple[float, float],
    highest: float,
    *,
    accuracy: float = ACCURACY,
    judge_stability: bool = True,
    progress: Callable[[str], None] = lambda _: None,
) -> PeriodicCurve:
    """Follow one resonance from small motion up to an amplitude of the excitation.

    Args:
        plant: the rig with its effects, whose laws have neither memory nor clock.
        sensor: whose place is held at phase resonance; it must see the mode.
        amplitude: of the sine up to which the curve is followed, in the quantity of the rig's excitation.
        band: Hz, around one natural frequency; the curve ends where it leaves it.
        highest: frequency up to which modes follow the motion, Hz; what lies above yields statically.
        accuracy: share of the ports' motion that harmonics left out may have.
        judge_stability: whether each motion's stability at its fixed frequency is found.
        progress: told where the curve is.

    Raises:
        InputError: no resonance in the band, or what ``nonlinear_frf`` refuses.
        DivergenceError: no periodic motion was found where the curve begins.
    """
    named = {one.name: one for one in plant.sensors}
    port = Port(named[sensor].position, derivative=1 if named[sensor].quantity == "angular_velocity" else 0)
    # A law that says nothing, so that the sensor's own motion is among the unknowns.
    watch = PointLaw(port, spring_and_dashpot, (0.0, 0.0), owner=sensor)
    model = build_modal(replace(plant, laws=(*plant.laws, watch)), highest)
    equations = Equations.of(model, HARMONICS[0])
    low, high = (2.0 * np.pi * freq for freq in band)
    number, given = model.ports.index(port), equations.drive.input_at(low)
    given /= abs(given)

    omega = np.linspace(low, high, SURVEYED)
    motion = linear_motion(equations, omega)
    in_phase = (motion[:, number] * given.conjugate()).real
    crossings = np.flatnonzero(in_phase[1:] * in_phase[:-1] < 0.0)
    if len(crossings) == 0:
        raise InputError(
            f"a backbone between {band[0]:g} and {band[1]:g} Hz seen by {sensor}",
            "small motion passes through phase resonance there",
            "take a band around a natural frequency, and a sensor that sees the mode",
        )
    at = crossings[np.abs(motion[crossings, number]).argmax()]

    def phase(one: float) -> float:
        return float((linear_motion(equations, np.array([one]))[0, number] * given.conjugate()).real)

    start = float(brentq(phase, omega[at], omega[at + 1]))
    first = linear_motion(equations, np.array([start]))[0]
    span = Span(low, high, amplitude * float(np.abs(first).max()), amplitude)
    x = np.zeros((len(model.ports), HARMONICS[0] + 1), complex)
    x[:, 1] = 0.5 * LEAST_SHARE * amplitude * first
    problem = Problem(equations, span, quadrature=Quadrature(number, given))
    follower = Follower(problem, accuracy, judge_stability, MOST_POINTS)
    return follower.follow(Motion(x, start, LEAST_SHARE * amplitude), progress)
