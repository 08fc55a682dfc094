"""NPZ: one array a channel, ``fs`` or ``time``, and optionally ``units``, an array of texts ``name=unit``."""

import zipfile
from pathlib import Path

import numpy as np

from models.arrays import AnyArray
from testbed.records.isolation import UnreadableError
from testbed.records.recording import Recording
from testbed.records.variables import parse_units, recording_of, stored_names

HOLDS = "named arrays saved by numpy.savez"


def read(path: Path) -> Recording:
    """All arrays of the archive.

    Raises:
        InputError: a time base that is none.
        UnreadableError: no arrays of numbers.
        Exception: whatever numpy raises on an archive that is broken.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            # Opened by the file's content: a lone .npy array under this suffix has no names.
            variables = {name: np.asarray(archive[name]) for name in archive.files}
    except ValueError as error:
        if "pickle" in str(error):
            raise UnreadableError("Python objects, or no arrays at all") from error
        raise
    units = variables.pop("units", None)
    labels = {} if units is None else parse_units(str(entry) for entry in units.reshape(-1))
    return recording_of(path.name, variables, labels)


def write(recording: Recording, path: Path) -> None:
    """Double precision throughout.

    Raises:
        InputError: names that an archive cannot tell apart.
    """
    names = stored_names(recording)
    entries: dict[str, AnyArray] = {name: channel.data for name, channel in zip(names, recording.channels, strict=True)}
    entries["fs"] = np.array(recording.fs)
    entries["units"] = np.array([f"{n}={c.tag.unit}" for n, c in zip(names, recording.channels, strict=True)])
    if recording.excitation_position is not None:
        entries["excitation_position"] = np.array(recording.excitation_position)
    # numpy.savez takes names as keywords, and a sensor may be called like one of its own.
    with zipfile.ZipFile(path, "w") as archive:
        for name, values in entries.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                np.lib.format.write_array(file, values, allow_pickle=False)
