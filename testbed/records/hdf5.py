"""HDF5: one dataset a channel with the attribute ``unit``; the attribute ``fs`` of the file, or a dataset ``time``."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import AnyArray
from testbed.records import isolation
from testbed.records.recording import Recording
from testbed.records.variables import recording_of, stored_names

HOLDS = "datasets of an HDF5 file"

MOST_COMPRESSED = 1100
"""Bytes in memory for one byte of file; deflate cannot do more, so a larger dataset has a broken header."""


def read(path: Path) -> Recording:
    """All datasets at the file's top level.

    Raises:
        InputError: a time base that is none.
        UnreadableError: the file is broken.
    """
    return recording_of(path.name, *isolation.load(__name__, path))


def load(path: Path) -> isolation.Loaded:
    """Datasets and their units; to be called in a process of its own.

    Raises:
        ValueError: a dataset is larger than the file can hold.
        Exception: whatever h5py raises on a file that is broken.
    """
    import h5py

    with h5py.File(path, "r") as file:
        datasets = dict(top_level(file))
        variables = {name: array_of(dataset, path) for name, dataset in datasets.items()}
        units = {name: _text(dataset.attrs["unit"]) for name, dataset in datasets.items() if "unit" in dataset.attrs}
        for key in ("fs", "excitation_position"):
            if key in file.attrs:
                variables[key] = np.asarray(file.attrs[key])
    return variables, units


def write(recording: Recording, path: Path) -> None:
    """Double precision throughout.

    Raises:
        InputError: names that cannot be told apart.
    """
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["fs"] = recording.fs
        if recording.excitation_position is not None:
            file.attrs["excitation_position"] = recording.excitation_position
        for name, channel in zip(stored_names(recording), recording.channels, strict=True):
            file[name] = channel.data
            file[name].attrs["unit"] = channel.tag.unit


def top_level(file: Any) -> Iterator[tuple[str, Any]]:
    """Names and datasets of an open file, without its groups."""
    import h5py

    for name in file:
        item = file[name]
        if isinstance(item, h5py.Dataset):
            yield name, item


def array_of(dataset: Any, path: Path) -> AnyArray:
    """A dataset's values, unless it claims to hold more than its file can.

    Raises:
        ValueError: it does.
    """
    # Before any memory is asked for: one flipped bit in a header is petabytes.
    if dataset.size and dataset.size * dataset.dtype.itemsize > MOST_COMPRESSED * path.stat().st_size:
        raise ValueError(f"{dataset.name} claims {dataset.size} samples")
    return np.asarray(dataset[()])


def _text(value: Any) -> str:
    first = np.asarray(value).reshape(-1)[0]
    return first.decode("utf-8", errors="replace") if isinstance(first, bytes) else str(first)
