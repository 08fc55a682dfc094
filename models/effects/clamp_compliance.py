"""A clamp that turns."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.structure import Structure

BUILT_IN = 1e6
"""Times E I / L; a stiffer clamp counts as this, 2e-6 below the built-in end's natural frequencies, because the assumed
shapes lose their digits to a much stiffer one."""


@dataclass(frozen=True)
class ClampCompliance(Effect):
    """The moment at the clamp is rotational_stiffness times the slope there, in place of a slope of 0."""

    kind: ClassVar[str] = "clamp_compliance"
    family: ClassVar[Family] = "structure"
    source: ClassVar[str] = "M. J. Maurizi, R. E. Rossi, J. A. Reyes, J. Sound Vib. 48 (1976) 565"
    signature: ClassVar[Signature] = Signature(
        frequency="all natural frequencies without sleeves fall by about the same share; damping stays",
        level="the same at every level",
        time="the same through the record",
        place="the whole beam, as a turn at the clamp",
    )

    rotational_stiffness: float = parameter("k_r", "N m/rad", lower=1e-6, neutral=inf)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """10, 100 and 1000 times E I / L: natural frequencies about 16, 2 and 0.2 % lower."""
        beam = scene.structure.bending_stiffness / scene.structure.length
        for ratio in (10.0, 100.0, 1000.0):
            yield cls(scene.place, rotational_stiffness=ratio * beam)

    def change_structure(self, structure: Structure) -> Structure:
        """The beam on the rotational spring."""
        stiffest = BUILT_IN * structure.bending_stiffness / structure.length
        return replace(structure, clamp_stiffness=min(self.rotational_stiffness, stiffest))

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at every amplitude: the clamp turns by {1e3 / self.rotational_stiffness:.3g} mrad under 1 N m, and "
            "all natural frequencies fall by about the same share"
        )
