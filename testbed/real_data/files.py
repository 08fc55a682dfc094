"""Published measurement files, as their authors left them."""

from pathlib import Path
from typing import Any

from scipy.io import loadmat

from models.errors import InputError


def set_folder(folder: Path, name: str) -> Path:
    """Where a set's files lie: in the folder itself, or in one of the set's name within it.

    Args:
        folder: as given.
        name: of the set.

    Raises:
        InputError: there is no such folder.
    """
    if not folder.is_dir():
        raise InputError(
            f"{folder}: no such folder",
            f"the study reads the published files of {name.replace('_', ' ')} from a folder",
            "name the folder that they were saved in",
        )
    return folder / name if (folder / name).is_dir() else folder


def read_variables(file: Path, names: tuple[str, ...], source: str) -> dict[str, Any]:
    """Variables of a MATLAB file; structures as mappings, their fields by name.

    Args:
        file: as published.
        names: of the variables.
        source: where users get it, for the message.

    Raises:
        InputError: a file that is missing, is no MATLAB file, or lacks a variable.
    """
    if not file.is_file():
        raise InputError(f"{file}: no such file", "the study reads the files as published", f"get it from {source}")
    try:
        content: dict[str, Any] = loadmat(file, simplify_cells=True)
    except (ValueError, NotImplementedError, OSError) as error:
        raise InputError(
            f"{file.name}: cannot be read as a MATLAB file ({error})",
            "the study reads the files as published",
            f"get it again from {source}",
        ) from error
    missing = [name for name in names if name not in content]
    if missing:
        raise InputError(
            f"{file.name}: no variable {missing[0]}",
            f"the published file holds {' and '.join(names)}",
            f"get it again from {source}",
        )
    return {name: content[name] for name in names}
