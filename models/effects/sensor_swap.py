"""Two sensors whose cables or names were exchanged."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.arrays import FloatArray
from models.effects.protocol import Effect, Family, Measurement, PlaceKind, Scene, Signature


@dataclass(frozen=True)
class SensorSwap(Effect):
    """Each of two channels reads what the other should; a record that holds one of them only is left as it is."""

    kind: ClassVar[str] = "sensor_swap"
    family: ClassVar[Family] = "measurement"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sensor pair",)
    source: ClassVar[str] = "D. J. Ewins, Modal Testing (2000), section 3.10: errors of where and which way"
    signature: ClassVar[Signature] = Signature(
        frequency="a factor that changes from mode to mode, on one channel the inverse of that on the other",
        level="the same at every level",
        time="the same through the record",
        place="two channels; each agrees with the model of the other",
    )

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """There is one way to exchange two."""
        yield cls(scene.place)

    def change_channels(self, channels: FloatArray, measurement: Measurement) -> FloatArray:
        """The two channels exchanged."""
        pair = [name for name in (self.place.sensor, self.place.other) if name in measurement.sensors]
        if len(pair) < 2:
            return channels
        here, there = (measurement.sensors.index(name) for name in pair if name is not None)
        changed = channels.copy()
        changed[[here, there]] = channels[[there, here]]
        return changed

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"on two channels only, at every amplitude: {self.place.sensor} and {self.place.other} are exchanged"
