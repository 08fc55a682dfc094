"""Damping that is the same in all modes, in place of Rayleigh's."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.structure import Structure


@dataclass(frozen=True)
class StructuralDamping(Effect):
    """Every mode of the beam without sleeves has the damping ratio loss_factor / 2, in place of rayleigh_damping."""

    kind: ClassVar[str] = "structural_damping"
    family: ClassVar[Family] = "structure"
    source: ClassVar[str] = "R. E. D. Bishop, J. R. Aero. Soc. 59 (1955) 738: hysteretic damping"
    signature: ClassVar[Signature] = Signature(
        frequency="damping ratios are alike at all frequencies, in place of their trend; resonances in their place",
        level="the same at every level",
        time="free decays end sooner or later; alike through the record",
        place="all along the beam",
    )

    loss_factor: float = parameter("eta", "-", lower=0.0, upper=2.0, spread=1.5)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Damping ratios of 0.1, 0.5 and 2.5 %."""
        for loss_factor in (0.002, 0.01, 0.05):
            yield cls(scene.place, loss_factor=loss_factor)

    def change_structure(self, structure: Structure) -> Structure:
        """The beam of that material."""
        return replace(structure, loss_factor=self.loss_factor)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at every amplitude, at the resonances: all modes of the beam have a damping ratio of "
            f"{50 * self.loss_factor:.3g} %, whatever their frequency"
        )
