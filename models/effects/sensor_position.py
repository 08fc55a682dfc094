"""A sensor that sits elsewhere than the rig file says."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Self

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.rig import Sensor
from models.structure import Structure


@dataclass(frozen=True)
class SensorPosition(Effect):
    """The sensor reads the motion at ``position``; beyond the free end, of the free end."""

    kind: ClassVar[str] = "sensor_position"
    family: ClassVar[Family] = "measurement"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sensor",)
    source: ClassVar[str] = "D. J. Ewins, Modal Testing (2000), section 3.10: errors of where and which way"
    signature: ClassVar[Signature] = Signature(
        frequency="a factor that changes from mode to mode, and its sign between two nodes",
        level="the same at every level",
        time="the same through the record",
        place="one channel only",
    )

    position: float = parameter("x_s", "m", lower=0.0, scale="linear", spread=0.3, on_beam=True)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """3 and 12 % of the length to either side of where it should be."""
        length = scene.structure.length
        for share in (0.03, -0.03, 0.12, -0.12):
            position = (scene.sensor_position or 0.0) + share * length
            if 0.0 < position <= length:
                yield cls(scene.place, position=position)

    def change_sensors(self, sensors: tuple[Sensor, ...], structure: Structure) -> tuple[Sensor, ...]:
        """The sensors with this one where it sits."""
        there = min(self.position, structure.length)
        return tuple(
            sensor.model_copy(update={"position": there}) if sensor.name == self.place.sensor else sensor
            for sensor in sensors
        )

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"on one channel only, by another factor in each mode: the sensor reads the motion {self.position:.4g} m "
            "from the clamp"
        )
