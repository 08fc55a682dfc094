"""Following periodic motion while the frequency, or frequency and amplitude together, change; harmonics as needed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError
from models.harmonic_balance.continuation import CORNER, SHARPEST_TURN, STEPS, Point, corrected, next_step
from models.harmonic_balance.curve import PeriodicCurve
from models.harmonic_balance.equations import OverPeriod
from models.harmonic_balance.problem import Motion, Problem, resized
from models.harmonic_balance.stability import Stability, stability_of

HARMONICS = (3, 5, 7, 11, 15, 21, 31, 45, 63)
"""Numbers of harmonics between which a curve chooses."""

SPARE = 10.0
"""Times by which fewer harmonics have to be better than asked before they are taken."""


@dataclass(frozen=True, eq=False)
class _Found:
    """A point as it was found."""

    point: Point
    motion: Motion
    moved: OverPeriod
    forces: ComplexArray
    left_out: float


@dataclass(frozen=True, eq=False)
class _Kept:
    """What stays of it."""

    motion: Motion
    forces: ComplexArray
    left_out: float
    stability: Stability


@dataclass(eq=False)
class Follower:
    """Walks along a curve.

    Attributes:
        problem: with as many harmonics as the curve needs at the moment.
        accuracy: share of the ports' motion that harmonics left out may have.
        judged: whether stability is asked for.
        most_points: after which it stops.
        first_step: in the curve's own units; the lengths of all others follow from it.
    """

    problem: Problem
    accuracy: float
    judged: bool
    most_points: int
    first_step: float = STEPS[1]

    def follow(self, start: Motion, progress: Callable[[str], None], sign: float = 1.0) -> PeriodicCurve:
        """From a motion near the curve's beginning until it leaves its span.

        Args:
            start: near the first point, at which the last free number is as it is here.
            progress: told where the curve is.
            sign: 1 if that number grows at first, -1 if it falls.

        Raises:
            DivergenceError: no motion was found near the first.
        """
        guess = self.problem.point(start)
        along = np.zeros(len(guess))
        along[-1] = sign
        first = corrected(self.problem, guess, along, in_corner=True)
        if first is None:
            raise DivergenceError(
                f"no periodic motion was found at {start.omega / (2 * np.pi):.4g} Hz and an amplitude of "
                f"{start.amplitude:.4g}, where the curve is to begin; begin further from a resonance, or lower"
            )
        step, bend, ended = self.first_step, np.zeros(0), ""
        found = self._refined(first)
        point, kept = found.point, [self._kept(found)]
        while len(kept) < self.most_points:
            ahead = self._ahead(point, step, bend)
            if ahead is None:
                step *= 0.25
                if step < STEPS[0]:
                    ended = self._where(kept[-1], "Newton's method finds no next point")
                    break
                continue
            bend = (ahead.direction - point.direction) / step
            step = next_step(step, ahead.contraction)
            found = self._refined(ahead)
            kept.append(self._kept(found))
            omega, amplitude = found.motion.omega, found.motion.amplitude
            if not self.problem.span.holds(omega, amplitude):
                break
            progress(f"{omega / (2 * np.pi):.3f} Hz, {self.problem.equations.n_harmonics} harmonics")
            point = self._eased(found)
        else:
            ended = self._where(kept[-1], f"{self.most_points} points are the most that were allowed")
        return self._curve(kept, ended)

    def _ahead(self, point: Point, step: float, bend: FloatArray) -> Point | None:
        """The next point, unless it is not found or the curve turns too sharply on the way.

        Args:
            point: the last one.
            step: to go, in the curve's units.
            bend: change of the direction per unit of the last step; of another length where harmonics have changed.
        """
        guess = point.u + step * point.direction
        if len(bend) == len(guess):
            guess += 0.5 * step**2 * bend
        ahead = corrected(self.problem, guess, point.direction, in_corner=step <= CORNER)
        if ahead is None:
            return None
        turn = float(ahead.direction @ point.direction)
        return ahead if turn > (SHARPEST_TURN if step > CORNER else 0.0) else None

    def _refined(self, point: Point) -> _Found:
        """The same point with as many harmonics as the accuracy asks for."""
        found = self._found(point, self.problem)
        while found.left_out > self.accuracy and self.problem.equations.n_harmonics < HARMONICS[-1]:
            more = HARMONICS[HARMONICS.index(self.problem.equations.n_harmonics) + 1]
            finer, guess = self._with_harmonics(found.point, more)
            better = corrected(finer, guess.u, guess.direction, in_corner=True)
            if better is None:
                break
            self.problem, found = finer, self._found(better, finer)
        return found

    def _eased(self, found: _Found) -> Point:
        """The same point with fewer harmonics where these are far better than asked for."""
        n = self.problem.equations.n_harmonics
        if n == HARMONICS[0]:
            return found.point
        fewer = HARMONICS[HARMONICS.index(n) - 1]
        x = found.motion.x
        if SPARE * np.linalg.norm(x[:, fewer + 1 :]) > self.accuracy * np.linalg.norm(x[:, 1:]):
            return found.point
        self.problem, point = self._with_harmonics(found.point, fewer)
        return point

    def _with_harmonics(self, point: Point, n: int) -> tuple[Problem, Point]:
        """Problem and point with another number of harmonics."""
        old, new = self.problem, self.problem.with_harmonics(n)
        u = new.point(old.motion(point.u))
        turned = new.equations.packed(resized(old.equations.unpacked(point.direction[: -new.n_free]), n))
        direction = np.append(turned, point.direction[-new.n_free :])
        return new, Point(u, direction / np.linalg.norm(direction), point.contraction)

    def _found(self, point: Point, problem: Problem) -> _Found:
        """A point with the share of its motion that harmonics after the last would have."""
        motion, moved = problem.motion(point.u), problem.over_period(point.u)
        pushed, n = np.fft.rfft(moved.forces, axis=1, norm="forward"), motion.x.shape[1]
        turn = 1j * motion.omega * np.arange(n, 2 * n)
        beyond = problem.equations.receptance.at(turn)[:, :, :-1] @ pushed[:, n : 2 * n].T[:, :, None]
        left_out = float(np.linalg.norm(beyond) / np.linalg.norm(motion.x[:, 1:]))
        return _Found(point, motion, moved, pushed[:, :n], left_out)

    def _kept(self, found: _Found) -> _Kept:
        model, omega = self.problem.equations.model, found.motion.omega
        stability = stability_of(model, omega, found.moved) if self.judged else Stability(np.nan, "")
        return _Kept(found.motion, found.forces, found.left_out, stability)

    @staticmethod
    def _where(kept: _Kept, why: str) -> str:
        at = kept.motion
        return f"the curve ends at {at.omega / (2 * np.pi):.4g} Hz and an amplitude of {at.amplitude:.4g}: {why}"

    def _curve(self, kept: list[_Kept], ended: str) -> PeriodicCurve:
        most = max(one.motion.x.shape[1] for one in kept) - 1
        return PeriodicCurve(
            model=self.problem.equations.model,
            freqs=np.array([one.motion.omega for one in kept]) / (2.0 * np.pi),
            amplitudes=np.array([one.motion.amplitude for one in kept]),
            motion=np.stack([resized(one.motion.x, most) for one in kept]),
            forces=np.stack([resized(one.forces, most) for one in kept]),
            left_out=np.array([one.left_out for one in kept]),
            largest_multiplier=np.array([one.stability.largest for one in kept]),
            losses=tuple(one.stability.loss for one in kept),
            ended=ended,
        )
