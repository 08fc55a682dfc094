"""A force sensor that reads too much or too little."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.arrays import FloatArray
from models.effects.protocol import Effect, Family, Scene, Signature, StructureKind, parameter
from models.errors import NotComputableError


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
        place="all channels by one factor, or all upside down",
    )

    gain: float = parameter("g_F", "-", lower=-1e4, upper=1e4, scale="linear", spread=1.0, neutral=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """5 and 25 % off to either side, upside down, and what the channels together ask for where that is far off.

        None where the base is driven and there is no force channel.
        """
        if scene.driven_base:
            return
        asked = 1.0 / scene.loudness
        far = () if ANOTHER_UNIT > asked > 1.0 / ANOTHER_UNIT else (-asked, asked)
        for gain in (0.8, 0.95, 1.05, 1.25, -1.0, *far):
            yield cls(scene.place, gain=gain)

    def change_excitation(self, excitation: FloatArray) -> FloatArray:
        """The channel divided by the gain.

        Raises:
            NotComputableError: the gain is 0.
        """
        if self.gain == 0.0:
            raise NotComputableError(
                "force_gain with gain = 0", "a channel that reads something of the force", "leave the channel out"
            )
        return excitation / self.gain

    def in_words(self) -> str:
        """When it acts and what it does."""
        turned = ", upside down" if self.gain < 0 else ""
        return (
            f"on all channels alike, at every frequency: the force is {1 / abs(self.gain):.3g} times what its channel "
            f"reads{turned} (gain {self.gain:.3g})"
        )


ANOTHER_UNIT = 1.5
"""Factor of all channels together from which on the force is tried with a gain as large, whichever its sign."""
