"""Named arrays to a recording: what MATLAB, HDF5 and NPZ files have in common.

``fs`` (Hz) or ``time`` (or ``t``) gives the time base, ``excitation_position`` (m) a roving hammer's place, every other
array is a channel by its name. Formats without attributes carry units as texts ``name=unit`` under ``units``; a name
may be a heading ``name [unit]`` as well, as tables are saved.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from models.arrays import AnyArray
from models.errors import InputError
from testbed.records.headings import check_brackets
from testbed.records.recording import RawChannel, Recording, Tag, headed, identifier

TIME_NAMES = ("time", "t")
RESERVED = ("fs", *TIME_NAMES, "units", "excitation_position")


def recording_of(file: str, variables: Mapping[str, AnyArray], units: Mapping[str, str]) -> Recording:
    """Sort a file's variables into time base and channels.

    Args:
        file: its name.
        variables: name -> array as stored, ``units`` excluded.
        units: name -> unit label.

    Raises:
        InputError: a unit in round brackets, ``fs`` or ``excitation_position`` is not one number, time is not a
            vector of numbers.
    """
    tags = {key: _tag(key, units) for key in variables}
    check_brackets(tags.values(), file)
    reserved = {name: key for key, tag in tags.items() if (name := str(tag.name).lower()) in RESERVED}
    channels, remarks = [], []
    for name, values in variables.items():
        if name in reserved.values():
            continue
        if values.dtype.kind not in "biufc":
            remarks.append(f"{file}: variable {name} holds no numbers and was passed over")
            continue
        channels.append(RawChannel(tags[name], np.squeeze(values)))
    time_name = next((reserved[name] for name in TIME_NAMES if name in reserved), None)
    return Recording(
        file,
        tuple(channels),
        fs=_scalar(file, variables, reserved.get("fs"), "in Hz"),
        time=None if time_name is None else _time(file, time_name, variables[time_name]),
        time_unit=None if time_name is None else tags[time_name].unit,
        excitation_position=_scalar(file, variables, reserved.get("excitation_position"), "in m from the clamp"),
        remarks=tuple(remarks),
    )


def _tag(key: str, units: Mapping[str, str]) -> Tag:
    tag = headed(key)
    told = units.get(key, units.get(tag.name or "", "")).strip()
    return replace(tag, unit=told or tag.unit)


def parse_units(entries: Iterable[str]) -> dict[str, str]:
    """``["P1=m/s^2", ...]`` to ``{"P1": "m/s^2", ...}``."""
    pairs = (entry.partition("=") for entry in entries)
    return {name.strip(): unit.strip() for name, sign, unit in pairs if sign}


def stored_names(recording: Recording) -> list[str]:
    """The variable name of each channel of a recording that is to be written.

    Raises:
        InputError: two channels would share a variable, or one would be taken for the time base.
    """
    names: list[str] = []
    for channel in recording.channels:
        shown = channel.tag.name or channel.tag.shown
        name = identifier(shown)
        if name in names or name.lower() in RESERVED:
            raise InputError(
                f'{recording.file}: channel "{shown}" as variable {name}',
                f"each channel has a variable of its own, none of {', '.join(RESERVED)}",
                "rename the sensor, or write a .csv or .uff file",
            )
        names.append(name)
    return names


def _scalar(file: str, variables: Mapping[str, AnyArray], name: str | None, unit: str) -> float | None:
    if name is None:
        return None
    values = variables[name]
    if values.size != 1 or values.dtype.kind not in "iuf":
        size = " x ".join(str(n) for n in values.shape)
        raise InputError(f"{file}: {name} is {size or 'no number'}", f"{name} is one number, {unit}", f"correct {name}")
    return float(values.reshape(-1)[0])


def _time(file: str, name: str, values: AnyArray) -> AnyArray:
    if values.dtype.kind not in "iuf":
        raise InputError(f"{file}: {name} holds no numbers", "a time base is a vector of times", f"correct {name}")
    return np.atleast_1d(np.squeeze(values)).astype(float)
