"""The channels of a time record, with or without the rig it belongs to."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError
from models.record import Record, is_dead
from models.rig import Rig, quantities_of
from testbed.records.dying import undying
from testbed.records.formats import read_file
from testbed.records.matching import not_left_out
from testbed.records.read import read_record
from testbed.records.recording import RawChannel, Recording
from testbed.records.samples import checked
from testbed.records.time_base import sampling_rate
from testbed.records.units import Measured, quantity_of, si_factor


@dataclass(frozen=True, eq=False)
class Channels:
    """A record as far as it can be read without a model.

    Attributes:
        name: of the record.
        fs: Hz.
        excitation: (N,) SI, or None where nothing was measured that drives the rig.
        excitation_quantity: force or a motion of the base; empty where there is none.
        sensors: names.
        quantities: of each sensor.
        responses: (n_sensors, N) SI.
        findings: what was left out or assumed.
    """

    name: str
    fs: float
    excitation: FloatArray | None
    excitation_quantity: str
    sensors: tuple[str, ...]
    quantities: tuple[str, ...]
    responses: FloatArray
    findings: tuple[str, ...]

    def only(self, names: Sequence[str]) -> "Channels":
        """These channels alone, in this order.

        Raises:
            InputError: a name that the record does not have.
        """
        for name in names:
            if name not in self.sensors:
                raise InputError(
                    f"{self.name}: no channel {name!r}",
                    f"its channels are {', '.join(self.sensors)}",
                    "name one of these with --channel, or leave the option out for all of them",
                )
        rows = [self.sensors.index(name) for name in names]
        quantities = tuple(self.quantities[row] for row in rows)
        return replace(self, sensors=tuple(names), quantities=quantities, responses=self.responses[rows])


def channels_with_rig(path: Path, rig: Rig, without: Sequence[str] = ()) -> Channels:
    """The channels that a rig's sensors have in a record; dead and implausible ones are left out with a finding.

    Args:
        path: the record.
        rig: whose sensors they are.
        without: channels to leave out.

    Raises:
        InputError: a file that cannot be used.
    """
    record = read_record(path, rig, without=without, strict=False)
    if not isinstance(record, Record):
        raise _no_time_record(path)
    driven = record.excitation is not None and rig.excitation is not None
    return Channels(
        record.name,
        record.fs,
        record.excitation if driven else None,
        rig.excitation.quantity if driven and rig.excitation is not None else "",
        record.sensors,
        quantities_of(rig.sensors, record.sensors),
        record.responses,
        record.findings,
    )


def channels_of_file(path: Path, excitation: str | None, without: Sequence[str] = ()) -> Channels:
    """The channels of a record by the file's own names and units.

    Args:
        path: the record.
        excitation: name of the excitation's channel; by default the only force, if there is one.
        without: channels to leave out.

    Raises:
        InputError: a file that cannot be used, several forces, or a channel whose quantity the file does not tell.
    """
    recording = recording_of(path)
    check_left_out([recording], without)
    return channels_of(recording, excitation, without)


def recording_of(path: Path) -> Recording:
    """What a time record's file holds.

    Args:
        path: the record.

    Raises:
        InputError: a file that cannot be used, or one without samples over time.
    """
    recording = read_file(path)
    if not isinstance(recording, Recording):
        raise _no_time_record(path)
    return recording


def check_left_out(recordings: Sequence[Recording], without: Sequence[str]) -> None:
    """Whether each name of ``--without`` is a channel of one of the files.

    Args:
        recordings: read without a rig.
        without: names.

    Raises:
        InputError: one is not.
    """
    channels = [channel for recording in recordings for channel in recording.channels]
    for name in without:
        if not any(_is_called(channel, name) for channel in channels):
            known = list(dict.fromkeys(map(_name, channels)))
            files = ", ".join(recording.file for recording in recordings)
            raise not_left_out(name, f"the channels of {files}", known)


def channels_of(recording: Recording, excitation: str | None, without: Sequence[str] = ()) -> Channels:
    """The channels of a recording by its own names and units.

    Args:
        recording: what a file holds.
        excitation: name of the excitation's channel; by default the only force, if there is one.
        without: channels to leave out.

    Raises:
        InputError: several forces, an excitation that is none, or a channel whose quantity the file does not tell.
    """
    file = recording.file
    channels = [c for c in recording.channels if not any(_is_called(c, name) for name in without)]
    driving = _driving(file, channels, excitation)
    signals = {_name(channel): _in_si(recording, channel) for channel in channels if channel is not driving}
    alive = {name: signal for name, signal in signals.items() if not is_dead(signal[0])}
    if not alive:
        raise InputError(f"{file}: no channel moves", "a record tells what moves", "check the sensors")
    findings = [f"{file}: channel {name} is dead; left out" for name in signals if name not in alive]
    force, quantity = (None, "") if driving is None else _in_si(recording, driving)
    responses = np.stack([samples for samples, _ in alive.values()])
    driven = undying(list(responses)) if force is None or is_dead(force) else None
    findings += [] if driven is None else [f"{file}: {driven}"]
    return Channels(
        file,
        sampling_rate(recording, responses.shape[1]),
        force,
        quantity,
        tuple(alive),
        tuple(quantity for _, quantity in alive.values()),
        responses,
        (*recording.remarks, *findings),
    )


def no_excitation(name: str, channels: Sequence[str]) -> InputError:
    """What to say where one measured excitation is needed."""
    return InputError(
        f"{name}: no single excitation among its channels ({', '.join(channels)})",
        "an FRF is the response per unit of one measured excitation, the only force unless another is named",
        "name the channel with --excitation, or the rig with --rig",
    )


def _name(channel: RawChannel) -> str:
    return channel.tag.shown


def _is_called(channel: RawChannel, name: str) -> bool:
    return name in (channel.tag.name, str(channel.tag.node), _name(channel))


def _driving(file: str, channels: Sequence[RawChannel], name: str | None) -> RawChannel | None:
    """The channel of that name or node, or the only force; None where there is no force."""
    forces = [c for c in channels if quantity_of(c.tag) == "force"]
    called = forces if name is None else [c for c in channels if _is_called(c, name)]
    if name is not None and not called:
        raise InputError(
            f"{file}: no channel {name!r} for --excitation",
            f"its channels are {', '.join(map(_name, channels))}",
            "name one of these, or leave --excitation out where there is one force",
        )
    if len(called) > 1:
        raise no_excitation(file, [_name(channel) for channel in channels])
    if called and forces and called[0] not in forces:
        raise InputError(
            f"{file}: --excitation {name} beside {_name(forces[0])}, a force",
            f"what drives a rig is a force, or in a record without one the motion of its base; the channels are "
            f"{', '.join(map(_name, channels))}",
            f"name {_name(forces[0])}, or leave it out with --without {_name(forces[0])!r}",
        )
    return called[0] if called else None


def _in_si(recording: Recording, channel: RawChannel) -> tuple[FloatArray, str]:
    """The samples in SI units, and their quantity."""
    tag, where = channel.tag, f"{recording.file}: channel {_name(channel)}"
    quantity = quantity_of(tag)
    if quantity is None:
        raise InputError(
            f'{where} has the unit "{tag.unit or ""}"',
            "without its rig, a record's own units tell what its channels measure",
            f"name the rig with --rig, or leave the channel out with --without {_name(channel)!r}",
        )
    factor, _ = si_factor(tag, Measured(_name(channel), quantity, None), recording.file, recording.unlabelled)
    return checked(channel.data, where) * (tag.sign * factor), quantity


def _no_time_record(path: Path) -> InputError:
    return InputError(
        f"{path.name}: holds FRFs or mode shapes",
        "this command works on the samples of a test over time",
        "name a time record",
    )
