"""A contact whose damping grows with penetration, so that its force neither jumps nor sticks."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.contact.hunt_crossley import HuntCrossley as HuntCrossleyLaw
from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.ports import Contact


@dataclass(frozen=True)
class HuntCrossley(Effect):
    """N = k p (1 + 3/2 dissipation dp/dt), never below 0, in place of spring and dashpot; k is the present law's."""

    kind: ClassVar[str] = "hunt_crossley"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = HuntCrossleyLaw.source
    signature: ClassVar[Signature] = Signature(
        frequency="resonances that the sleeve holds are wider or sharper; less ringing than a dashpot that jumps",
        level="little in a light touch; the loss grows with depth and speed of the impacts",
        time="while the sleeve is closed; the force starts from 0 without a jump",
        place="modes that move at the sleeve",
    )

    dissipation: float = parameter("alpha", "s/m", lower=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Damping at the largest penetration of 0.1, 1 and 10 times the present law's, or of the spring's force."""
        assert scene.contact is not None
        law = scene.contact.law
        depth = scene.penetration or scene.force / law.stiffness
        spring = law.elastic(depth)
        damping = law.damping_at(depth, scene.velocity) or spring / scene.velocity
        for ratio in (0.1, 1.0, 10.0):
            yield cls(scene.place, dissipation=ratio * damping / (1.5 * spring))

    def change_contact(self, contact: Contact) -> Contact:
        """The contact with the Hunt-Crossley law."""
        return replace(contact, law=HuntCrossleyLaw(contact.law.stiffness, self.dissipation))

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            "only in contact, and more the deeper: an impact at v gives back about the share 1 - "
            f"{self.dissipation:.3g} v of its speed (v in m/s, small)"
        )
