"""A channel that is late."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.arrays import FloatArray
from models.band_limit import delayed
from models.effects.protocol import Effect, Family, Measurement, PlaceKind, Scene, Signature, StructureKind, parameter


@dataclass(frozen=True)
class SensorDelay(Effect):
    """The channel reads now what was true ``delay`` ago."""

    kind: ClassVar[str] = "sensor_delay"
    family: ClassVar[Family] = "measurement"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sensor",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "T. I. Laakso et al., IEEE Signal Process. Mag. 13 (1996) 30: fractional delays"
    signature: ClassVar[Signature] = Signature(
        frequency="phase that falls in proportion to frequency, the amplitude stays: most at high frequencies",
        level="the same at every level",
        time="the same through the record",
        place="one channel only",
    )

    delay: float = parameter("tau", "s", lower=0.0, spread=1.5, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """2, 10 and 50 % of the time in which the motion turns by 1 rad, and what the channel itself tells."""
        turn = scene.displacement / scene.velocity
        told = (scene.lag,) if scene.lag > 0.0 else ()
        for delay in (0.02 * turn, 0.1 * turn, *told, 0.5 * turn):  # of a row, a quick look takes the middle
            yield cls(scene.place, delay=delay)

    def change_channels(self, channels: FloatArray, measurement: Measurement) -> FloatArray:
        """The channel later."""
        if self.place.sensor not in measurement.sensors:
            return channels
        changed = channels.copy()
        row = measurement.sensors.index(self.place.sensor)
        changed[row] = delayed(channels[row], self.delay * measurement.fs)
        return changed

    def looks_back(self) -> float:
        """By as much as it is late."""
        return self.delay

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"on one channel only, the more the higher the frequency: it is {1e3 * self.delay:.3g} ms late, "
            f"{0.36 * 1e3 * self.delay:.3g} degrees for each Hz"
        )
