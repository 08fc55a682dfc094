"""A beam that grows softer or stiffer during the record."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, Scene, Signature, parameter
from models.structure import Structure


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

    def change_structure(self, structure: Structure) -> Structure:
        """The beam whose stiffness grows."""
        return replace(structure, stiffness_rate=structure.stiffness_rate + self.rate)

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"more and more through each record: the bending stiffness changes by {100 * self.rate:+.3g} % a second, "
            "and frequencies slide by half of that"
        )
