"""Libraries that a damaged file can crash read in a process of their own, which hands plain arrays back.

libhdf5 and scipy's MATLAB reader are compiled code that trusts a file's headers; one flipped bit can end the process.
"""

import io
import json
import subprocess
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

import numpy as np

from models.arrays import AnyArray

TIMEOUT = 300.0
"""Seconds; the largest records take a few, a damaged file may never end."""

_CHILD = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from testbed.records.isolation import answer; answer(sys.argv[2], sys.argv[3])"
)
_VARIABLE = "variable "

Loaded = tuple[Mapping[str, AnyArray], Mapping[str, str]]
"""Name -> array, name -> unit."""


class UnreadableError(Exception):
    """A file that its library cannot read, in that library's words."""


def load(module: str, path: Path) -> Loaded:
    """What ``module.load(path)`` returns, from a process of its own.

    Args:
        module: one with a function ``load``.
        path: the file.

    Raises:
        UnreadableError: the library raised, crashed or did not end.
    """
    command = [sys.executable, "-c", _CHILD, json.dumps(sys.path), module, str(path.absolute())]
    try:
        child = subprocess.run(command, capture_output=True, check=False, timeout=TIMEOUT)  # noqa: S603 - our own code
    except subprocess.TimeoutExpired:
        raise UnreadableError(f"no end after {TIMEOUT:g} s") from None
    if child.returncode != 0:
        last = child.stderr.decode("utf-8", errors="replace").strip().splitlines()[-1:]
        # A negative status is a signal, and on Windows a crash is a large one.
        crashed = child.returncode < 0 or child.returncode > 255
        raise UnreadableError("its headers crash the library" if crashed else " ".join(last))
    with np.load(io.BytesIO(child.stdout), allow_pickle=False) as archive:
        variables = {n.removeprefix(_VARIABLE): archive[n] for n in archive.files if n.startswith(_VARIABLE)}
        return variables, json.loads(str(archive["units"]))


def answer(module: str, path: str) -> None:
    """The other end of ``load``: read and write to standard output; what holds no numbers goes as an empty text."""
    variables, units = import_module(module).load(Path(path))
    plain = {name: values if values.dtype.kind in "biufcU" else np.array("") for name, values in variables.items()}
    buffer = io.BytesIO()
    arrays = {f"{_VARIABLE}{name}": values for name, values in plain.items()}
    np.savez(buffer, allow_pickle=False, units=np.array(json.dumps(dict(units))), **arrays)
    sys.stdout.buffer.write(buffer.getvalue())
