"""Two sensors whose cables or names were exchanged."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature
from models.rig import Sensor
from models.structure import Structure


@dataclass(frozen=True)
class SensorSwap(Effect):
    """Each of two sensors sits, and reads, where and what the other should."""

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

    def change_sensors(self, sensors: tuple[Sensor, ...], structure: Structure) -> tuple[Sensor, ...]:  # noqa: ARG002
        """Each of the two under the other's name."""
        other = {self.place.sensor: self.place.other, self.place.other: self.place.sensor}
        by_name = {sensor.name: sensor for sensor in sensors}
        return tuple(
            by_name[name].model_copy(update={"name": sensor.name}) if (name := other.get(sensor.name)) else sensor
            for sensor in sensors
        )

    def in_words(self) -> str:
        """When it acts and what it does."""
        return f"on two channels only, at every amplitude: {self.place.sensor} and {self.place.other} are exchanged"
