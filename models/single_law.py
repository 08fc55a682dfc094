"""What an effect is that is one force law at its place and nothing else."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from models.effects.protocol import Effect, Family, PlaceKind
from models.ports import Contact, PointLaw
from models.structure import Structure


@dataclass(frozen=True)
class SingleLaw(Effect):
    """A law called with all parameters of the effect; the subclass says which, and ``rate`` if it has a state."""

    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:
        """Force on the structure, N, with p = ``numbers()``."""
        raise NotImplementedError

    def numbers(self) -> tuple[float, ...]:
        """What the law is called with: the parameters in the order of the fields, a table by its entries."""
        return tuple(float(x) for name in self.parameters() for x in np.atleast_1d(getattr(self, name)))

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The law at its place."""
        return (PointLaw(self.port(contact), self.law, self.numbers(), getattr(self, "rate", None), self.label()),)
