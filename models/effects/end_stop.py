"""Stops on both sides that a motion reaches only beyond a gap: a joint that closes, a buffer, backlash."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.ports import Contact, PointLaw
from models.structure import Structure


@dataclass(frozen=True)
class EndStop(Effect):
    """F = -stiffness (|q| - gap) sign(q) where |q| is above the gap; a beam has its sleeves for that."""

    kind: ClassVar[str] = "end_stop"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("oscillator",)
    source: ClassVar[str] = (
        "J. P. Den Hartog, S. J. Mikina, Trans. ASME 54 (1932) 153: non-linear springs with clearances"
    )
    signature: ClassVar[Signature] = Signature(
        frequency="resonances move up and lean to the right; odd harmonics, and impacts ring at high frequencies",
        level="nothing up to the level at which the gap is reached; stiffer above",
        time="in bursts at both ends of the swing; alike through the record",
        place="the oscillator as a whole",
    )

    stiffness: float = parameter("k_s", "N/m", lower=0.0, neutral=0.0)
    gap: float = parameter("g", "m", lower=1e-12, spread=1.5)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Reached at 0.2, 0.5 and 0.8 of the largest displacement, at which it pushes with 10 and 100 % of the load."""
        for reached in (0.2, 0.5, 0.8):
            for share in (0.1, 1.0):
                beyond = (1.0 - reached) * scene.displacement
                yield cls(scene.place, share * scene.force / beyond, reached * scene.displacement)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Force of the stop that is reached, N, with p = (stiffness, gap)."""
        if q > p[1]:
            return -p[0] * (q - p[1])
        return -p[0] * (q + p[1]) if q < -p[1] else 0.0

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The stops at their place."""
        return (PointLaw(self.port(contact), self.force, (self.stiffness, self.gap), owner=self.label()),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"only beyond {1e3 * self.gap:.3g} mm to either side, {self.stiffness:.3g} N/m stiffer: it hardens there"
