"""A contact that stiffens as it is pressed."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.ports import Contact

DEPTH = 0.1
"""Penetration assumed where the given model never touches, as a share of the largest displacement."""


BETWEEN_VALLEYS = 2.0
"""Exponent."""


@dataclass(frozen=True)
class HertzContact(Effect):
    """The elastic part of the contact's force is stiffness p^exponent in place of k p; the dashpot stays."""

    kind: ClassVar[str] = "hertz_contact"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "K. L. Johnson, Contact Mechanics (1985), eq. (4.23)"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances of the beam that the sleeve holds shift with the depth of the contact; even harmonics",
        level="at low level one stiffness, that under the load at rest; stiffer the deeper the impacts",
        time="while the sleeve is closed",
        place="modes that move at the sleeve",
    )

    stiffness: float = parameter("K", "N/m^n", lower=1e-3)
    exponent: float = parameter("n", "-", lower=1.0, upper=4.0, spread=0.4)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """The given contact's largest load is carried at its penetration, before, or deeper, for n = 1.5 and 2.5."""
        assert scene.contact is not None
        law = scene.contact.law
        depth = scene.penetration or DEPTH * scene.displacement
        for exponent in (1.5, 2.5):
            for deeper in (0.7, 1.0, 1.5, 3.0):
                yield cls(scene.place, law.elastic(depth) / (deeper * depth) ** exponent, exponent)

    @property
    def valley(self) -> str:
        """Stiffness and exponent go together over many decades, from a sphere's to a pad's."""
        return "sphere" if self.exponent < BETWEEN_VALLEYS else "pad"

    def change_contact(self, contact: Contact) -> Contact:
        """The contact with this elastic part."""
        return replace(contact, law=contact.law.with_elastic(self.stiffness, self.exponent))

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"only in contact, and the stiffer the deeper: {self.stiffness * 1e-5**self.exponent:.3g} N at 0.01 mm, "
            f"{self.stiffness * 1e-4**self.exponent:.3g} N at 0.1 mm (exponent {self.exponent:.3g})"
        )
