"""A spring that hardens with the cube of the displacement."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.ports import Contact, PointLaw
from models.structure import Structure


@dataclass(frozen=True)
class CubicStiffness(Effect):
    """F = -stiffness q^3."""

    kind: ClassVar[str] = "cubic_stiffness"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve", "position")
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (1979), section 4.1"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances bend to the right; third harmonics",
        level="grows with the square of the amplitude; about a sag it is a spring at every level",
        time="follows the motion: a free decay starts high and comes down in frequency",
        place="modes that move at its place",
    )

    stiffness: float = parameter("k_3", "N/m^3", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Its force changes by 1 % to 100 times the excitation over the motion, which it may have kept far smaller."""
        steepness = scene.displacement * (scene.displacement**2 + 3.0 * scene.rest**2)
        for share in (0.01, 0.1, 1.0, 10.0, 100.0):
            yield cls(scene.place, stiffness=share * scene.force / steepness)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Spring force, N, with p = (stiffness,)."""
        return -p[0] * q * q * q

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The spring at its place."""
        return (PointLaw(self.port(contact), self.force, (self.stiffness,), owner=self.label()),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"only at large displacement, {1e-9 * self.stiffness:.3g} N at 1 mm and 8 times that at 2 mm: it hardens"
