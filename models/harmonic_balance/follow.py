"""Following periodic motion while the frequency, or frequency and amplitude together, change; harmonics as needed."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError
from models.harmonic_balance.continuation import CORNER, SHARPEST_TURN, STEPS, Point, corrected, next_step
from models.harmonic_balance.curve import PeriodicCurve
from models.harmonic_balance.equations import Balance, Equations
from models.harmonic_balance.stability import Loss, stability_of

HARMONICS = (3, 5, 7, 11, 15, 21, 31, 45, 63)
"""Numbers of harmonics between which a curve chooses."""

SPARE = 10.0
"""Times by which fewer harmonics have to be better than asked before they are taken."""


@dataclass(frozen=True)
class Span:
    """Where the curve runs, and its units.

    Attributes:
        low, high: of the frequency, rad/s.
        length: of the ports' motion, m.
        least_amplitude, amplitude: of the excitation; it runs between them where it is free.
    """

    low: float
    high: float
    length: float
    least_amplitude: float
    amplitude: float

    def holds(self, omega: float, amplitude: float) -> bool:
        """Whether a point lies within."""
        return self.low <= omega <= self.high and self.least_amplitude <= amplitude <= self.amplitude


@dataclass(frozen=True, eq=False)
class Motion:
    """One periodic motion.

    Attributes:
        x: (n_ports, H + 1) coefficients of the ports about rest, m.
        omega: rad/s.
        amplitude: of the excitation.
    """

    x: ComplexArray
    omega: float
    amplitude: float


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Phase resonance: a port's first harmonic stands at right angles to the excitation.

    Attributes:
        port: its number.
        given: phase of the input, of modulus 1.
    """

    port: int
    given: complex


@dataclass(frozen=True, eq=False)
class Problem:
    """The equations in units in which a curve's steps mean the same everywhere.

    Attributes:
        equations: for a number of harmonics.
        span: units and ends.
        omega: where the frequency is held and the amplitude free, rad/s; None where the frequency is free.
        quadrature: asks for phase resonance, and frees the amplitude too; None at a fixed amplitude.
    """

    equations: Equations
    span: Span
    omega: float | None = None
    quadrature: Quadrature | None = None

    @property
    def n_free(self) -> int:
        """Numbers beside the ports' motion that are free."""
        return 2 if self.quadrature is not None else 1

    def point(self, motion: Motion) -> FloatArray:
        """(m + 1,) a motion in the curve's units."""
        x = _resized(motion.x, self.equations.n_harmonics)
        free = [motion.omega / self._unit] if self.omega is None else []
        if self.omega is not None or self.quadrature is not None:
            free.append(motion.amplitude / self.span.amplitude)
        return np.concatenate([self.equations.packed(x) / self.span.length, free])

    def motion(self, u: FloatArray) -> Motion:
        """The motion of a point."""
        n = self.equations.n_unknowns
        x, omega, amplitude = self.equations.unpacked(u[:n] * self.span.length), self.omega, self.span.amplitude
        if omega is None:
            return Motion(x, float(u[n]) * self._unit, amplitude * float(u[n + 1]) if self.quadrature else amplitude)
        return Motion(x, omega, amplitude * float(u[n]))

    def evaluate(self, u: FloatArray) -> tuple[FloatArray, FloatArray, Balance]:
        """(m,) residual, (m, m + 1) slopes and the forces over the period."""
        motion, length = self.motion(u), self.span.length
        balance = self.equations.balance(motion.x, motion.omega, motion.amplitude)
        residual = self.equations.packed(balance.residual) / length
        slopes = [balance.by_x]
        if self.omega is None:
            slopes.append(balance.by_omega[:, None] * (self._unit / length))
        if self.omega is not None or self.quadrature is not None:
            slopes.append(balance.by_amplitude[:, None] * (self.span.amplitude / length))
        slope = np.hstack(slopes)
        if self.quadrature is None:
            return residual, slope, balance
        first = self.quadrature.port * (2 * self.equations.n_harmonics + 1) + 1
        row = np.zeros(slope.shape[1])
        row[first], row[first + self.equations.n_harmonics] = self.quadrature.given.real, self.quadrature.given.imag
        return np.append(residual, row @ u), np.vstack([slope, row]), balance

    def with_harmonics(self, n: int) -> "Problem":
        """The same with another number of harmonics."""
        return replace(self, equations=replace(self.equations, n_harmonics=n))

    @property
    def _unit(self) -> float:
        return self.span.high - self.span.low


def _resized(x: ComplexArray, n_harmonics: int) -> ComplexArray:
    resized = np.zeros((len(x), n_harmonics + 1), complex)
    kept = min(x.shape[1], n_harmonics + 1)
    resized[:, :kept] = x[:, :kept]
    return resized


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
        turned = new.equations.packed(_resized(old.equations.unpacked(point.direction[: -new.n_free]), n))
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
            motion=np.stack([_resized(one.motion.x, most) for one in found]),
            forces=np.stack([_resized(one.forces, most) for one in found]),
            left_out=np.array([one.left_out for one in found]),
            largest_multiplier=np.array([one.largest for one in found]),
            losses=tuple(one.loss for one in found),
            ended=ended,
        )
