"""Kelvin-Voigt: spring and dashpot in parallel."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.contact.hertz import Hertz
from models.contact.protocol import ContactLaw


@dataclass(frozen=True)
class KelvinVoigt(ContactLaw):
    """N = k p + c dp/dt; the dashpot makes the force jump where contact begins.

    Attributes:
        stiffness: k, N/m.
        damping: c, N s/m.
    """

    name: ClassVar[str] = "kelvin_voigt"
    source: ClassVar[str] = "W. Goldsmith, Impact (1960), section 4.2"

    damping: float = 0.0

    @classmethod
    def from_sleeve(cls, stiffness: float, damping: float) -> Self:
        """Stiffness N/m and damping N s/m, as they stand in the rig file."""
        return cls(stiffness, damping)

    @staticmethod
    def normal_force(t: float, p: float, p_rate: float, z: float, c: Sequence[float]) -> float:  # noqa: ARG004
        """k p + c dp/dt."""
        return c[0] * p + c[1] * p_rate

    def with_elastic(self, stiffness: float, exponent: float) -> Hertz:
        """Hertz' law with the same dashpot."""
        return Hertz(stiffness, self.damping, exponent)

    @property
    def values(self) -> tuple[float, ...]:
        """(k, c)."""
        return (self.stiffness, self.damping)

    @property
    def straight(self) -> tuple[float, float] | None:
        """(k, c); None of a law that derives from this one and has a force of its own."""
        if self.normal_force is not KelvinVoigt.normal_force:
            return None
        stiffness, damping = self.values
        return stiffness, damping
