"""Compilation to machine code with a cache that notices what it was built from."""

from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": {"contract", "reassoc", "nsz", "arcp"}}
"""Sums may be reordered; not-a-numbers stay visible."""


def compiled(function: Function) -> Function:
    """The function as machine code, compiled on its first call and kept on disk.

    Numba recompiles where the function's own file has changed, but not where a function that it calls, and that was
    built into it, has changed in another file. Here the whole folder counts, and the door to the laws.

    Args:
        function: plain Python in numba's subset; what it calls lies in the same folder, or is ``call_law``.
    """
    dispatcher: Any = njit(**OPTIONS)(function)
    dispatcher.enable_caching()
    if not _stamped(dispatcher, stamp_of(Path(function.__code__.co_filename).parent)):
        return cast("Function", njit(**OPTIONS)(function))
    return cast("Function", dispatcher)


def noticing(*names: str) -> Callable[[Function], Function]:
    """For a compiled function with a cache: it is compiled anew where one of some files has changed.

    Args:
        names: of files beside the function's own, whose code is built into it.
    """

    def stamped(function: Function) -> Function:
        dispatcher: Any = function
        folder = Path(dispatcher.py_func.__code__.co_filename).parent
        _stamped(dispatcher, sha256(b"".join((folder / name).read_bytes() for name in names)).hexdigest())
        return function

    return stamped


def _stamped(dispatcher: Any, stamp: str) -> bool:
    """Whether the version in a function's cache could be told apart by a stamp."""
    # Numba has no public door to this; where a version of it has none at all, nothing can be told.
    kept: Any = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if not hasattr(kept, "_version"):
        return False
    # The version is compared before the rest is read, which may name what no longer exists.
    kept._version += " " + stamp  # noqa: SLF001
    return True


@cache
def stamp_of(folder: Path) -> str:
    """A digest of all files of a folder and of those through which compiled code reads and calls laws."""
    own = Path(__file__)
    digest = sha256()
    for file in (own, own.with_name("law_call.py"), own.with_name("point_forces.py"), *sorted(folder.glob("*.py"))):
        digest.update(file.read_bytes())
    return digest.hexdigest()
