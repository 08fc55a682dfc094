"""A dashpot that nobody listed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.structure import Structure


@dataclass(frozen=True)
class PointDamping(Effect):
    """F = -damping v, a dashpot to the base."""

    kind: ClassVar[str] = "point_damping"
    family: ClassVar[Family] = "structure"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "G. Oliveto, A. Santini, E. Tripodi, J. Sound Vib. 200 (1997) 327: beams with dashpots"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances lower and wider, in their place",
        level="the same at every level",
        time="free decays end sooner; alike through the record",
        place="modes that move at its place, none in a mode with a node there",
    )

    damping: float = parameter("c", "N s/m", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Forces of 1, 10 and 100 % of the excitation at the rms speed."""
        for share in (0.01, 0.1, 1.0):
            yield cls(scene.place, damping=share * scene.force / scene.velocity)

    def change_structure(self, structure: Structure) -> Structure:
        """The structure on the dashpot."""
        return structure.with_dashpot(self.place.position, self.damping)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"in proportion to velocity, at every amplitude: a dashpot of {self.damping:.3g} N s/m to the base"
