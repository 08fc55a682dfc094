"""A spring that is stiffer to one side than to the other."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.ports import Contact, PointLaw
from models.structure import Structure

Side = Literal["up", "down"]
SIDES: tuple[Side, ...] = ("up", "down")


@dataclass(frozen=True)
class QuadraticStiffness(Effect):
    """F = -stiffness q^2 where it is stiffer up, F = stiffness q^2 where it is stiffer down; a beam has its sleeves."""

    kind: ClassVar[str] = "quadratic_stiffness"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("oscillator",)
    source: ClassVar[str] = "A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (1979), section 2.3.1"
    signature: ClassVar[Signature] = Signature(
        frequency="even harmonics and a mean deflection; about a mean load the resonance shifts",
        level="grows in proportion to the amplitude; about a mean load it is a spring at every level",
        time="on one side of each swing; alike through the record",
        place="the oscillator as a whole",
    )
    options: ClassVar[Mapping[str, tuple[str, ...]]] = {"stiffer": SIDES}

    stiffness: float = parameter("k_2", "N/m^2", lower=0.0, neutral=0.0)
    stiffer: Side = "up"

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """To each side, a force that changes by 0.3, 3 and 30 % of the excitation over the motion."""
        steepness = scene.displacement * (scene.displacement + 2.0 * abs(scene.rest))
        for stiffer in SIDES:
            for share in (0.003, 0.03, 0.3):
                yield cls(scene.place, share * scene.force / steepness, stiffer)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Spring force, N, with p = (stiffness, negative where it is stiffer down,)."""
        return -p[0] * q * q

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The spring at its place."""
        signed = self.stiffness if self.stiffer == "up" else -self.stiffness
        return (PointLaw(self.port(contact), self.force, (signed,), owner=self.label()),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at larger displacement, {1e-6 * self.stiffness:.3g} N at 1 mm and 4 times that at 2 mm, stiffer "
            f"{self.stiffer} and softer the other way: a mean deflection and even harmonics that grow with the level"
        )
