"""A force sensor that reads too much or too little."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.arrays import FloatArray
from models.effects.protocol import Effect, Family, Scene, Signature, StructureKind, parameter


@dataclass(frozen=True)
class ForceGain(Effect):
    """The force channel reads ``gain`` times the truth."""

    kind: ClassVar[str] = "force_gain"
    family: ClassVar[Family] = "measurement"
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "ISO 7626-1:2011, calibration of transducers for mechanical mobility"
    signature: ClassVar[Signature] = Signature(
        frequency="one factor at all frequencies, without a change of phase",
        level="the same at low level; sleeves open and close at another level than the channel says",
        time="the same through the record",
        place="all channels by one factor",
    )

    gain: float = parameter("g_F", "-", lower=1e-4, upper=1e4, spread=0.5, neutral=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """5 and 25 % off to either side; none where the base is driven and there is no force channel."""
        if scene.driven_base:
            return
        for gain in (0.8, 0.95, 1.05, 1.25):
            yield cls(scene.place, gain=gain)

    def change_excitation(self, excitation: FloatArray) -> FloatArray:
        """The channel divided by the gain."""
        return excitation / self.gain

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"on all channels alike, at every frequency: the force is {1 / self.gain:.3g} times what its channel reads "
            f"(gain {self.gain:.3g})"
        )
