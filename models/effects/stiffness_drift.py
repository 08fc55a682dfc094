"""A beam that grows softer or stiffer during the record."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.ports import Contact, PointLaw, Port
from models.spread import along
from models.structure import Structure

N_POINTS = 20
"""Places along the beam at which its curvature is read: the first six natural frequencies move alike to 1e-3."""


@dataclass(frozen=True)
class StiffnessDrift(Effect):
    """E I times 1 + rate t, as a temperature that rises makes it; the stiffness-proportional damping follows."""

    kind: ClassVar[str] = "stiffness_drift"
    family: ClassVar[Family] = "time"
    source: ClassVar[str] = (
        "Y. Xia, H. Hao, G. Zanardo, A. Deeks, Eng. Struct. 28 (2006) 338: temperature and frequency"
    )
    signature: ClassVar[Signature] = Signature(
        frequency="all resonances slide to one side, so that they look wide in the mean over the record",
        level="the same at every level",
        time="grows from the record's start; fits at its first samples",
        place="all along the beam",
    )

    rate: float = parameter("r", "1/s", lower=-1.0, upper=1.0, scale="linear", spread=1e-2, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """0.3 and 3 % over the longest record, to either side."""
        for change in (0.003, -0.003, 0.03, -0.03):
            yield cls(scene.place, rate=change / scene.duration)

    @staticmethod
    def force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Force on the curvature q, N m^2, with p = (rate times E I times the stretch, eta2)."""
        return -p[0] * t * (q + p[1] * v)

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """What the change of stiffness does at each Gauss point's curvature."""
        growth = self.rate * structure.bending_stiffness
        return tuple(
            PointLaw(
                Port(x, derivative=2, spread=True),
                self.force,
                (growth * stretch, structure.viscosity),
                owner=self.label(),
            )
            for x, stretch in along(structure.length, N_POINTS)
        )

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"more and more through each record: the bending stiffness changes by {100 * self.rate:+.3g} % a second, "
            "and frequencies slide by half of that"
        )
