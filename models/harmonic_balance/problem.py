"""The problem whose solutions are a curve: the equations, what is held, what is free, and the units of a step."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from models.arrays import ComplexArray, FloatArray, IntArray
from models.harmonic_balance.equations import Equations, OverPeriod


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
        return Motion(self.equations.unpacked(self._motion(u)), *self._free(u))

    def residual(self, u: FloatArray) -> FloatArray:
        """(m,) what is left of the equations at a point."""
        omega, amplitude = self._free(u)
        residual = self.equations.residual(self._motion(u), omega, amplitude) / self.span.length
        return residual if self.quadrature is None else np.append(residual, self._phase_row @ u)

    def slopes(self, u: FloatArray) -> FloatArray:
        """(m, m + 1) slopes of what is left."""
        slopes = self.equations.slopes(self._motion(u), *self._free(u))[:, self._columns] * self._scales
        return slopes if self.quadrature is None else np.vstack([slopes, self._phase_row])

    def over_period(self, u: FloatArray) -> OverPeriod:
        """The forces at a point and their slopes."""
        return self.equations.over_period(self._motion(u), *self._free(u))

    def with_harmonics(self, n: int) -> "Problem":
        """The same with another number of harmonics."""
        return replace(self, equations=replace(self.equations, n_harmonics=n))

    def _motion(self, u: FloatArray) -> FloatArray:
        """(n,) of the ports, m."""
        return u[: self.equations.n_unknowns] * self.span.length

    def _free(self, u: FloatArray) -> tuple[float, float]:
        """Frequency, rad/s, and amplitude of a point."""
        n, amplitude = self.equations.n_unknowns, self.span.amplitude
        if self.omega is not None:
            return self.omega, amplitude * float(u[n])
        return float(u[n]) * self._unit, amplitude * float(u[n + 1]) if self.quadrature is not None else amplitude

    @cached_property
    def _columns(self) -> slice | IntArray:
        """Slopes over what is free: the motion, and frequency, amplitude or both."""
        n = self.equations.n_unknowns
        if self.omega is not None:
            return np.array([*range(n), n + 1])
        return slice(None) if self.quadrature is not None else slice(n + 1)

    @cached_property
    def _scales(self) -> FloatArray:
        """(m + 1,) of the slopes' columns in the curve's units."""
        free = np.array([self._unit, self.span.amplitude]) / self.span.length
        return np.concatenate([np.ones(self.equations.n_unknowns), free])[self._columns]

    @cached_property
    def _phase_row(self) -> FloatArray:
        """(m + 1,) slopes of the condition of phase resonance, which is linear."""
        assert self.quadrature is not None
        row = np.zeros(self.equations.n_unknowns + 2)
        first = self.quadrature.port * (2 * self.equations.n_harmonics + 1) + 1
        row[first], row[first + 1] = self.quadrature.given.real, self.quadrature.given.imag
        return row

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
