"""The nonlinear FRF: all periodic motions under a sine of one amplitude, while its frequency goes through a band."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError, InputError
from models.harmonic_balance.continuation import STEPS
from models.harmonic_balance.curve import PeriodicCurve
from models.harmonic_balance.equations import Equations
from models.harmonic_balance.follow import HARMONICS, Follower
from models.harmonic_balance.problem import Motion, Problem, Span
from models.linear import linearised
from models.modal import build_modal
from models.plant import Plant

ACCURACY = 1e-3
"""Share of the ports' motion that harmonics left out may have."""

MOST_POINTS = 5000
"""Of one curve."""

APART = 0.05
"""Difference of first harmonics over their size beyond which two motions are two; a curve bends less in one step."""

SURVEYED = 400
"""Frequencies at which the linearised model tells how far the ports move."""


def nonlinear_frf(
    plant: Plant,
    amplitude: float,
    band: tuple[float, float],
    highest: float,
    *,
    downwards: bool = False,
    accuracy: float = ACCURACY,
    judge_stability: bool = True,
    progress: Callable[[str], None] = lambda _: None,
) -> PeriodicCurve:
    """Follow the periodic motion from one end of a band until it leaves the band, around every fold.

    A curve that folds back out of the end at which it began says so; what lies beyond is found from the other end.

    Args:
        plant: the rig with its effects, whose laws have neither memory nor clock.
        amplitude: of the sine, in the quantity of the rig's excitation.
        band: lowest and highest frequency of the sine, Hz.
        highest: frequency up to which modes follow the motion, Hz; what lies above yields statically.
        downwards: begin at the band's upper end.
        accuracy: share of the ports' motion that harmonics left out may have.
        judge_stability: whether each motion's stability is found.
        progress: told where the curve is.

    Raises:
        InputError: a law with a memory or a clock, a structure that drifts or that nothing holds, a rig that
            nothing drives.
        DivergenceError: no periodic motion was found at the end where the curve is to begin.
    """
    begun = _begun(plant, amplitude, band, highest, accuracy, downwards=downwards, progress=progress)
    return _followed(begun, accuracy, judge_stability=judge_stability, progress=progress)


def from_both_ends(
    plant: Plant,
    amplitude: float,
    band: tuple[float, float],
    highest: float,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[PeriodicCurve, ...]:
    """The curve from the lower end of a band and, where motion from rest at the upper one is another, that from there.

    Args:
        plant: as for ``nonlinear_frf``, which raises what this does.
        amplitude: of the sine.
        band: Hz.
        highest: frequency up to which modes follow the motion, Hz.
        progress: told why the curve is followed from the upper end too.
    """
    up = nonlinear_frf(plant, amplitude, band, highest)
    try:
        top = _begun(plant, amplitude, band, highest, ACCURACY, downwards=True)
    except DivergenceError as lost:
        if up.ended:
            raise
        progress(f"{amplitude:g}: {lost}; what else there may be at the upper end is not known")
        return (up,)
    why = up.ended or _other_motion(up, top.motion)
    if not why:
        return (up,)
    progress(f"{amplitude:g}: {why}; following it from {band[1]:g} Hz down")
    return up, _followed(top, ACCURACY)


@dataclass(frozen=True, eq=False)
class _Begun:
    """Where a curve begins, in the equations that were needed to get there, and whether it goes down from there."""

    problem: Problem
    motion: Motion
    downwards: bool


def _begun(
    plant: Plant,
    amplitude: float,
    band: tuple[float, float],
    highest: float,
    accuracy: float,
    *,
    downwards: bool,
    progress: Callable[[str], None] = lambda _: None,
) -> _Begun:
    """Motion at one end of a band, reached from small motion as the amplitude grows: where a test would begin."""
    low, high = (2.0 * np.pi * freq for freq in band)
    model = build_modal(plant, highest)
    if not model.ports:
        raise InputError(
            "a rig on which no law and no contact acts",
            "a nonlinear FRF is that of a rig with sleeves or effects",
            "take its linear FRF, the same at every level: testbed frf on a record of it, and testbed modes",
        )
    equations = Equations.of(model, HARMONICS[0])
    first, begin = linear_motion(equations, np.linspace(low, high, SURVEYED)), high if downwards else low
    span = Span(low, high, amplitude * float(np.abs(first).max()), amplitude)
    x = np.zeros((len(model.ports), HARMONICS[0] + 1), complex)
    x[:, 1] = 0.5 * LEAST_SHARE * amplitude * first[-1 if downwards else 0]
    ramp = Follower(Problem(equations, span, omega=begin), accuracy, judged=False, most_points=MOST_POINTS)
    risen = ramp.follow(Motion(x, begin, LEAST_SHARE * amplitude), progress)
    if risen.ended or risen.amplitudes[-1] < amplitude:
        why = risen.ended or "the motion that grows from rest shrinks again before"
        raise DivergenceError(
            f"no periodic motion was found at {begin / (2 * np.pi):g} Hz and an amplitude of {amplitude:g}, where the "
            f"curve is to begin: {why}; begin further from a resonance, or lower"
        )
    return _Begun(
        ramp.problem, Motion(_between(risen.motion, risen.amplitudes, amplitude), begin, amplitude), downwards
    )


def _followed(
    begun: _Begun,
    accuracy: float,
    *,
    judge_stability: bool = True,
    progress: Callable[[str], None] = lambda _: None,
) -> PeriodicCurve:
    """The curve from where it begins until it leaves the band, at either end.

    Where a wall is just touched a curve has a corner, at which it may pass its own earlier part within a step, and
    round-off decides whether it is followed on or back. One that ran back on itself is followed again in other steps.
    """
    sign = -1.0 if begun.downwards else 1.0
    for attempt in range(ATTEMPTS):
        follower = Follower(
            replace(begun.problem, omega=None),
            accuracy,
            judge_stability,
            MOST_POINTS,
            first_step=STEPS[1] * SHORTER**attempt,
        )
        curve = follower.follow(begun.motion, progress, sign)
        if not curve.ended and not _ran_back(curve, begun.motion, sign):
            break
    if not curve.ended and sign * (2.0 * np.pi * curve.freqs[-1] - begun.motion.omega) < 0.0:
        return replace(curve, ended=f"the curve folds back and leaves the band at {curve.freqs[-1]:.4g} Hz, as it came")
    return curve


def _ran_back(curve: PeriodicCurve, start: Motion, sign: float) -> bool:
    """Whether a curve leaves its band with the motion with which it began, or is stable where its frequency runs back.

    Every fold that turns the frequency back takes one multiplier through +1, so that motion there is not stable.
    """
    back = sign * np.diff(curve.freqs) < 0.0
    inside = np.flatnonzero(back[1:] & back[:-1]) + 1
    is_judged = np.isfinite(curve.largest_multiplier[inside])
    if np.count_nonzero(curve.is_stable[inside] & is_judged) > FEW:
        return True
    if abs(2.0 * np.pi * curve.freqs[-1] / start.omega - 1.0) > APART:
        return False
    first, last = (curve.motion[end, :, 1] for end in (0, -1))
    return bool(np.linalg.norm(last - first) < APART * np.linalg.norm(first))


FEW = 5
"""Points about corners whose stability is told by slopes of one side."""

ATTEMPTS, SHORTER = 5, 0.83
"""Times that a curve is followed, and first step of each as a share of the one before: one in five came back."""


def _between(motion: ComplexArray, at: FloatArray, wanted: float) -> ComplexArray:
    """The motion between the last two of a curve, at a value of what was free on it."""
    part = (wanted - at[-2]) / (at[-1] - at[-2])
    return np.asarray((1.0 - part) * motion[-2] + part * motion[-1])


def _other_motion(up: PeriodicCurve, motion: Motion) -> str:
    """In words, that a motion at the upper end is not the one at which the curve arrives; empty if it is."""
    arrives = _between(up.motion[:, :, 1], up.freqs, motion.omega / (2.0 * np.pi))
    apart = np.linalg.norm(motion.x[:, 1] - arrives) / np.linalg.norm(arrives)
    return "from rest another motion is reached at the upper end" if apart > APART else ""


LEAST_SHARE = 1e-3
"""Of the amplitude, where motion is small and a curve can begin with the tangents at rest."""


def linear_motion(equations: Equations, omega: FloatArray) -> ComplexArray:
    """(n_freq, n_ports) motion of the ports per unit excitation, about rest, by the tangents there.

    Args:
        equations: of the motion.
        omega: (n_freq,) rad/s.
    """
    linear, drive = linearised(equations.model), equations.drive
    rows, turn = equations.model.port_rows, 1j * omega[:, None, None]
    dynamic = turn**2 * np.eye(equations.model.n) + turn * linear.damping + linear.stiffness
    given = np.array([drive.input_at(float(one)) for one in omega])
    return np.asarray(np.linalg.solve(dynamic, drive.load[:, None])[..., 0] @ rows.T * given[:, None])
