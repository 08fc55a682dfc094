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
    # Numba has no public door to this stamp; where a version has none at all, nothing is cached.
    kept: Any = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if not hasattr(kept, "_version"):
        return cast("Function", njit(**OPTIONS)(function))
    # The version is compared before the rest is read, which may name what no longer exists.
    kept._version += " " + stamp_of(Path(function.__code__.co_filename).parent)  # noqa: SLF001
    return cast("Function", dispatcher)


@cache
def stamp_of(folder: Path) -> str:
    """A digest of all files of a folder and of those through which compiled code reads and calls laws."""
    own = Path(__file__)
    digest = sha256()
    for file in (own, own.with_name("law_call.py"), own.with_name("point_forces.py"), *sorted(folder.glob("*.py"))):
        digest.update(file.read_bytes())
    return digest.hexdigest()
