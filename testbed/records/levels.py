"""How loud a record's channels are in SI, and the unit by which each was read: where a wrong label shows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.rig import Rig
from testbed.records.matching import match
from testbed.records.recording import RawChannel, Recording
from testbed.records.units import SI_UNITS, Measured, si_factor


@dataclass(frozen=True)
class Level:
    """One channel as it was read.

    Attributes:
        record: the file's name.
        channel: the rig's name for it.
        label: unit in the file, or None where it has none.
        factor: from the file's numbers to SI.
        rms: SI, the mean included.
        peak: SI, of the largest sample.
        unit: SI unit of both.
    """

    record: str
    channel: str
    label: str | None
    factor: float
    rms: float
    peak: float
    unit: str


def levels_of(recording: Recording, rig: Rig, without: Sequence[str] = ()) -> tuple[Level, ...]:
    """The excitation's level and each sensor's.

    Args:
        recording: what a file holds.
        rig: whose channels they are.
        without: names to leave out.

    Raises:
        InputError: channels that ``read_record`` refuses.
    """
    matched = match(recording, rig, without)
    found = []
    if matched.excitation is not None and rig.excitation is not None:
        found.append(_level(recording, matched.excitation, Measured.of(rig.excitation)))
    found += [_level(recording, channel, Measured.of(rig.sensor(name))) for name, channel in matched.sensors.items()]
    return tuple(found)


def _level(recording: Recording, channel: RawChannel, measured: Measured) -> Level:
    factor, _ = si_factor(channel.tag, measured, recording.file, recording.unlabelled)
    samples = factor * channel.data.astype(float)
    return Level(
        recording.file,
        measured.name,
        channel.tag.unit,
        factor,
        rms=float(np.sqrt(np.mean(samples**2))),
        peak=float(np.abs(samples).max()),
        unit=SI_UNITS[measured.quantity],
    )
