"""What a contact law is: frozen parameters and one scalar function of penetration and its rate."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

SMALLEST, LARGEST = 1e-9, 1.0
"""Penetrations, m, between which a load is sought."""


@dataclass(frozen=True)
class ContactLaw(ABC):
    """The normal force of a closed contact, before it is kept from pulling.

    Attributes:
        stiffness: N/m (or N/m^n where the law says so).
    """

    name: ClassVar[str]
    source: ClassVar[str]

    stiffness: float

    @classmethod
    @abstractmethod
    def from_sleeve(cls, stiffness: float, damping: float) -> Self:
        """The law with the two numbers a rig file gives a sleeve: stiffness N/m, damping in the law's own unit."""

    @staticmethod
    @abstractmethod
    def normal_force(t: float, p: float, p_rate: float, z: float, c: Sequence[float]) -> float:
        """Force, N, at penetration p > 0 (m) growing at p_rate (m/s), with the numbers of ``values`` in c.

        Compiled by ``models.law``; a negative value is cut to 0 by the stepper, so that the contact never pulls.
        """

    @property
    @abstractmethod
    def values(self) -> tuple[float, ...]:
        """The law's numbers in the order in which ``normal_force`` reads them."""

    @property
    def power(self) -> float:
        """Of the penetration in the elastic part."""
        return 1.0

    @property
    def straight(self) -> tuple[float, float] | None:
        """(k, c), N/m and N s/m, where the force is k p + c dp/dt whatever they are; None where it is not."""
        return None

    def elastic(self, p: float) -> float:
        """Force, N, at a penetration p (m) that stands still, at the record's start."""
        return self.normal_force(0.0, p, 0.0, 0.0, self.values)

    def damping_at(self, p: float, p_rate: float) -> float:
        """Damping, N s/m, at a penetration p (m) that grows at p_rate (m/s), at the record's start."""
        return (self.normal_force(0.0, p, p_rate, 0.0, self.values) - self.elastic(p)) / p_rate

    def slope_under(self, load: float) -> float:
        """Stiffness, N/m, where the elastic part carries a load (N), over the last doubling of the penetration."""
        if self.straight is not None:
            return self.straight[0]
        p = SMALLEST
        while self.elastic(p) < load and p < LARGEST:
            p *= 2.0
        return (self.elastic(p) - self.elastic(0.5 * p)) / (0.5 * p)

    @abstractmethod
    def with_elastic(self, stiffness: float, exponent: float) -> "ContactLaw":
        """A law with the elastic part stiffness p^exponent, N/m^n, that loses energy as this one does."""

    def later(self, seconds: float) -> Self:  # noqa: ARG002
        """The law as a record meets it that begins so much later; one without a clock is the same."""
        return self

    def stiffer(self, ratio: float) -> Self:
        """The same law with its elastic part multiplied by ``ratio``."""
        return replace(self, stiffness=self.stiffness * ratio)
