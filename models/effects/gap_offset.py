"""A sleeve whose centre is off the beam's axis, so that the gap is lopsided."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.ports import Contact


@dataclass(frozen=True)
class GapOffset(Effect):
    """The penetration is p = |q - offset| - clearance; with no clearance, a preload."""

    kind: ClassVar[str] = "gap_offset"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "F. C. Moon, S. W. Shaw, Int. J. Non-Linear Mech. 18 (1983) 465: a beam with one stop"
    signature: ClassVar[Signature] = Signature(
        frequency="even harmonics and a mean deflection; impacts from one side ring at all frequencies",
        level="from the level at which the nearer wall is met or left, or once the sag meets another sleeve",
        time="once a period, on one side; alike through the record",
        place="all along the beam, first in modes that move at the sleeve",
    )

    # A millimetre is many times any clearance: the prior knows neither side nor size.
    offset: float = parameter("u_0", "m", lower=-0.1, upper=0.1, scale="linear", spread=1e-3, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """From a quarter to ten times the clearance to either side; without one, of the largest displacement.

        Before them those that bring the upper wall into the motion, which may come to none as given, and behind them
        those that bring the lower one: the middle of all is a plain one.
        """
        assert scene.contact is not None
        gap = scene.contact.clearance or scene.displacement
        reached = scene.reached() if scene.contact.clearance else ()
        yield from (cls(scene.place, offset=scene.rest + distance - gap) for distance in reached)
        for share in (0.25, 1.0, 3.0, 10.0):
            yield cls(scene.place, offset=share * gap)
            yield cls(scene.place, offset=-share * gap)
        yield from (cls(scene.place, offset=scene.rest - distance + gap) for distance in reached)

    def change_contact(self, contact: Contact) -> Contact:
        """The contact around this centre."""
        return replace(contact, offset=self.offset)

    def in_words(self) -> str:
        """When it acts and what it does."""
        wide, tight = ("upper", "lower") if self.offset > 0 else ("lower", "upper")
        return (
            f"only near the walls, and not alike on both sides: the {wide} gap is {1e3 * abs(self.offset):.3g} mm "
            f"wider than the clearance, the {tight} one as much narrower"
        )
