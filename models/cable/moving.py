"""A cable at rest and in motion: Exudyn's static and implicit solvers, without files, without words."""

import contextlib
import io
from math import inf
from typing import Any, NamedTuple

import exudyn as exu
import numpy as np
from scipy.interpolate import CubicHermiteSpline

from models.arrays import FloatArray
from models.cable.matrices import axial_stiffness
from models.cable.rig_cable import RigCable
from models.errors import DivergenceError, InputError

STATIC_STEPS = 2
"""Solutions one after the other, each from where the one before ended; the last one polishes."""

STATIC_TOLERANCE = 1e-6
"""Of the first residual."""

ROUND_OFF = 10.0 * float(np.finfo(float).eps)
"""Of the longest coordinate times an element's axial stiffness: a residual below it, in N, says nothing.

The residual of bending, which decides where the beam lies, is a million times smaller there.
"""

NEWTON_TOLERANCE = 1e-4
"""Of Newton's iteration in time; Exudyn's own defaults lie below the round-off of its residual."""

SPECTRAL_RADIUS = 0.9
"""Of the generalised-alpha method at high frequencies."""

LEAST_STEP = 1e-9
"""s; smaller steps mean that the motion is lost."""

FAR = 10.0
"""Lengths of the beam; a motion that goes farther is lost."""

ON_TIME = 1e-3
"""Share of a step within which a time is that of a whole step; Exudyn takes smaller ones where Newton needs them."""


class March(NamedTuple):
    """Coordinates, velocities and forces at whole steps.

    Attributes:
        q, v: (M, n).
        forces: (M, n_forces) on the structure, N, as Exudyn felt them; then those of round contacts across the plane.
    """

    q: FloatArray
    v: FloatArray
    forces: FloatArray


def settle(cable: RigCable) -> FloatArray:
    """Put the cable at rest; (n,) coordinates there.

    Raises:
        InputError: Exudyn finds no state at rest.
    """
    settings = _quiet(exu.SimulationSettings())
    static = settings.staticSolver
    static.numberOfLoadSteps, static.loadStepDuration = 1, LEAST_STEP  # time stands still
    structure, shortest = cable.plant.structure, float(np.diff(cable.nodes).min())
    static.newton.relativeTolerance = STATIC_TOLERANCE
    static.newton.absoluteTolerance = ROUND_OFF * axial_stiffness(structure) * structure.length / shortest
    cable.course.settling = True
    for _ in range(STATIC_STEPS):
        if not solved(lambda: cable.system.SolveStatic(settings, updateInitialValues=True, showHints=False)):
            raise InputError(
                "exudyn at rest: no equilibrium was found",
                "the beam rests where gravity, sleeves and effects balance",
                "look for a stiffness that is negative or an offset larger than the structure can reach",
            )
    return np.array(cable.system.systemData.GetODE2Coordinates())


def march(cable: RigCable, n_steps: int, step: float) -> March:
    """The motion from rest, or from where the cable is held, at ``n_steps + 1`` whole steps.

    Args:
        cable: settled.
        n_steps: whole steps.
        step: s; Exudyn may take smaller ones in between.

    Raises:
        DivergenceError: Exudyn gave up, or the motion left the finite numbers.
    """
    system, data = cable.system, cable.system.systemData
    cable.course.settling = False
    times, places, speeds = [0.0], [_begun(cable)], [np.zeros(len(cable.carried))]
    rows = [law.felt for law in cable.laws] + [law.felt for law in cable.rounds]
    felt = [force for row in rows for force in row]
    busy = [law for law in cable.laws if law.has_states]

    def keep(mbs: Any, t: float) -> bool:  # noqa: ARG001
        for law in busy:
            law.settle()
        if t > 0.0:  # in lists without lists in them, which Python's garbage collector leaves alone
            times.append(t)
            places.append(data.GetODE2Coordinates())
            speeds.append(data.GetODE2Coordinates_t())
            for row in rows:
                felt.extend(row)
        return True

    system.SetPostStepUserFunction(keep)
    done = solved(lambda: system.SolveDynamic(in_time(n_steps, step), showHints=False))
    q, v, time = np.array(places), np.array(speeds), np.array(times)
    if not (done and np.abs(q).max() < FAR * cable.plant.structure.length):  # nor is a nan less than that
        raise DivergenceError(
            f"exudyn: the motion was lost {times[-1]:.4f} s after the start with steps of {step:.3g} s; take more "
            "steps per sample (--steps), or look for a negative stiffness or damping among the effects"
        )
    forces = np.empty((len(time), len(cable.columns)))
    forces[:, cable.columns] = np.reshape(felt, forces.shape)
    whole = step * np.arange(n_steps + 1)
    if len(time) == len(whole) and np.abs(time - whole).max() < ON_TIME * step:
        return March(q, v, forces)
    between = CubicHermiteSpline(time, q, v)
    return March(between(whole), between(whole, 1), np.array([np.interp(whole, time, way) for way in forces.T]).T)


def _begun(cable: RigCable) -> FloatArray:
    """(n,) coordinates at the first step, with laws that begin at rest and are asked there."""
    q = np.array(cable.system.systemData.GetODE2Coordinates())
    places = dict(zip(cable.ports, (cable.port_rows @ q).tolist(), strict=True))
    for port, law in zip(cable.ports, cable.laws, strict=True):
        law.begin()
        law(0.0, places[port], 0.0)
    for around in cable.rounds:
        up, across = around.ports
        around(0.0, (places[up], places[across]), (0.0, 0.0))
    return q


def natural_freqs(cable: RigCable, n: int) -> FloatArray:
    """(n,) of small undamped motion about where the cable stands, Hz, from Exudyn's own tangent."""
    held = list(cable.layout.fixed)
    if cable.plant.structure.clamp_stiffness == inf:
        held += cable.layout.turning
    freqs, _ = cable.system.ComputeODE2Eigenvalues(
        constrainedCoordinates=held, ignoreAlgebraicEquations=True, convert2Frequencies=True, useSparseSolver=False
    )
    return np.asarray(np.sort(freqs)[:n])


def in_time(n_steps: int, step: float) -> Any:
    """Settings for so many steps of so many seconds.

    Args:
        n_steps: whole steps.
        step: s.
    """
    settings = _quiet(exu.SimulationSettings())
    time = settings.timeIntegration
    time.numberOfSteps, time.endTime = n_steps, n_steps * step
    time.minimumStepSize, time.adaptiveStep = LEAST_STEP, True
    time.newton.useModifiedNewton = True
    time.newton.relativeTolerance = time.newton.absoluteTolerance = NEWTON_TOLERANCE
    time.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    time.generalizedAlpha.computeInitialAccelerations = True
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return settings


def _quiet(settings: Any) -> Any:
    """Without files and without words."""
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = settings.staticSolver.verboseMode = 0
    return settings


def solved(solve: Any) -> bool:
    """Whether a solver of Exudyn came to its end; what it prints is dropped.

    Args:
        solve: calls the solver.
    """
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            return solve() is not False
        except (ValueError, RuntimeError):  # "SolveDynamic terminated", or a law that met no number
            return False
