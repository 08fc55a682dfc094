"""Which suffix is which format, and how any file's failure becomes one readable error."""

import warnings
from pathlib import Path
from typing import Protocol

import numpy as np

from models.errors import InputError
from models.rig_checks import nearest
from testbed.records import csv_text, hdf5, mat, npz, uff
from testbed.records.isolation import UnreadableError
from testbed.records.recording import AnyRecording, Recording


class Format(Protocol):
    """What a format's module offers."""

    HOLDS: str
    """What such a file holds, in words."""

    def read(self, path: Path) -> AnyRecording:
        """What the file holds."""

    def write(self, recording: Recording, path: Path) -> None:
        """The file, from a recording in SI units."""


FORMATS: dict[str, Format] = {
    ".uff": uff,
    ".unv": uff,
    ".csv": csv_text,
    ".mat": mat,
    ".h5": hdf5,
    ".hdf5": hdf5,
    ".npz": npz,
}

ONE_OF = f"one of {', '.join(FORMATS)}"


def format_of(path: Path) -> Format:
    """The format that the suffix names, in any case.

    Raises:
        InputError: an unknown suffix.
    """
    suffix = path.suffix.lower()
    if suffix == ".toml":
        raise InputError(
            f"{path.name}: a rig file or an experiment in the place of a record",
            f"a record is {ONE_OF}",
            "name the rig file first, and then its records",
        )
    if suffix not in FORMATS:
        near = nearest(suffix, FORMATS)
        raise InputError(
            f'{path.name}: the suffix "{path.suffix}"',
            f"a record is {ONE_OF}",
            f"rename it to {near} if it is one" if near else "export the record in one of these formats",
        )
    return FORMATS[suffix]


def read_file(path: Path) -> AnyRecording:
    """What a file holds, in its own units and names.

    Args:
        path: of any known suffix.

    Raises:
        InputError: there is no such file, it is a directory, or its content is not what the suffix says.
    """
    if path == Path():
        raise InputError(
            "the record '.', or one without a name",
            "a record is a file",
            "name the files inside the folder; or is a variable of the shell not set?",
        )
    if path.is_dir():
        raise InputError(f"{path}: is a directory", "a record is a file", "name the files inside it")
    form = format_of(path)
    _check_there(path, form)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return form.read(path)
    except InputError:
        raise
    except OSError as error:
        if error.strerror and error.errno:
            raise InputError(f"{path}: {error.strerror}", "a record can be opened", "check the path") from error
        raise _unreadable(path, form, f"{type(error).__name__}: {error}") from error
    except UnreadableError as error:
        raise _unreadable(path, form, str(error)) from None
    # A broken file takes the libraries that read it to places where they raise nearly anything.
    except Exception as error:
        raise _unreadable(path, form, f"{type(error).__name__}: {error}") from error


def _check_there(path: Path, form: Format) -> None:
    if not path.is_file():
        raise InputError(f"{path}: there is no such file", f"a record is a file, {ONE_OF}", "check the path")
    if path.stat().st_size == 0:
        raise InputError(f"{path.name}: the file is empty", f"it should hold {form.HOLDS}", "export the record again")


def _unreadable(path: Path, form: Format, reason: str) -> InputError:
    return InputError(
        f"{path.name}: cannot be read ({' '.join(reason.split())[:120]})",
        f"a {path.suffix} file holds {form.HOLDS}",
        "the file may be cut short or carry the wrong suffix: export or copy it again",
    )
