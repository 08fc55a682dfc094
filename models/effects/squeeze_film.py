"""Grease in the gap of a sleeve that resists being squeezed out."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.ports import Contact, PointLaw
from models.structure import Structure

WALL = 0.95
"""Share of the clearance beyond which the film grows no stiffer."""


@dataclass(frozen=True)
class SqueezeFilm(Effect):
    """F = -damping v / (1 - r^2)^(3/2) with r = min(|q - offset| / clearance, 0.95), besides the contact."""

    kind: ClassVar[str] = "squeeze_film"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "J. F. Booker, CRC Handbook of Lubrication II (1983) 121: full film, long bearing"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances that move the sleeve's grease are wider and lower, in their place while motion is small",
        level="at every level, within the gap too; most where the beam is close to a wall",
        time="always, and free decays end sooner; alike through the record",
        place="modes that move at the sleeve",
    )

    damping: float = parameter("c_f", "N s/m", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Forces of 1, 10 and 100 % of the excitation at the place's rms speed."""
        for share in (0.01, 0.1, 1.0):
            yield cls(scene.place, damping=share * scene.force / scene.velocity)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Film force, N, with p = (damping, clearance, offset)."""
        r = WALL if abs(q - p[2]) >= WALL * p[1] else abs(q - p[2]) / p[1]
        room = 1.0 - r * r
        return -p[0] * v / (room * sqrt(room))

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The film at its sleeve."""
        assert contact is not None
        parameters = (self.damping, contact.clearance, contact.offset)
        return (PointLaw(self.port(contact), self.force, parameters, owner=self.label()),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"always, {self.damping:.3g} N s/m amid the gap and up to 33 times that near the wall, in proportion to "
            "speed: grease squeezed out of the gap"
        )
