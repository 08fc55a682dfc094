"""The problem whose solutions are a curve: the equations, what is held, what is free, and the units of a step."""

from dataclasses import dataclass, replace

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.harmonic_balance.equations import Balance, Equations


@dataclass(frozen=True)
class Span:
    """Where the curve runs, and its units.

    Attributes:
        low, high: of the frequency, rad/s.
        length: of the ports' motion, m.
        amplitude: of the excitation; where it is free it runs up to here.
    """

    low: float
    high: float
    length: float
    amplitude: float

    def holds(self, omega: float, amplitude: float) -> bool:
        """Whether a point lies within."""
        return self.low <= omega <= self.high and 0.0 <= amplitude <= self.amplitude


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
        x = resized(motion.x, self.equations.n_harmonics)
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


def resized(x: ComplexArray, n_harmonics: int) -> ComplexArray:
    """The coefficients cut or filled up with nothing.

    Args:
        x: (n_ports, any) coefficients from harmonic 0 on.
        n_harmonics: the highest afterwards.
    """
    other = np.zeros((len(x), n_harmonics + 1), complex)
    kept = min(x.shape[1], n_harmonics + 1)
    other[:, :kept] = x[:, :kept]
    return other
