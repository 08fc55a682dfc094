"""Hunt-Crossley: damping that grows with penetration, so that the force starts and ends at zero."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.contact.dissipating import Dissipating
from models.contact.protocol import ContactLaw


@dataclass(frozen=True)
class HuntCrossley(ContactLaw):
    """N = k p (1 + 3/2 alpha dp/dt), with a linear elastic part.

    Attributes:
        stiffness: k, N/m.
        dissipation: alpha, s/m; restitution is about 1 - alpha v for small alpha v.
    """

    name: ClassVar[str] = "hunt_crossley"
    source: ClassVar[str] = "K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440, eq. (8)"

    dissipation: float = 0.0

    @classmethod
    def from_sleeve(cls, stiffness: float, damping: float) -> Self:
        """Stiffness N/m; the rig's ``damping`` is read as the dissipation alpha, s/m."""
        return cls(stiffness, damping)

    @staticmethod
    def normal_force(t: float, p: float, p_rate: float, z: float, c: Sequence[float]) -> float:  # noqa: ARG004
        """K p (1 + 3/2 alpha dp/dt)."""
        return c[0] * p * (1.0 + 1.5 * c[1] * p_rate)

    def with_elastic(self, stiffness: float, exponent: float) -> Dissipating:
        """The same dissipation."""
        return Dissipating(stiffness, 1.5 * self.dissipation, exponent)

    @property
    def values(self) -> tuple[float, ...]:
        """(k, alpha)."""
        return (self.stiffness, self.dissipation)
