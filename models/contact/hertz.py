"""Hertz: a contact that stiffens as it is pressed, with a dashpot beside it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.contact.protocol import ContactLaw


@dataclass(frozen=True)
class Hertz(ContactLaw):
    """N = k p^n + c dp/dt; n = 3/2 for two smooth bodies that touch at a point.

    Attributes:
        stiffness: k, N/m^n.
        damping: c, N s/m.
        exponent: n.
    """

    name: ClassVar[str] = "hertz"
    source: ClassVar[str] = "K. L. Johnson, Contact Mechanics (1985), eq. (4.23)"

    damping: float = 0.0
    exponent: float = 1.5

    @classmethod
    def from_sleeve(cls, stiffness: float, damping: float) -> Self:
        """Stiffness N/m^(3/2) and damping N s/m, as they stand in the rig file."""
        return cls(stiffness, damping)

    @staticmethod
    def normal_force(t: float, p: float, p_rate: float, z: float, c: Sequence[float]) -> float:  # noqa: ARG004
        """K p^n + c dp/dt, with c = (k, c, n)."""
        spring: float = p ** c[2] if p > 0.0 else -((-p) ** c[2])  # a sleeve without clearance has two sides
        return c[0] * spring + c[1] * p_rate

    def with_elastic(self, stiffness: float, exponent: float) -> Self:
        """The same law with other numbers."""
        return replace(self, stiffness=stiffness, exponent=exponent)

    @property
    def power(self) -> float:
        """The exponent."""
        return self.exponent

    @property
    def values(self) -> tuple[float, ...]:
        """(k, c, n)."""
        return (self.stiffness, self.damping, self.exponent)
