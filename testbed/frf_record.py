"""FRFs of one record, level by level, with or without the rig it belongs to."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from identification.frf import FrfEstimate, estimate_frf, estimate_frf_per_level
from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from models.record import Record
from models.rig import Rig
from testbed.compare import SEGMENTS_PER_RECORD
from testbed.quantities import frf_unit, ratio_unit, unit_of
from testbed.records.formats import read_file
from testbed.records.read import read_record
from testbed.records.recording import RawChannel, Recording
from testbed.records.samples import checked, is_dead
from testbed.records.time_base import sampling_rate
from testbed.records.units import Measured, quantity_of, si_factor


@dataclass(frozen=True, eq=False)
class Channels:
    """A record as far as its FRFs need it.

    Attributes:
        name: of the record.
        fs: Hz.
        excitation: (N,) SI.
        excitation_unit: SI.
        sensors: names.
        units: of each sensor's FRF.
        responses: (n_sensors, N) SI.
        findings: what was left out or assumed.
    """

    name: str
    fs: float
    excitation: FloatArray
    excitation_unit: str
    sensors: tuple[str, ...]
    units: tuple[str, ...]
    responses: FloatArray
    findings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Levels:
    """The FRFs of a record at each of its levels, the strongest first."""

    channels: Channels
    estimates: tuple[FrfEstimate, ...]


def channels_with_rig(path: Path, rig: Rig, without: Sequence[str] = ()) -> Channels:
    """The channels that a rig's sensors have in a record; dead and implausible ones are left out with a finding.

    Args:
        path: the record.
        rig: whose sensors they are.
        without: channels to leave out.

    Raises:
        InputError: a file that cannot be used, or one without excitation.
    """
    record = read_record(path, rig, without=without, strict=False)
    if not isinstance(record, Record):
        raise _no_time_record(path)
    if record.excitation is None or rig.excitation is None:
        raise _no_excitation(path, [sensor.name for sensor in rig.sensors])
    units = tuple(frf_unit(rig, name) for name in record.sensors)
    unit = unit_of(rig.excitation.quantity)
    return Channels(
        record.name, record.fs, record.excitation, unit, record.sensors, units, record.responses, record.findings
    )


def channels_of_file(path: Path, excitation: str | None, without: Sequence[str] = ()) -> Channels:
    """The channels of a record by the file's own names and units.

    Args:
        path: the record.
        excitation: name of the excitation's channel; by default the only force.
        without: channels to leave out.

    Raises:
        InputError: a file that cannot be used, no excitation, or a channel whose quantity the file does not tell.
    """
    recording = read_file(path)
    if not isinstance(recording, Recording):
        raise _no_time_record(path)
    channels = [channel for channel in recording.channels if _name(channel) not in without]
    driving = _driving(path, channels, excitation)
    others = [channel for channel in channels if channel is not driving]
    force, below = _in_si(recording, driving)
    signals = {_name(channel): _in_si(recording, channel) for channel in others}
    alive = {name: signal for name, signal in signals.items() if not is_dead(signal[0])}
    if not alive:
        raise InputError(f"{path.name}: no channel moves", "an FRF needs a response", "check the sensors")
    findings = [f"{path.name}: channel {name} is dead; left out" for name in signals if name not in alive]
    return Channels(
        path.name,
        sampling_rate(recording, len(force)),
        force,
        below,
        tuple(alive),
        tuple(ratio_unit(above, below) for _, above in alive.values()),
        np.stack([samples for samples, _ in alive.values()]),
        (*recording.remarks, *findings),
    )


def levels_of(channels: Channels, resolution: float | None = None) -> Levels:
    """H1, H2 and coherence at each level; of the whole record where no level fills two segments.

    Args:
        channels: of the record.
        resolution: spacing of the lines, Hz, where the excitation does not repeat; an eighth of the record by default.

    Raises:
        InputError: a resolution that the record is too short for.
    """
    duration = channels.responses.shape[1] / channels.fs
    lines = SEGMENTS_PER_RECORD / duration if resolution is None else resolution
    signals = (channels.excitation, channels.responses, channels.fs)
    estimates = estimate_frf_per_level(*signals, resolution=lines)
    return Levels(channels, estimates or (estimate_frf(*signals, resolution=lines),))


def levels_json(levels: Levels) -> dict[str, Any]:
    """The content of ``frf.json``.

    Args:
        levels: finished.
    """
    channels = levels.channels
    return {
        "record": channels.name,
        "excitation_unit": channels.excitation_unit,
        "levels": [
            {
                "level": estimate.level,
                "averages": estimate.n_averages,
                "frequency": estimate.frequency,
                "channels": [
                    {
                        "sensor": name,
                        "unit": channels.units[i],
                        "h1": _parts(estimate.h1[i]),
                        "h2": _parts(estimate.h2[i]),
                        "coherence": estimate.coherence[i],
                    }
                    for i, name in enumerate(channels.sensors)
                ],
            }
            for estimate in levels.estimates
        ],
        "findings": list(channels.findings),
    }


def _parts(values: ComplexArray) -> dict[str, FloatArray]:
    return {"real": values.real, "imag": values.imag}


def _name(channel: RawChannel) -> str:
    return channel.tag.shown


def _driving(path: Path, channels: Sequence[RawChannel], name: str | None) -> RawChannel:
    """The channel of that name or node, or the only force."""
    if name is not None:
        called = [c for c in channels if name in (c.tag.name, str(c.tag.node), _name(c))]
    else:
        called = [c for c in channels if quantity_of(c.tag) == "force"]
    if len(called) == 1:
        return called[0]
    raise _no_excitation(path, [_name(channel) for channel in channels])


def _in_si(recording: Recording, channel: RawChannel) -> tuple[FloatArray, str]:
    """The samples in SI units, and the unit."""
    tag, where = channel.tag, f"{recording.file}: channel {_name(channel)}"
    quantity = quantity_of(tag)
    if quantity is None:
        raise InputError(
            f'{where} has the unit "{tag.unit or ""}"',
            "without its rig, a record's own units tell what its channels measure",
            f"name the rig with --rig, or leave the channel out with --without {_name(channel)!r}",
        )
    factor, _ = si_factor(tag, Measured(_name(channel), quantity, None), recording.file, recording.unlabelled)
    return checked(channel.data, where) * (tag.sign * factor), unit_of(quantity)


def _no_time_record(path: Path) -> InputError:
    return InputError(
        f"{path.name}: holds FRFs or mode shapes", "FRFs are estimated from a time record", "name a time record"
    )


def _no_excitation(path: Path, names: Sequence[str]) -> InputError:
    return InputError(
        f"{path.name}: no single excitation among its channels ({', '.join(names)})",
        "an FRF is the response per unit of one measured excitation, the only force unless another is named",
        "name the channel with --excitation, or the rig with --rig",
    )
