"""Dry friction."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import tanh
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.ports import Contact, Frame, PointLaw
from models.structure import Structure


@dataclass(frozen=True)
class CoulombFriction(Effect):
    """F = -friction_force tanh(v / slip_velocity), with v relative to the base or to the ground."""

    kind: ClassVar[str] = "coulomb_friction"
    family: ClassVar[Family] = "point force"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve", "position")
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "S. Andersson, A. Soderberg, S. Bjorklund, Tribol. Int. 40 (2007) 580, section 4"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances low and wide, as if held there, then higher and sharper; odd harmonics",
        level="most at low level; its share falls as the level grows",
        time="a free decay ends on a straight line; alike through the record",
        place="modes that move at its place",
    )
    options: ClassVar[Mapping[str, tuple[str, ...]]] = {"against": ("base", "ground")}

    friction_force: float = parameter("F_c", "N", lower=0.0, neutral=0.0)
    slip_velocity: float = parameter("v_s", "m/s", lower=1e-9)
    against: Frame = "base"

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """3 and 30 % of the excitation, slipping from 2 and 30 % of the rms speed; the ground where the base moves."""
        frames: dict[Frame, float] = {"base": scene.velocity}
        if scene.driven_base:
            frames["ground"] = scene.ground_velocity
        for against, speed in frames.items():
            for share in (0.03, 0.3):
                for slip in (0.02, 0.3):
                    yield cls(scene.place, share * scene.force, slip * speed, against)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Friction, N, with p = (friction_force, slip_velocity)."""
        return -p[0] * tanh(v / p[1])

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """The friction at its place, against base or ground."""
        port = self.port(contact, self.against)
        return (PointLaw(port, self.force, (self.friction_force, self.slip_velocity), owner=self.label()),)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"against the motion relative to the {self.against}, {self.friction_force:.3g} N at any amplitude once "
            f"|v| is well above {1e3 * self.slip_velocity:.3g} mm/s: small motion is damped most"
        )
