"""MATLAB files, 5 and 7.3: variables by name, ``fs`` or ``t``/``time``, and optionally ``units``.

``units`` is a struct with one text for each variable, or a cell array or char matrix of texts ``name=unit``.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import AnyArray
from models.errors import InputError
from testbed.records import isolation
from testbed.records.hdf5 import array_of, top_level
from testbed.records.recording import Recording
from testbed.records.variables import parse_units, recording_of, stored_names

HOLDS = "variables of a MATLAB file"

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
USER_BLOCK = 512
"""Bytes that MATLAB 7.3 writes before it."""

LONGEST_NAME = 63
"""Of a MATLAB variable: namelengthmax."""


def read(path: Path) -> Recording:
    """All variables at the file's top level.

    Raises:
        InputError: a time base that is none.
        UnreadableError: the file is broken.
    """
    return recording_of(path.name, *isolation.load(__name__, path))


def load(path: Path) -> isolation.Loaded:
    """Variables and their units; to be called in a process of its own.

    Raises:
        Exception: whatever scipy or h5py raises on a file that is broken.
    """
    with path.open("rb") as file:
        head = file.read(USER_BLOCK + len(HDF5_SIGNATURE))
    is_hdf5 = head.startswith(HDF5_SIGNATURE) or head[USER_BLOCK:] == HDF5_SIGNATURE
    return _load_hdf5(path) if is_hdf5 else _load_5(path)


def write(recording: Recording, path: Path) -> None:
    """MATLAB 5, double precision.

    Raises:
        InputError: names that MATLAB cannot tell apart or hold.
    """
    from scipy.io import savemat

    names = stored_names(recording)
    for name in names:
        if len(name) > LONGEST_NAME:
            raise InputError(
                f"{recording.file}: channel {name}",
                f"a MATLAB variable has up to {LONGEST_NAME} letters",
                "shorten the sensor's name, or write another format",
            )
    channels = dict(zip(names, recording.channels, strict=True))
    variables: dict[str, Any] = {name: channel.data for name, channel in channels.items()}
    variables["fs"] = recording.fs
    variables["units"] = {name: channel.tag.unit for name, channel in channels.items()}
    if recording.excitation_position is not None:
        variables["excitation_position"] = recording.excitation_position
    savemat(str(path), variables, appendmat=False, long_field_names=True, oned_as="column")


def _load_5(path: Path) -> isolation.Loaded:
    from scipy.io import loadmat

    content = loadmat(str(path), appendmat=False, squeeze_me=True, struct_as_record=False)
    units = content.pop("units", None)
    variables = {name: np.asarray(value) for name, value in content.items() if not name.startswith("__")}
    return variables, _units_of_5(units)


def _units_of_5(units: Any) -> dict[str, str]:
    if units is None:
        return {}
    if hasattr(units, "_fieldnames"):
        return {name: str(getattr(units, name)) for name in units._fieldnames}  # noqa: SLF001 - scipy's documented way
    return parse_units(str(entry) for entry in np.atleast_1d(units).reshape(-1))


def _load_hdf5(path: Path) -> isolation.Loaded:
    import h5py

    with h5py.File(path, "r") as file:
        variables = {name: _values(item, path) for name, item in top_level(file) if name != "units"}
        units = dict(_units_of_hdf5(file["units"])) if "units" in file else {}
    return variables, units


def _values(dataset: Any, path: Path) -> AnyArray:
    """The numbers, or a text where MATLAB stored one as character codes."""
    return np.array(_chars(dataset)) if _matlab_class(dataset) == "char" else array_of(dataset, path)


def _units_of_hdf5(units: Any) -> Iterator[tuple[str, str]]:
    """A struct is a group of texts; a char matrix is stored column by column; a cell array refers to texts."""
    import h5py

    if isinstance(units, h5py.Group):
        yield from ((name, _chars(units[name])) for name in units)
    elif _matlab_class(units) == "cell":
        yield from parse_units(_chars(units.file[reference]) for reference in units[()].reshape(-1)).items()
    elif units.ndim == 2:
        yield from parse_units("".join(map(chr, row)) for row in units[()].T).items()


def _matlab_class(dataset: Any) -> str:
    value = dataset.attrs.get("MATLAB_class", b"")
    return value.decode("ascii", errors="replace") if isinstance(value, bytes) else str(value)


def _chars(dataset: Any) -> str:
    return "".join(chr(int(code)) for code in dataset[()].reshape(-1))
