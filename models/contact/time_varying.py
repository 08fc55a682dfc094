"""Kelvin-Voigt with a dashpot that follows a table over the record.

Not registered in ``CONTACT_LAWS``: a rig file gives a sleeve two numbers and cannot name a table. The effect
``time_varying_damping`` makes this law.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.contact.protocol import ContactLaw


@dataclass(frozen=True)
class TimeVarying(ContactLaw):
    """N = k p^m + c(t) dp/dt, with c(t) straight between the knots and constant before the first and after the last.

    Attributes:
        stiffness: k, N/m^exponent.
        times: of the knots, growing, s from the record's first sample.
        dampings: c at the knots, N s/m.
        exponent: of the penetration in the elastic part.
    """

    name: ClassVar[str] = "time_varying"
    source: ClassVar[str] = "Actuators 14 (2025) 58, section 2: k p + c(t) dp/dt in place of a constant damping"

    times: tuple[float, ...]
    dampings: tuple[float, ...]
    exponent: float = 1.0

    @classmethod
    def from_sleeve(cls, stiffness: float, damping: float) -> Self:
        """Stiffness N/m and a damping N s/m that stays: Kelvin-Voigt."""
        return cls(stiffness, (0.0,), (damping,))

    @staticmethod
    def normal_force(t: float, p: float, p_rate: float, z: float, c: Sequence[float]) -> float:  # noqa: ARG004
        """K p^m + c(t) dp/dt, with c = (k, m, n, t1..tn, c1..cn)."""
        n = int(c[2])
        first, last = 3, 2 + n
        if t <= c[first]:
            damping = c[first + n]
        elif t >= c[last]:
            damping = c[last + n]
        else:
            i = first
            while t > c[i + 1]:
                i += 1
            damping = c[i + n] + (c[i + 1 + n] - c[i + n]) * (t - c[i]) / (c[i + 1] - c[i])
        spring: float = p ** c[1] if p > 0.0 else -((-p) ** c[1])
        return c[0] * spring + damping * p_rate

    def later(self, seconds: float) -> Self:
        """The table with its times counted from then."""
        return replace(self, times=tuple(time - seconds for time in self.times))

    def with_elastic(self, stiffness: float, exponent: float) -> Self:
        """The same table."""
        return replace(self, stiffness=stiffness, exponent=exponent)

    @property
    def power(self) -> float:
        """The exponent."""
        return self.exponent

    @property
    def values(self) -> tuple[float, ...]:
        """(k, m, n, t1..tn, c1..cn)."""
        return (self.stiffness, self.exponent, float(len(self.times)), *self.times, *self.dampings)
