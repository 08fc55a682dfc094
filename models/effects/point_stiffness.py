"""A support that nobody listed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.structure import Structure


@dataclass(frozen=True)
class PointStiffness(Effect):
    """F = -stiffness q, a spring to the base that is relaxed where the beam is straight."""

    kind: ClassVar[str] = "point_stiffness"
    family: ClassVar[Family] = "structure"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "E. H. Dowell, J. Appl. Mech. 46 (1979) 206: combined dynamical systems"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances rise, the low ones most",
        level="the same at every level, save that the beam sags less onto its sleeves",
        time="the same through the record",
        place="modes that move at its place, none in a mode with a node there",
    )

    stiffness: float = parameter("k", "N/m", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Forces from 1 % to 10 times the excitation at the largest displacement, which a resonance may have raised."""
        for share in (0.01, 0.1, 1.0, 10.0):
            yield cls(scene.place, stiffness=share * scene.force / scene.displacement)

    def change_structure(self, structure: Structure) -> Structure:
        """The structure on the spring."""
        return structure.with_spring(self.place.position, self.stiffness)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"in proportion to displacement, at every amplitude: a spring of {self.stiffness:.3g} N/m to the base"
