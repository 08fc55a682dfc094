"""A contact that loses energy in proportion to how deep it is pressed; the form that all restitution laws share.

Not registered in ``CONTACT_LAWS``: a rig file gives a sleeve two numbers, and with those it is Hunt and Crossley's law.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.contact.protocol import ContactLaw


@dataclass(frozen=True)
class Dissipating(ContactLaw):
    """N = k p^n (1 + a dp/dt): the force starts and ends at zero, and the restitution does not depend on k and n.

    Attributes:
        stiffness: k, N/m^n.
        dissipation: a, s/m; ``models.ball.restitution`` gives it for a restitution.
        exponent: n.
    """

    name: ClassVar[str] = "dissipating"
    source: ClassVar[str] = "K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440, eq. (6)"

    dissipation: float = 0.0
    exponent: float = 1.5

    @classmethod
    def from_sleeve(cls, stiffness: float, damping: float) -> Self:
        """Stiffness N/m and dissipation s/m of a linear contact."""
        return cls(stiffness, damping, 1.0)

    @staticmethod
    def normal_force(t: float, p: float, p_rate: float, z: float, c: Sequence[float]) -> float:  # noqa: ARG004
        """K p^n (1 + a dp/dt), with c = (k, a, n)."""
        spring: float = p ** c[2] if p > 0.0 else -((-p) ** c[2])
        return c[0] * spring * (1.0 + c[1] * p_rate)

    def with_elastic(self, stiffness: float, exponent: float) -> Self:
        """The same law with other numbers."""
        return replace(self, stiffness=stiffness, exponent=exponent)

    @property
    def power(self) -> float:
        """The exponent."""
        return self.exponent

    @property
    def values(self) -> tuple[float, ...]:
        """(k, a, n)."""
        return (self.stiffness, self.dissipation, self.exponent)
