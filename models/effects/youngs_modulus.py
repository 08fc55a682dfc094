"""A material that is stiffer or softer than the rig file says."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import sqrt
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.structure import Structure


@dataclass(frozen=True)
class YoungsModulus(Effect):
    """E I times ``ratio``; the stiffness-proportional damping follows."""

    kind: ClassVar[str] = "youngs_modulus"
    family: ClassVar[Family] = "structure"
    source: ClassVar[str] = "J. E. Mottershead, M. I. Friswell, J. Sound Vib. 167 (1993) 347: model updating, a survey"
    signature: ClassVar[Signature] = Signature(
        frequency="all natural frequencies without sleeves move by the same share, the root of the ratio",
        level="the same at every level, save that the beam sags less or more",
        time="the same through the record",
        place="all along the beam; shapes without sleeves stay",
    )

    ratio: float = parameter("r_E", "-", lower=1e-2, upper=1e2, spread=0.3, neutral=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """3 and 15 % to either side: natural frequencies 1.5 and 8 % off."""
        for ratio in (0.85, 0.97, 1.03, 1.15):
            yield cls(scene.place, ratio=ratio)

    def change_structure(self, structure: Structure) -> Structure:
        """The beam of that material."""
        return replace(structure, bending_stiffness=self.ratio * structure.bending_stiffness)

    def in_words(self) -> str:
        """When it acts and what it does."""
        shift = 100 * (sqrt(self.ratio) - 1)
        return f"at every amplitude: all natural frequencies of the beam without sleeves move by {shift:+.3g} %"
