"""A gap that is not as wide as the rig file says."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Place, PlaceKind, Scene, Signature, parameter
from models.ports import Contact


@dataclass(frozen=True)
class Clearance(Effect):
    """Contact where the penetration p = |q - offset| - clearance is positive, in place of the rig's clearance."""

    kind: ClassVar[str] = "clearance"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "S. W. Shaw, P. J. Holmes, J. Sound Vib. 90 (1983) 129: the piecewise linear oscillator"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances that the sleeve holds soften or stiffen, and impacts ring at all frequencies",
        level="from the level at which the beam leaves or meets a wall, or once its sag meets another sleeve",
        time="in bursts, as the beam passes the gap; alike through the record",
        place="all along the beam, first in modes that move at the sleeve",
    )

    clearance: float = parameter("d", "m", lower=0.0, spread=0.7)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Gaps from a third to 2.5 times the given one; where none is given, shares of the largest displacement.

        Where the motion comes to no wall, gaps in which it does, too, in the middle.
        """
        assert scene.contact is not None
        given = scene.contact.clearance
        if given == 0.0:
            yield from (cls(scene.place, clearance=share * scene.displacement) for share in (0.03, 0.1, 0.3, 0.8))
            return
        yield from (cls(scene.place, clearance=share * given) for share in (0.35, 0.6, 0.85))
        off = abs(scene.rest - scene.contact.offset)
        if given > off + scene.displacement:
            yield from (cls(scene.place, clearance=off + reached) for reached in scene.reached())
        yield from (cls(scene.place, clearance=share * given) for share in (1.2, 1.6, 2.5))

    def change_contact(self, contact: Contact) -> Contact:
        """The contact with this clearance."""
        return replace(contact, clearance=self.clearance)

    def as_sleeve_numbers(self, contact: Contact) -> Mapping[str, float]:  # noqa: ARG002
        """Its gap."""
        return {"clearance": self.clearance}

    @classmethod
    def from_sleeve_number(cls, place: Place, contact: Contact, key: str, value: float) -> Self | None:  # noqa: ARG003
        """A gap as wide."""
        return cls(place, clearance=value) if key == "clearance" else None

    def in_words(self) -> str:
        """When it acts and what it does."""
        if self.clearance == 0:
            return "at every amplitude: the sleeve holds the beam without any gap"
        return (
            f"only when the beam is more than {1e3 * self.clearance:.3g} mm off the sleeve's centre: contact "
            "begins there, not where the rig file says"
        )
