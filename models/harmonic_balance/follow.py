"""Following periodic motion while the frequency, or frequency and amplitude together, change; harmonics as needed."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError
from models.harmonic_balance.continuation import CORNER, SHARPEST_TURN, STEPS, Point, corrected, next_step
from models.harmonic_balance.curve import PeriodicCurve
from models.harmonic_balance.equations import Balance
from models.harmonic_balance.problem import Motion, Problem, resized
from models.harmonic_balance.stability import Loss, stability_of

HARMONICS = (3, 5, 7, 11, 15, 21, 31, 45, 63)
"""Numbers of harmonics between which a curve chooses."""

SPARE = 10.0
"""Times by which fewer harmonics have to be better than asked before they are taken."""


@dataclass(frozen=True, eq=False)
class _Found:
    """A point with what is kept of it."""

    motion: Motion
    forces: ComplexArray
    left_out: float
    largest: float
    loss: Loss


@dataclass(eq=False)
class Follower:
    """Walks along a curve.

    Attributes:
        problem: with as many harmonics as the curve needs at the moment.
        accuracy: share of the ports' motion that harmonics left out may have.
        judged: whether stability is asked for.
        most_points: after which it stops.
    """

    problem: Problem
    accuracy: float
    judged: bool
    most_points: int

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
        point = corrected(self.problem.evaluate, guess, along)
        if point is None:
            raise DivergenceError(
                f"no periodic motion was found at {start.omega / (2 * np.pi):.4g} Hz and an amplitude of "
                f"{start.amplitude:.4g}, where the curve is to begin; begin further from a resonance, or lower"
            )
        step, bend, ended = STEPS[1], np.zeros(0), ""
        point = self._refined(point)
        found = [self._kept(point)]
        while len(found) < self.most_points:
            ahead = self._ahead(point, step, bend)
            if ahead is None:
                step *= 0.25
                if step < STEPS[0]:
                    ended = self._where(found[-1], "Newton's method finds no next point")
                    break
                continue
            bend = (ahead.direction - point.direction) / step
            step = next_step(step, ahead.iterations)
            point = self._refined(ahead)
            found.append(self._kept(point))
            at = found[-1].motion
            if not self.problem.span.holds(at.omega, at.amplitude):
                break
            progress(f"{at.omega / (2 * np.pi):.3f} Hz, {self.problem.equations.n_harmonics} harmonics")
            point = self._eased(point, found[-1])
        else:
            ended = self._where(found[-1], f"{self.most_points} points are the most that were allowed")
        return self._curve(found, ended)

    def _ahead(self, point: Point[Balance], step: float, bend: FloatArray) -> Point[Balance] | None:
        """The next point, unless it is not found or the curve turns too sharply on the way.

        Args:
            point: the last one.
            step: to go, in the curve's units.
            bend: change of the direction per unit of the last step; of another length where harmonics have changed.
        """
        guess = point.u + step * point.direction
        if len(bend) == len(guess):
            guess += 0.5 * step**2 * bend
        ahead = corrected(self.problem.evaluate, guess, point.direction)
        if ahead is None:
            return None
        turn = float(ahead.direction @ point.direction)
        return ahead if turn > (SHARPEST_TURN if step > CORNER else 0.0) else None

    def _refined(self, point: Point[Balance]) -> Point[Balance]:
        """The same point with as many harmonics as the accuracy asks for."""
        while self._left_out(point) > self.accuracy and self.problem.equations.n_harmonics < HARMONICS[-1]:
            more = HARMONICS[HARMONICS.index(self.problem.equations.n_harmonics) + 1]
            finer, guess = self._with_harmonics(point, more)
            better = corrected(finer.evaluate, guess.u, guess.direction)
            if better is None:
                break
            self.problem, point = finer, better
        return point

    def _eased(self, point: Point[Balance], found: _Found) -> Point[Balance]:
        """The same point with fewer harmonics where these are far better than asked for."""
        n = self.problem.equations.n_harmonics
        if n == HARMONICS[0]:
            return point
        fewer = HARMONICS[HARMONICS.index(n) - 1]
        x = found.motion.x
        if SPARE * np.linalg.norm(x[:, fewer + 1 :]) > self.accuracy * np.linalg.norm(x[:, 1:]):
            return point
        self.problem, point = self._with_harmonics(point, fewer)
        return point

    def _with_harmonics(self, point: Point[Balance], n: int) -> tuple[Problem, Point[Balance]]:
        """Problem and point with another number of harmonics."""
        old, new = self.problem, self.problem.with_harmonics(n)
        u = new.point(old.motion(point.u))
        turned = new.equations.packed(resized(old.equations.unpacked(point.direction[: -new.n_free]), n))
        direction = np.append(turned, point.direction[-new.n_free :])
        return new, Point(u, direction / np.linalg.norm(direction), point.iterations, point.seen)

    def _left_out(self, point: Point[Balance]) -> float:
        """Motion in the harmonics after the last, as the forces of this motion cause it, over that in those kept."""
        equations, motion = self.problem.equations, self.problem.motion(point.u)
        kept = equations.n_harmonics + 1
        force = self._pushed(point.seen)[:, kept : 2 * kept]
        turn = 1j * motion.omega * np.arange(kept, kept + force.shape[1])
        moved = equations.receptance.at(turn)[:, :, :-1] @ force.T[:, :, None]
        return float(np.linalg.norm(moved) / np.linalg.norm(motion.x[:, 1:]))

    def _kept(self, point: Point[Balance]) -> _Found:
        motion, balance = self.problem.motion(point.u), point.seen
        largest: float = np.nan
        loss: Loss = ""
        if self.judged:
            stability = stability_of(self.problem.equations, motion.omega, balance)
            largest, loss = stability.largest, stability.loss
        pushed = self._pushed(balance)[:, : motion.x.shape[1]]
        return _Found(motion, pushed, self._left_out(point), largest, loss)

    @staticmethod
    def _pushed(balance: Balance) -> ComplexArray:
        return np.asarray(np.fft.rfft(balance.forces, axis=1, norm="forward"))

    @staticmethod
    def _where(found: _Found, why: str) -> str:
        at = found.motion
        return f"the curve ends at {at.omega / (2 * np.pi):.4g} Hz and an amplitude of {at.amplitude:.4g}: {why}"

    def _curve(self, found: list[_Found], ended: str) -> PeriodicCurve:
        most = max(one.motion.x.shape[1] for one in found) - 1
        return PeriodicCurve(
            model=self.problem.equations.model,
            freqs=np.array([one.motion.omega for one in found]) / (2.0 * np.pi),
            amplitudes=np.array([one.motion.amplitude for one in found]),
            motion=np.stack([resized(one.motion.x, most) for one in found]),
            forces=np.stack([resized(one.forces, most) for one in found]),
            left_out=np.array([one.left_out for one in found]),
            largest_multiplier=np.array([one.largest for one in found]),
            losses=tuple(one.loss for one in found),
            ended=ended,
        )
