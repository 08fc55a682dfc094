"""Files that people's scripts wait for: written whole or not at all."""

import json
import math
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from models.errors import InputError
from testbed import __version__

Json = dict[str, Any]
"""What a JSON file holds."""

LAST = "run.json"
"""Moved into place after all others: whoever finds it finds a finished run."""


def check_open(out: Path, written: Iterable[str] = ()) -> None:
    """Whether a folder of results can be made and written, before it is.

    Args:
        out: the folder of the results.
        written: paths in it that will be replaced: files, and folders with a slash at their end.

    Raises:
        InputError: it or one of the paths cannot be written, because a file is where a folder has to be or the other
            way round, or because a folder is closed for writing.
    """
    _check_folder(out, out)
    for name in written:
        if name.endswith("/"):
            _check_folder(out, out / name)
            continue
        _check_folder(out, (out / name).parent)
        if (out / name).is_dir():
            raise _closed(out, f"{out / name} is a folder, and a file is to be written there")


def _check_folder(out: Path, folder: Path) -> None:
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise _closed(out, f"{there} is a file")
    if not os.access(there, os.W_OK | os.X_OK):
        raise _closed(out, f"{there} is closed for writing")
    try:
        # Where nothing can be made (/proc, a full disk, a read-only mount) permissions do not say so: try.
        Path(tempfile.mkdtemp(prefix=".writing-", dir=there)).rmdir()
    except OSError as error:
        raise _closed(out, f"nothing can be made in {there} ({error.strerror})") from error


def _closed(out: Path, reason: str) -> InputError:
    return InputError(
        f"--out {out}: {reason}",
        "results go into a folder that is open for writing",
        "name another folder with --out, or move away what is there",
    )


@contextmanager
def staged(out: Path) -> Iterator[Path]:
    """A folder to write into, whose files replace those of ``out`` once all are written, and vanish if one fails.

    Args:
        out: the folder of the results, made if it does not exist.

    Raises:
        InputError: the folder cannot be made, or one of the files not put into it; then none is.
    """
    check_open(out)
    try:
        out.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=".writing-", dir=out))
    except OSError as error:
        raise _closed(out, str(error.strerror)) from error
    try:
        yield stage
        written = [file.relative_to(stage) for file in stage.rglob("*") if file.is_file()]
        check_open(out, map(str, written))
        for file in sorted(written, key=lambda file: (file.name == LAST, file)):
            (out / file).parent.mkdir(parents=True, exist_ok=True)
            (stage / file).replace(out / file)
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def keep_json(path: Path, content: Any) -> None:
    """Write one result of many whole or not at all, so that a run that is stopped goes on after it.

    Args:
        path: of its file, whose folder is made if it does not exist.
        content: mappings, sequences, texts and numbers.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json_text(content), encoding="utf-8")
    part.replace(path)


def kept(path: Path, made_of: str, make: Callable[[], Mapping[str, Any]]) -> dict[str, Any]:
    """What an earlier run kept of the same things, or else what is made now, written whole.

    Args:
        path: of the file.
        made_of: digest of all that the result depends on (``digest_of``).
        make: gives the result.
    """
    try:
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if content["made_of"] == made_of:
            return content
    except (OSError, ValueError, KeyError, TypeError):
        pass
    path.unlink(missing_ok=True)
    keep_json(path, {"made_of": made_of, **make()})
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def digest_of(*things: object) -> str:
    """Digest of arrays, and of the ``repr`` of anything else, with the version of the program.

    Args:
        things: that a result depends on.
    """
    digest = sha256(__version__.encode())
    for thing in things:
        digest.update(thing.tobytes() if isinstance(thing, np.ndarray) else repr(thing).encode())
    return digest.hexdigest()


def json_text(content: Any) -> str:
    """JSON with numpy's numbers as numbers; what is not finite is null, since JSON knows no infinity.

    Args:
        content: mappings, sequences, texts and numbers.
    """
    return json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
