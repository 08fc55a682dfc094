"""A beam under tension or compression."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.structure import Structure


@dataclass(frozen=True)
class AxialLoad(Effect):
    """A force along the beam, constant over its length and fixed in direction; tension is positive."""

    kind: ClassVar[str] = "axial_load"
    family: ClassVar[Family] = "structure"
    source: ClassVar[str] = "A. Bokaian, J. Sound Vib. 126 (1988) 49 and 142 (1990) 481"
    signature: ClassVar[Signature] = Signature(
        frequency="frequencies rise under tension and fall under compression, the lowest by the largest share",
        level="the same at every level, save that the beam sags less or more",
        time="the same through the record",
        place="the whole beam; shapes hardly change",
    )

    force: float = parameter("N", "N", lower=-1e9, upper=1e9, scale="linear", spread=1e3, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """3, 15 and 60 % of the load that buckles the cantilever, in tension and in compression."""
        buckling = scene.structure.bending_stiffness * (0.5 * pi / scene.structure.length) ** 2
        for share in (0.03, -0.03, 0.15, -0.15, 0.6, -0.6):
            yield cls(scene.place, force=share * buckling)

    def change_structure(self, structure: Structure) -> Structure:
        """The beam under the load."""
        return replace(structure, axial_force=structure.axial_force + self.force)

    def in_words(self) -> str:
        """When it acts and what it does."""
        kind, way = ("tension", "up") if self.force > 0 else ("compression", "down")
        return (
            f"at every amplitude: {abs(self.force):.4g} N of {kind} shift the natural frequencies {way}, the first most"
        )
