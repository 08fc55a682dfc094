"""What the rig was tested with so far: the rate, the level, the band, the sensors and their noise."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.evaluate import TimeTarget
from identification.hypothesis import Hypothesis
from identification.prepare import levels
from models.arrays import FloatArray
from models.band_limit import SCORE_EDGE
from models.record import Record
from models.rig import Rig, Sensor, quantities_of


@dataclass(frozen=True, eq=False)
class Bench:
    """The records so far, as far as a next test goes by them.

    Attributes:
        rig: as its owner describes it.
        fs: of the loudest record, Hz.
        sensors: that some record holds, in the order of the rig.
        noise: (n_sensors,) standard deviation, SI, each in the loudest record that holds it.
        force_noise: the same of the excitation.
        largest: (n_sensors,) largest reading so far, SI.
        level: rms of the excitation of the loudest record, SI; 0 where no record has an excitation.
        peak: its largest value in any record.
        band: lowest and highest frequency of the loudest record's excitation, Hz.
        seconds: typical length of a record.
    """

    rig: Rig
    fs: float
    sensors: tuple[str, ...]
    noise: FloatArray
    force_noise: float
    largest: FloatArray
    level: float
    peak: float
    band: tuple[float, float]
    seconds: float

    @classmethod
    def of(cls, rig: Rig, targets: Sequence[TimeTarget]) -> "Bench":
        """What the records say.

        Args:
            rig: as its owner describes it.
            targets: time records with their noise, one at least.
        """
        loudness = levels([target.record for target in targets])
        loud = sorted(targets, key=lambda target: loudness[target.record.name])
        noise, largest = _by_sensor(loud)
        names = tuple(sensor.name for sensor in rig.sensors if sensor.name in noise)
        driven = [target for target in loud if target.record.excitation is not None]
        force = driven[-1].record.excitation if driven else None
        lengths = [target.record.duration for target in targets]
        return cls(
            rig=rig,
            fs=loud[-1].record.fs,
            sensors=names,
            noise=np.array([noise[name] for name in names]),
            force_noise=driven[-1].noise.excitation if driven else 0.0,
            largest=np.array([largest[name] for name in names]),
            level=0.0 if force is None else float(np.sqrt(np.mean(force**2))),
            peak=max(
                (float(np.abs(t.record.excitation).max()) for t in driven if t.record.excitation is not None),
                default=0.0,
            ),
            band=_band(None if force is None else driven[-1].record),
            seconds=float(np.clip(round(float(np.median(lengths))), SHORTEST, LONGEST)),
        )

    @property
    def is_pushed(self) -> bool:
        """Whether a force drives the rig, so that it can act elsewhere and a hammer can strike."""
        return self.rig.excitation is not None and self.rig.excitation.quantity == "force"

    def with_sensor(self, position: float) -> "Bench":
        """With one more sensor, of the quantity that most have and their median noise.

        Args:
            position: m from the clamp.
        """
        here = quantities_of(self.rig.sensors, self.sensors)
        quantity = max(here, key=here.count)
        alike = np.array([kind == quantity for kind in here])
        nodes = [sensor.node for sensor in self.rig.sensors if sensor.node is not None]
        if self.rig.excitation is not None and self.rig.excitation.node is not None:
            nodes.append(self.rig.excitation.node)
        added = Sensor(
            name=f"at {1000.0 * position:.0f} mm",
            node=max(nodes) + 1 if nodes else None,
            position=position,
            quantity=quantity,
        )
        return replace(
            self,
            rig=self.rig.model_copy(update={"sensors": (*self.rig.sensors, added)}),
            sensors=(*self.sensors, added.name),
            noise=np.append(self.noise, np.median(self.noise[alike])),
            largest=np.append(self.largest, self.largest[alike].max()),
        )

    def at(self, hypothesis: Hypothesis) -> Hypothesis:
        """The hypothesis about the rig of this bench, which may have a sensor more."""
        return replace(hypothesis, rig=self.rig)

    def reach(self, channels: FloatArray) -> float:
        """The largest of some readings, as a multiple of the sensor's largest so far.

        Args:
            channels: (n_sensors, N) SI.
        """
        return float(np.max(np.abs(channels).max(axis=1) / np.maximum(self.largest, np.finfo(float).tiny)))


SHORTEST, LONGEST = 2.0, 8.0
"""Seconds of a record that is proposed, whatever the records so far."""


def _by_sensor(loud: Sequence[TimeTarget]) -> tuple[dict[str, float], dict[str, float]]:
    """Noise and largest reading of each sensor; the records are sorted, the loudest last."""
    noise: dict[str, float] = {}
    largest: dict[str, float] = {}
    for target in loud:
        for name, sigma, channel in zip(
            target.record.sensors, target.noise.sensors, target.record.responses, strict=True
        ):
            noise[name] = float(sigma)
            largest[name] = max(largest.get(name, 0.0), float(np.abs(channel).max()))
    return noise, largest


def _band(record: Record | None) -> tuple[float, float]:
    """Where all but a hundredth of an excitation's power lies, Hz."""
    if record is None or record.excitation is None:
        return 0.0, 0.0
    power = np.abs(np.fft.rfft(record.excitation - record.excitation.mean())) ** 2
    share = np.cumsum(power) / max(float(power.sum()), np.finfo(float).tiny)
    low, high = (float(np.searchsorted(share, edge)) / record.duration for edge in (OUTSIDE, 1.0 - OUTSIDE))
    if high > 2.0 * LOWEST:
        low = max(LOWEST, low)
    if high < NARROW * low:
        low, high = low / NARROW, high * NARROW
    return low, min(high, SCORE_EDGE * record.fs)


OUTSIDE = 0.005
"""Share of the power below, and above, a band."""

NARROW = 1.5
"""Ratio of its edges below which a band holds one line, and is proposed wider."""

LOWEST = 2.0
"""Hz; a shaker does no less."""
