"""Hysteresis: a spring that slips, and remembers where."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.ports import Contact, PointLaw
from models.structure import Structure


@dataclass(frozen=True)
class BoucWen(Effect):
    """F = -force z, dz/dt = (v / yield_displacement) (1 - |z|^exponent (0.5 sign(z v) + 0.5)), z = 0 at rest."""

    kind: ClassVar[str] = "bouc_wen"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "Y.-K. Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249, with A = 1 and beta = gamma = 0.5"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances stiff and sharp, then lower and wide, then as without it; odd harmonics",
        level="a spring at low level, most loss where the motion passes the yield displacement, little far above",
        time="depends on the last reversal and not on speed; a record can end off its start",
        place="modes that move at its place",
    )

    force: float = parameter("F_h", "N", lower=0.0, neutral=0.0)
    yield_displacement: float = parameter("u_y", "m", lower=1e-12, spread=1.5)
    exponent: float = parameter("n", "-", lower=1.0, upper=4.0, spread=0.4)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """3 and 30 % of the excitation, yielding at 0.1, 0.5 and 2 times the largest displacement, sharp or not."""
        for share in (0.03, 0.3):
            for ratio, exponent in ((0.1, 1.0), (0.5, 1.0), (0.5, 2.0), (2.0, 1.0)):
                yield cls(scene.place, share * scene.force, ratio * scene.displacement, exponent)

    @staticmethod
    def restoring_force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Force, N, with p = (force, yield_displacement, exponent)."""
        return -p[0] * z

    @staticmethod
    def rate(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """dz/dt, 1/s, with p = (force, yield_displacement, exponent)."""
        loading = z * v > 0.0
        return v / p[1] * (1.0 - abs(z) ** p[2] if loading else 1.0)

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The hysteretic spring at its place."""
        parameters = (self.force, self.yield_displacement, self.exponent)
        return (PointLaw(self.port(contact), self.restoring_force, parameters, self.rate, self.label()),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"a loop that does not close at zero speed: a spring up to about {1e3 * self.yield_displacement:.3g} mm "
            f"after each reversal, then slip at {self.force:.3g} N, at any speed"
        )
