"""A contact that is stiffer or softer than the rig file says."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Place, PlaceKind, Scene, Signature, parameter
from models.ports import Contact


@dataclass(frozen=True)
class ContactStiffness(Effect):
    """The elastic part of the contact's force is multiplied by ``ratio``; its damping stays."""

    kind: ClassVar[str] = "contact_stiffness"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "K. L. Johnson, Contact Mechanics (1985), chapter 11"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances of the beam that the sleeve holds shift, up where the contact is stiffer",
        level="only in contact: at every level where the beam rests on the sleeve, else once the gap is closed",
        time="while the sleeve is closed; impacts are shorter where it is stiffer",
        place="modes that move at the sleeve",
    )

    ratio: float = parameter("r_k", "-", lower=1e-3, upper=1e3, spread=1.0, neutral=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """From half to twice the given stiffness."""
        for ratio in (0.5, 0.8, 1.25, 2.0):
            yield cls(scene.place, ratio=ratio)

    def change_contact(self, contact: Contact) -> Contact:
        """The contact with the stiffer law."""
        return replace(contact, law=contact.law.stiffer(self.ratio))

    def as_sleeve_numbers(self, contact: Contact) -> Mapping[str, float]:
        """Its stiffness."""
        return {"stiffness": self.ratio * contact.law.stiffness}

    @classmethod
    def from_sleeve_number(cls, place: Place, contact: Contact, key: str, value: float) -> Self | None:
        """A contact as stiff."""
        return cls(place, ratio=value / contact.law.stiffness) if key == "stiffness" else None

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"only in contact: the sleeve's spring is {self.ratio:.3g} times as stiff as the rig file says"
