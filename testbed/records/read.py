"""``read_record``: a file, resolved against a rig, as a record in SI units."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.beam.clamped_free import wave_numbers
from models.errors import InputError
from models.record import AnyRecord, FrfRecord, ModeShapeRecord, Record, is_dead
from models.rig import Rig
from models.structure import Structure
from testbed.records.dying import undying
from testbed.records.formats import read_file
from testbed.records.linear import frf_record, mode_shape_record
from testbed.records.matching import Matched, check_left_out, match
from testbed.records.odd_units import odd_units
from testbed.records.plausibility import Fault, find_faults, own_zeros
from testbed.records.recording import AnyRecording, FrfRecording, RawChannel, Recording
from testbed.records.samples import checked
from testbed.records.start import starts_moving
from testbed.records.time_base import sampling_rate
from testbed.records.units import Measured, si_factor


class UnusableChannelsError(InputError):
    """Channels that a comparison cannot do without.

    Attributes:
        names: of them.
        strangers: channels that no sensor goes by, which may be those that are missing.
    """

    names: tuple[str, ...] = ()
    strangers: tuple[str, ...] = ()


def unusable(
    given: str, names: Sequence[str], rig: Rig, without: Sequence[str], strangers: Sequence[str] = ()
) -> UnusableChannelsError:
    """The error for channels of one or more records, with one way out for all of them.

    Args:
        given: the files, and what is wrong with their channels.
        names: of the channels.
        rig: whose channels they are.
        without: those that are left out already, and have to be named again.
        strangers: channels that no sensor goes by, beside sensors without a channel.
    """
    out = dict.fromkeys([*without, *names])
    options = " ".join(f"--without {shlex.quote(name)}" for name in out)
    mend = f"mend the record, or leave out with {options}"
    if {sensor.name for sensor in rig.sensors} <= set(out):
        mend = "mend the records, or take each by itself, with a --without for each channel that it lacks"
    if strangers:
        unknown = dict.fromkeys(strangers)
        mend = f"if {', '.join(unknown)} is a sensor of the rig, give it the name that it has there; otherwise {mend}"
    error = UnusableChannelsError(given, "a comparison needs every channel of the rig, alive and plausible", mend)
    error.names, error.strangers = tuple(names), tuple(strangers)
    return error


def read_record(path: Path | str, rig: Rig, *, without: Sequence[str] = (), strict: bool = True) -> AnyRecord:
    """Read a file and resolve its channels against a rig.

    Args:
        path: of a suffix in ``testbed.records.formats``.
        rig: whose sensors and excitation the channels are.
        without: names of channels to leave out, unread.
        strict: a dead, missing or implausible channel is an error; otherwise it is left out with a finding.

    Raises:
        InputError: anything that makes the record unusable, with file, channel and sample where there is one.
    """
    return resolved(read_file(Path(path)), rig, without=without, strict=strict)


def resolved(held: AnyRecording, rig: Rig, *, without: Sequence[str] = (), strict: bool = True) -> AnyRecord:
    """What a file holds, resolved against a rig.

    Args:
        held: the file's own channels.
        rig: whose sensors and excitation they are.
        without: as in ``read_record``.
        strict: as in ``read_record``.

    Raises:
        InputError: anything that makes the record unusable, with file, channel and sample where there is one.
    """
    check_left_out(without, rig)
    expected = tuple(sensor.name for sensor in rig.sensors if sensor.name not in without)
    if isinstance(held, Recording):
        return _time_record(held, rig, without, expected, strict=strict)
    record: FrfRecord | ModeShapeRecord
    record = (
        frf_record(held, rig, expected) if isinstance(held, FrfRecording) else mode_shape_record(held, rig, expected)
    )
    missing = tuple(name for name in expected if name not in record.sensors)
    if strict and missing:
        raise _refused(held.file, [Fault(missing, f"no channel for {', '.join(missing)}")], rig, without)
    return record


class FirstModeError(InputError):
    """A record that cannot hold the first mode of its rig: either may be described wrongly."""


def first_natural_freq(rig: Rig) -> float:
    """Hz, of the beam without sleeves or the oscillator; 0 where nothing holds the mass."""
    structure = Structure.of(rig.structure)
    rate = float(np.sqrt(structure.bending_stiffness / structure.line_mass))
    if structure.is_beam:
        rate *= float(wave_numbers(1)[0] / structure.length) ** 2
    return rate / (2 * np.pi)


@dataclass(frozen=True, eq=False)
class _Signals:
    """The checked channels of a record in SI units, with what had to be assumed."""

    excitation: FloatArray | None
    responses: dict[str, FloatArray]
    findings: tuple[str, ...]


def _time_record(
    recording: Recording, rig: Rig, without: Sequence[str], expected: tuple[str, ...], *, strict: bool
) -> Record:
    file, matched = recording.file, match(recording, rig, without)
    signals = _signals(recording, matched, rig)
    n_samples = len(next(iter(signals.responses.values())))
    fs = sampling_rate(recording, n_samples)
    freq = first_natural_freq(rig)
    _check_rate(file, n_samples, fs, freq)
    _check_duration(file, n_samples, fs, freq)
    excitation, position = signals.excitation, matched.excitation_position
    faults = find_faults(signals.responses, rig, expected)
    if excitation is not None and is_dead(excitation):
        assert rig.excitation is not None
        name = rig.excitation.name
        faults.append(Fault((name,), f"the excitation {name} is dead: {excitation[0]:g} throughout"))
        excitation = position = None
    out = {name for fault in faults for name in fault.sensors}
    responses = {name: samples for name, samples in signals.responses.items() if name not in out}
    if not responses:
        raise _nothing_measured(file, signals.responses, faults)
    if faults and strict:
        raise _refused(file, faults, rig, without, matched.strangers if set(expected) - set(signals.responses) else ())
    driven = None if excitation is not None else undying(list(responses.values()))
    told = (
        *(f"{fault.reason}; left out" for fault in faults),
        *([] if driven is None else [driven]),
        *own_zeros(responses, rig),
        *odd_units(responses, {name: matched.sensors[name].tag for name in responses}, rig),
    )
    return Record(
        name=file,
        fs=fs,
        excitation=excitation,
        sensors=tuple(responses),
        responses=np.stack(list(responses.values())),
        excitation_position=position,
        moving_start=starts_moving(excitation, responses, rig, fs, freq),
        findings=(*matched.findings, *signals.findings, *(f"{file}: {words}" for words in told)),
    )


def _signals(recording: Recording, matched: Matched, rig: Rig) -> _Signals:
    """All matched channels, checked and converted once."""
    findings: list[str] = []
    length: dict[int, str] = {}

    def converted(channel: RawChannel, measured: Measured) -> FloatArray:
        tag = channel.tag
        factor, finding = si_factor(tag, measured, recording.file, recording.unlabelled)
        samples = checked(channel.data, f"{recording.file}: channel {tag.shown}")
        length.setdefault(samples.size, tag.shown)
        if finding is not None:
            findings.append(finding)
        return samples * (tag.sign * factor)

    excitation = None
    if matched.excitation is not None and rig.excitation is not None:
        excitation = converted(matched.excitation, Measured.of(rig.excitation))
    responses = {name: converted(channel, Measured.of(rig.sensor(name))) for name, channel in matched.sensors.items()}
    if len(length) > 1:
        (n_first, first), (n_other, other) = list(length.items())[:2]
        raise InputError(
            f"{recording.file}: channel {other} has {n_other} samples, channel {first} has {n_first}",
            "all channels of a record are equally long",
            "cut them to the samples they share",
        )
    return _Signals(excitation, responses, tuple(findings))


def _check_duration(file: str, n_samples: int, fs: float, freq: float) -> None:
    if n_samples / fs * freq < 1 and freq > 0:
        raise FirstModeError(
            f"{file}: {n_samples} samples at {fs:g} Hz, {n_samples / fs:.4g} s",
            f"a record lasts at least one period of the first mode, {1 / freq:.4g} s",
            "record for longer, or check fs",
        )


def _nothing_measured(file: str, responses: Mapping[str, FloatArray], faults: list[Fault]) -> InputError:
    """What to say where no channel is left, which leaving channels out would not mend."""
    dead = all(is_dead(samples) for samples in responses.values())
    names = ", ".join(responses)
    return InputError(
        f"{file}: nothing was measured: "
        + (f"{names} are constant throughout" if dead else "; ".join(fault.reason for fault in faults)),
        "a record tells how the rig moves, on one sensor at least",
        "check sensors, cables, amplifiers and what was exported, then measure or export again",
    )


def _check_rate(file: str, n_samples: int, fs: float, freq: float) -> None:
    if fs < 2.0 * freq:
        raise FirstModeError(
            f"{file}: {n_samples} samples at {fs:.4g} Hz, {n_samples / fs:.4g} s",
            f"a record holds frequencies up to half its rate, and the first mode of the rig is at {freq:.4g} Hz",
            "if its time column is in ms, call it time [ms]; otherwise correct fs, or record faster",
        )


def _refused(
    file: str, faults: list[Fault], rig: Rig, without: Sequence[str], strangers: Sequence[str] = ()
) -> UnusableChannelsError:
    names = [name for fault in faults for name in fault.sensors]
    return unusable(f"{file}: {'; '.join(fault.reason for fault in faults)}", names, rig, without, strangers)
