"""A mass that nobody listed, moving with the beam."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.structure import Structure


@dataclass(frozen=True)
class PointMass(Effect):
    """F = -mass (acceleration + gravity), with the absolute acceleration."""

    kind: ClassVar[str] = "point_mass"
    family: ClassVar[Family] = "structure"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "L. Meirovitch, Fundamentals of Vibrations (2001), section 8.6"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances fall, each by a share that its motion there decides, whatever its frequency",
        level="the same at every level, save that the beam sags more onto its sleeves",
        time="the same through the record",
        place="modes that move at its place, none in a mode with a node there",
    )

    mass: float = parameter("m", "kg", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """1, 5 and 25 % of the structure's mass."""
        total = scene.structure.line_mass * (scene.structure.length or 1.0)
        for share in (0.01, 0.05, 0.25):
            yield cls(scene.place, mass=share * total)

    def change_structure(self, structure: Structure) -> Structure:
        """The structure carrying the mass."""
        return structure.with_mass(self.place.position, self.mass)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"in proportion to acceleration, at every amplitude: {self.mass:.3g} kg more that move along"
