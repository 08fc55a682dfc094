"""A sensor that reads too much, too little, or upside down."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.arrays import FloatArray
from models.effects.protocol import Effect, Family, Measurement, PlaceKind, Scene, Signature, StructureKind, parameter


@dataclass(frozen=True)
class SensorGain(Effect):
    """The channel reads ``gain`` times the truth; -1 is an inverted sensor."""

    kind: ClassVar[str] = "sensor_gain"
    family: ClassVar[Family] = "measurement"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sensor",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "ISO 16063-21:2003, calibration of vibration transducers by comparison"
    signature: ClassVar[Signature] = Signature(
        frequency="one factor at all frequencies, without a change of phase unless the sensor is turned over",
        level="the same at every level",
        time="the same through the record",
        place="one channel only",
    )

    gain: float = parameter("g", "-", lower=-1e4, upper=1e4, scale="linear", spread=1.0, neutral=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Upside down, and too little and too much."""
        for gain in (-1.0, 0.7, 0.9, 1.15, 1.5):
            yield cls(scene.place, gain=gain)

    def change_channels(self, channels: FloatArray, measurement: Measurement) -> FloatArray:
        """The channel times the gain."""
        if self.place.sensor not in measurement.sensors:
            return channels
        changed = channels.copy()
        changed[measurement.sensors.index(self.place.sensor)] *= self.gain
        return changed

    def in_words(self) -> str:
        """When it acts and what it does."""
        turned = ", upside down" if self.gain < 0 else ""
        return f"on one channel only, at every amplitude: it reads {abs(self.gain):.3g} times the truth{turned}"
