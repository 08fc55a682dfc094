"""A stretch of beam that has lost bending stiffness."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.structure import Hinge, Structure

WIDTH = 0.06
"""Of the stretch, m, where the file does not say: it cannot be told from the loss."""


@dataclass(frozen=True)
class LocalDamage(Effect):
    """The stretch adds the flexibility loss width / ((1 - loss) E I) to the rotation at its centre."""

    kind: ClassVar[str] = "local_damage"
    family: ClassVar[Family] = "structure"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    source: ClassVar[str] = "P. F. Rizos, N. Aspragathos, A. D. Dimarogonas, J. Sound Vib. 138 (1990) 381"
    signature: ClassVar[Signature] = Signature(
        frequency="frequencies fall, most in modes that bend at its place, none where a mode does not bend",
        level="the same at every level, save that the beam sags more",
        time="the same through the record",
        place="shapes have a kink at its place",
    )

    loss: float = parameter("d", "-", lower=0.0, upper=0.999, neutral=0.0)
    width: float = parameter("w", "m", lower=1e-6, fitted=False, default=WIDTH)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """A tenth, a third and two thirds of the bending stiffness lost."""
        for loss in (0.1, 0.33, 0.67):
            yield cls(scene.place, loss=loss)

    def change_structure(self, structure: Structure) -> Structure:
        """The beam with the softer stretch, as a hinge with a spring."""
        assert self.place.position is not None
        hinge = Hinge(self.place.position, softness(self.loss, self.width, structure.bending_stiffness))
        return replace(structure, hinges=(*structure.hinges, hinge)) if self.loss > 0.0 else structure

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at every amplitude: {100 * self.loss:.3g} % of the bending stiffness is lost over "
            f"{1e3 * self.width:.3g} mm, and natural frequencies fall, most in modes that bend there"
        )


def softness(loss: float, width: float, bending_stiffness: float) -> float:
    """Extra rotation per moment of a stretch, rad/(N m).

    Args:
        loss: share of the bending stiffness that is lost.
        width: of the stretch, m.
        bending_stiffness: E I of the sound beam, N m^2.
    """
    return loss * width / ((1.0 - loss) * bending_stiffness)
