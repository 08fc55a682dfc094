"""A sleeve that wears while it is hit."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.ports import Contact


@dataclass(frozen=True)
class Wear(Effect):
    """The clearance is clearance + rate t, counted from each record's start."""

    kind: ClassVar[str] = "wear"
    family: ClassVar[Family] = "time"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "J. F. Archard, J. Appl. Phys. 24 (1953) 981: wear in proportion to the way rubbed"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances that the sleeve holds soften, and impacts ring at all frequencies, more with time",
        level="from the level at which the beam leaves or meets a wall, or once its sag meets another sleeve",
        time="grows from the record's start: impacts rarer and harder",
        place="first in modes that move at the sleeve",
    )

    rate: float = parameter("r_d", "m/s", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """5, 25 and 100 % of the clearance over the longest record; without one, of the largest displacement."""
        assert scene.contact is not None
        gap = scene.contact.clearance or scene.displacement
        for share in (0.05, 0.25, 1.0):
            yield cls(scene.place, rate=share * gap / scene.duration)

    def change_contact(self, contact: Contact) -> Contact:
        """The contact whose gap grows."""
        return replace(contact, clearance_rate=contact.clearance_rate + self.rate)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"more and more through each record: the clearance grows by {1e6 * self.rate:.3g} um a second, impacts "
            "become rarer and harder"
        )
