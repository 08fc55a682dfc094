"""The resistance of the medium around the beam at speed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.ports import Contact, PointLaw, Port
from models.spread import along
from models.structure import Structure

N_POINTS = 16
"""Places along the beam that stand for the spread force: what the first four modes lose is within 1 %."""


@dataclass(frozen=True)
class QuadraticDrag(Effect):
    """A force per length of -coefficient |v| v all along the beam."""

    kind: ClassVar[str] = "quadratic_drag"
    family: ClassVar[Family] = "point force"
    source: ClassVar[str] = "J. R. Morison et al., J. Petrol. Technol. 2 (1950) 149: the drag term"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances lower and wider with level, the strongest most; odd harmonics",
        level="damping grows in proportion to the speed; nothing at low level",
        time="a free decay is fast first and then as without it",
        place="most where the beam moves most: the free end",
    )

    coefficient: float = parameter("c_2", "N s^2/m^3", lower=0.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """1, 10 and 100 % of the excitation, were the whole beam as fast as its tip."""
        for share in (0.01, 0.1, 1.0):
            yield cls(scene.place, coefficient=share * scene.force / (scene.velocity**2 * scene.structure.length))

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Drag of a stretch, N, with p = (coefficient times its length,)."""
        return -p[0] * abs(v) * v

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The drag of each stretch at its Gauss point."""
        return tuple(
            PointLaw(Port(x, spread=True), self.force, (self.coefficient * stretch,), owner=self.label())
            for x, stretch in along(structure.length, N_POINTS)
        )

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at high speed, most where the beam is fast: {self.coefficient:.3g} N on each metre at 1 m/s and 4 times "
            "that at 2 m/s, so that damping grows with the level"
        )
