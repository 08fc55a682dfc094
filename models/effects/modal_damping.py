"""A structure that loses more or less energy than the rig file says."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, StructureKind, parameter
from models.structure import Structure


@dataclass(frozen=True)
class ModalDamping(Effect):
    """Every mode's damping ratio, of the structure without sleeves, times ``ratio``.

    On an oscillator its one mode; there it is told from a ``point_damping`` only by a ratio below 1.
    """

    kind: ClassVar[str] = "modal_damping"
    family: ClassVar[Family] = "structure"
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "T. K. Caughey, J. Appl. Mech. 27 (1960) 269: classical normal modes in damped systems"
    signature: ClassVar[Signature] = Signature(
        frequency="every resonance of the beam is too high or too low by the same factor, in its place",
        level="the same at every level",
        time="free decays end sooner or later; alike through the record",
        place="all along the beam",
    )

    ratio: float = parameter("r_zeta", "-", lower=0.0, upper=1e3, spread=1.0, neutral=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """From a third to three times the given damping, and ten times."""
        for ratio in (0.3, 3.0, 10.0):
            yield cls(scene.place, ratio=ratio)

    def change_structure(self, structure: Structure) -> Structure:
        """The structure with its own damping multiplied."""
        return replace(structure, damping_scale=self.ratio * structure.damping_scale)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"at every amplitude, at the resonances: all damping ratios are {self.ratio:.3g} times the rig file's"
