"""A crack that is open or closed as the beam bends one way or the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.local_damage import WIDTH, softness
from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.ports import Contact, PointLaw, Port
from models.structure import Structure


@dataclass(frozen=True)
class BreathingCrack(Effect):
    """The flexibility loss width / ((1 - loss) E I) is added to the rotation there while u'' > 0.

    Open, the crack turns by theta = f M under the bending moment M; on the beam theta acts as E I theta on the
    curvature. What the model itself yields to that, s, is part of its curvature u'': M = E I (u'' - E I s theta), which
    gives the force on the curvature, a u'' / (1 + a s) with a = f (E I)^2. Stiffness-proportional damping follows: the
    kink would else be held by a dashpot as strong as the model is fine.
    """

    kind: ClassVar[str] = "breathing_crack"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    source: ClassVar[str] = "S. M. Cheng, X. J. Wu, W. Wallace, A. S. J. Swamidas, J. Sound Vib. 225 (1999) 201"
    signature: ClassVar[Signature] = Signature(
        frequency="frequencies fall by about half of what the open crack would take; even harmonics",
        level="the same at every level, or under a sag only once the motion bends the crack past it",
        time="half of each swing, while the crack is open",
        place="modes that bend at its place",
    )

    loss: float = parameter("d", "-", lower=0.0, upper=0.999, neutral=0.0)
    width: float = parameter("w", "m", lower=1e-6, fitted=False, default=WIDTH)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """A tenth, a third and two thirds of the bending stiffness lost while open."""
        for loss in (0.1, 0.33, 0.67):
            yield cls(scene.place, loss=loss)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Force on the curvature q, N m^2, with p = (f (E I)^2, eta2, the model's own flexibility s there)."""
        strain = q + p[1] * v
        return p[0] * strain / (1.0 + p[0] * p[2]) if strain > 0.0 else 0.0

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The open crack's rotation at its place."""
        stiffness = structure.bending_stiffness
        soft = softness(self.loss, self.width, stiffness) * stiffness**2
        port = Port(self.place.position, derivative=2)
        return (PointLaw(port, self.force, (soft, structure.viscosity, 0.0), owner=self.label(), yields=True),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at every amplitude, while the beam bends upwards there: {100 * self.loss:.3g} % of the bending stiffness "
            f"is lost over {1e3 * self.width:.3g} mm; frequencies fall by half of that, with even harmonics"
        )
