"""One test of a cable: settle under gravity, then march, and keep every step."""

import contextlib
import io
from math import inf
from typing import Any

import exudyn as exu
import numpy as np
from scipy.integrate import cumulative_simpson

from models.arrays import FloatArray
from models.cable.port_law import PortLaw
from models.cable.rig_cable import OWN, RigCable, axial_stiffness, both_ways
from models.errors import DivergenceError, InputError
from models.fine.finite_elements import hermite
from models.simulators.recorded import Steps

LOAD_STEPS = 10
STATIC_TOLERANCE = 1e-8
NEWTON_TOLERANCE = 1e-4
"""Of Newton's iteration in time; Exudyn's own defaults lie below the round-off of its residual."""

SPECTRAL_RADIUS = 0.9
"""Of the generalised-alpha method at high frequencies."""

LEAST_STEP = 1e-9
"""s; smaller steps mean that the motion is lost."""


def settle(cable: RigCable) -> FloatArray:
    """Put the cable at rest; (n,) coordinates there.

    Raises:
        InputError: Exudyn finds no state at rest.
    """
    settings = _quiet(exu.SimulationSettings())
    static = settings.staticSolver
    static.numberOfLoadSteps, static.loadStepDuration, static.adaptiveStep = LOAD_STEPS, LEAST_STEP, True
    static.newton.relativeTolerance = static.newton.absoluteTolerance = STATIC_TOLERANCE
    cable.course.settling = True
    if not _told(lambda: cable.system.SolveStatic(settings, updateInitialValues=True, showHints=False)):
        raise InputError(
            "exudyn at rest: no equilibrium was found",
            "the beam rests where gravity, sleeves and effects balance",
            "look for a stiffness that is negative or an offset larger than the structure can reach",
        )
    return np.array(cable.system.systemData.GetODE2Coordinates())


def march(cable: RigCable, n_steps: int, step: float) -> tuple[FloatArray, FloatArray]:
    """(n_steps + 1, n) coordinates and velocities from rest, or from where it is held, at whole steps.

    Args:
        cable: settled.
        n_steps: whole steps.
        step: s; Exudyn may take smaller ones in between.

    Raises:
        DivergenceError: Exudyn gave up, or the motion left the finite numbers.
    """
    system, course = cable.system, cable.course
    n = len(cable.carried)
    q, v = np.full((n_steps + 1, n), np.nan), np.full((n_steps + 1, n), np.nan)
    q[0], v[0] = system.systemData.GetODE2Coordinates(), 0.0
    rows = np.array([cable.row(port.position or 0.0, port.derivative) for port in cable.ports]).reshape(-1, n)
    busy = [(law, row) for law, row in zip(cable.laws, rows, strict=True) if law.has_states]
    course.settling = False

    def keep(mbs: Any, t: float) -> bool:
        k = round(t / step)
        now, speed = mbs.systemData.GetODE2Coordinates(), mbs.systemData.GetODE2Coordinates_t()
        if abs(t - k * step) < 0.1 * step and k <= n_steps:
            q[k], v[k] = now, speed
        for law, row in busy:
            law.settle(t, float(row @ now), float(row @ speed))
        return True

    system.SetPostStepUserFunction(keep)
    settings = _quiet(exu.SimulationSettings())
    time = settings.timeIntegration
    time.numberOfSteps, time.endTime, time.minimumStepSize, time.adaptiveStep = n_steps, n_steps * step, LEAST_STEP, True
    time.newton.useModifiedNewton = True
    time.newton.relativeTolerance = time.newton.absoluteTolerance = NEWTON_TOLERANCE
    time.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    time.generalizedAlpha.computeInitialAccelerations = True
    settings.linearSolverType = exu.LinearSolverType.EigenSparse
    done = _told(lambda: system.SolveDynamic(settings, showHints=False))
    lost = np.flatnonzero(~np.isfinite(q).all(axis=1))
    if not done or len(lost):
        at = (lost[0] if len(lost) else n_steps) * step
        raise DivergenceError(
            f"exudyn: the motion was lost {at:.4f} s after the start with steps of {step:.3g} s; take more steps per "
            "sample (--steps), or look for a negative stiffness or damping among the effects"
        )
    return q, v


def accounted(cable: RigCable, q: FloatArray, v: FloatArray, rest: FloatArray, step: float) -> Steps:
    """What was read, the forces at the ports and where the energy went.

    Args:
        cable: that moved.
        q, v: (M, n) of ``march``.
        rest: (n,) coordinates at rest.
        step: s.
    """
    plant, course, time = cable.plant, cable.course, step * np.arange(len(q))
    sensors = [cable.row(s.position or 0.0, int(s.quantity == "angular_velocity")) for s in plant.sensors]
    rows = np.array([cable.row(port.position or 0.0, port.derivative) for port in cable.ports]).reshape(-1, len(rest))
    place, speed = q @ rows.T, v @ rows.T
    forces = _forces(cable, time, place, speed)
    taken = np.zeros(len(q) - 1)
    for force, port in zip(forces, cable.port_of, strict=True):
        taken -= 0.5 * (force[1:] + force[:-1]) * np.diff(place[:, port])
    power = np.array([-course.base(t) for t in time]) * (v @ cable.carried)
    if plant.excitation is not None and plant.excitation.position is not None:
        power += np.array([course.force(t) for t in time]) * (v @ cable.row(plant.excitation.position))
    lost = np.einsum("mi,mi->m", v @ cable.damping, v)
    return Steps(
        read=np.array(sensors).reshape(-1, len(rest)) @ (q - rest).T,
        motion=place.T,
        forces=forces,
        stored=_stored(cable, q, v),
        supplied=cumulative_simpson(power, dx=step, initial=0.0),
        damped=cumulative_simpson(lost, dx=step, initial=0.0),
        taken=np.concatenate([[0.0], np.cumsum(taken)]),
    )


def _forces(cable: RigCable, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
    """(n_forces, M) of each point force, N, felt again along the motion."""
    forces = np.empty((len(cable.forces), len(time)))
    for port in range(len(cable.ports)):
        members = [k for k, own in enumerate(cable.port_of) if own == port]
        law = PortLaw([cable.forces[k] for k in members])
        for k, (t, q, v) in enumerate(zip(time.tolist(), place[:, port].tolist(), speed[:, port].tolist(), strict=True)):
            forces[members, k] = law.each(t, q, v)
            law.settle(t, q, v)
    return forces


def _stored(cable: RigCable, q: FloatArray, v: FloatArray) -> FloatArray:
    """(M,) energy of motion, of stretching and bending, and of height, J."""
    structure, nodes = cable.plant.structure, cable.nodes
    energy = 0.5 * np.einsum("mi,mi->m", v @ cable.mass, v) + structure.gravity * (q @ cable.carried)
    places, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    axial = axial_stiffness(structure)
    for k, h in enumerate(np.diff(nodes)):
        own = q[:, OWN * k : OWN * (k + 2)]
        for s, weight in zip(0.5 * (places + 1.0), 0.5 * h * weights, strict=True):
            slope, bend = own @ both_ways(hermite(s, h, 1)).T + (1.0, 0.0), own @ both_ways(hermite(s, h, 2)).T
            square = np.sum(slope**2, axis=1)
            curvature = (slope[:, 0] * bend[:, 1] - slope[:, 1] * bend[:, 0]) / square
            energy += 0.5 * weight * axial * (np.sqrt(square) - 1.0) ** 2
            energy += 0.5 * weight * structure.bending_stiffness * curvature**2
    return np.asarray(energy + 0.5 * np.einsum("mi,mi->m", q @ cable.attached, q))


GAUSS_POINTS = 5
"""Along each element, for its strain energy."""


def natural_freqs(cable: RigCable, n: int) -> FloatArray:
    """(n,) of small undamped motion about where the cable stands, Hz, from Exudyn's own tangent."""
    held = [0, 1] if cable.plant.structure.clamp_stiffness < inf else [0, 1, 3]
    freqs, _ = cable.system.ComputeODE2Eigenvalues(
        constrainedCoordinates=held, ignoreAlgebraicEquations=True, convert2Frequencies=True, useSparseSolver=False
    )
    return np.asarray(np.sort(freqs)[:n])


def _quiet(settings: Any) -> Any:
    """Without files and without words."""
    settings.solutionSettings.writeSolutionToFile = False
    settings.timeIntegration.verboseMode = settings.staticSolver.verboseMode = 0
    return settings


def _told(solve: Any) -> bool:
    """Whether a solver of Exudyn came to its end; what it prints is dropped."""
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            return solve() is not False
        except (ValueError, RuntimeError):  # "SolveDynamic terminated", or a law that met no number
            return False
