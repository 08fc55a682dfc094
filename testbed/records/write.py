"""``write_record``: a time record as a file of any format, written whole or not at all."""

import os
from pathlib import Path

from models.errors import InputError
from models.record import Record
from models.rig import Rig
from testbed.records.formats import format_of
from testbed.records.recording import RawChannel, Recording, Tag
from testbed.records.units import SI_UNITS, Measured


def write_record(record: Record, rig: Rig, path: Path | str) -> None:
    """Write a time record in SI units and double precision; UFF in its binary form.

    Args:
        record: whose sensors the rig has.
        rig: for names, nodes and quantities.
        path: its suffix chooses the format; an existing file is replaced.

    Raises:
        InputError: an unknown suffix, fewer than two samples, what the format cannot hold, a path nobody may write.
    """
    path = Path(path)
    form = format_of(path)
    recording = _recording(record, rig, path)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        form.write(recording, part)
        part.replace(path)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}", "a record can be written", "check the path") from error
    finally:
        part.unlink(missing_ok=True)


def _recording(record: Record, rig: Rig, path: Path) -> Recording:
    if record.n_samples < 2:
        raise InputError(f"{path.name}: {record.n_samples} samples", "a record has two or more", "record for longer")
    channels = []
    if record.excitation is not None:
        channels.append(RawChannel(_excitation_tag(record, rig, path), record.excitation))
    for name, samples in zip(record.sensors, record.responses, strict=True):
        try:
            sensor = rig.sensor(name)
        except KeyError:
            known = ", ".join(sensor.name for sensor in rig.sensors)
            raise InputError(
                f"{path.name}: channel {name}", f"the rig's sensors are {known}", "write with the rig of the record"
            ) from None
        channels.append(RawChannel(_tag(Measured.of(sensor), sensor.node), samples))
    position = record.excitation_position if record.excitation is not None else None
    return Recording(path.name, tuple(channels), fs=record.fs, excitation_position=position)


def _excitation_tag(record: Record, rig: Rig, path: Path) -> Tag:
    if rig.excitation is None:
        raise InputError(
            f"{path.name}: an excitation channel", "the rig has no excitation", "add [excitation] to the rig file"
        )
    node = rig.excitation.node
    if record.excitation_position is not None:
        node = node_at(rig, record.excitation_position)
    return _tag(Measured.of(rig.excitation), node)


def node_at(rig: Rig, position: float) -> int | None:
    """Node of the sensor at a place, by which a UFF file says where a force acts; None where there is none.

    Args:
        rig: with the sensors.
        position: m.
    """
    return next((sensor.node for sensor in rig.sensors if sensor.position == position), None)


def _tag(measured: Measured, node: int | None) -> Tag:
    return Tag(measured.name, node, unit=SI_UNITS[measured.quantity], quantity=measured.quantity)
