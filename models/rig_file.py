"""The rig's TOML file: read with errors that an engineer can act on, written with the owner's comments kept."""

import re
import secrets
import shutil
import tomllib
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import ValidationError

from models.errors import InputError
from models.rig import Rig
from models.rig_edits import edit
from models.rig_faults import first_fault

RECORDS = {".uff", ".unv", ".csv", ".mat", ".h5", ".hdf5", ".npz"}
"""Suffixes of records, which are mistaken for rig files now and then."""

_SINGLE = re.compile(r"^\s*\[((sleeve|sensor|effect)s?)\]", re.MULTILINE)
"""The head of a table that stands in a list, as a table of its own."""


def read_rig(path: Path | str) -> Rig:
    """The rig that a TOML file describes.

    Args:
        path: the rig file.

    Raises:
        InputError: the file cannot be read, is not TOML, or describes no rig; it tells the first problem.
    """
    if Path(path).suffix.lower() in RECORDS:
        raise InputError(
            f"{Path(path).name}: a record in the place of the rig",
            "the rig file (.toml) comes first, then its records",
            "name the rig file first",
        )
    return _parse(_read_text(Path(path)), Path(path).name)


def write_rig(rig: Rig, path: Path | str, like: Path | str | None = None) -> None:
    """Write a rig as TOML, whole or not at all.

    Args:
        rig: what to write.
        path: the file to write or replace.
        like: a rig file whose comments, order and number formats are kept wherever the rig has not changed.

    Raises:
        InputError: ``like`` is no rig file, the rig would not be read back (a value out of range), or the file cannot
            be written.
    """
    path = Path(path)
    if like is None:
        text = tomlkit.dumps(_content(rig))
    else:
        like = Path(like)
        text = _edited(_read_text(like), like.name, rig, path.name)
    _parse(text, path.name)
    _write_whole(text, path)


def _content(rig: Rig) -> dict[str, Any]:
    """The rig as the tables of its file: what is not given and what is empty has no key."""
    content = rig.model_dump(exclude_none=True)
    return {key: value for key, value in content.items() if value not in ((), {})}


def _edited(text: str, file: str, rig: Rig, written: str) -> str:
    """The owner's text with only the values that differ from the rig changed."""
    before = _parse(text, file)
    if rig == before:
        return text
    document = tomlkit.parse(text.removeprefix("\ufeff").replace("\r\n", "\n"))
    edit(document, _content(before), _content(rig))
    edited = tomlkit.dumps(document)
    if _parse(edited, written) != rig:
        # A key left out meant another default before, as gravity does when a beam becomes an oscillator.
        return tomlkit.dumps(_content(rig))
    return edited.replace("\n", "\r\n") if "\r\n" in text else edited


def _parse(text: str, file: str) -> Rig:
    try:
        content = tomllib.loads(text.removeprefix("\ufeff"))
    except (ValueError, RecursionError) as error:
        single = _SINGLE.search(text)
        if single:
            raise InputError(
                f"{file}: [{single[1]}] in single brackets ({error})",
                "sleeves, sensors and effects are lists of tables, one for each",
                f"head each one with [[{single[2]}s]], in double brackets",
            ) from error
        raise not_toml(file, "a rig file", error, "a key stands once in its table") from error
    if "structure" not in content and "kind" in _table(content, "excitation"):
        raise InputError(
            f"{file}: an experiment in the place of the rig",
            "a rig file has [structure], and its [excitation] has no kind",
            "name the rig file first; an experiment goes to testbed simulate, after the rig",
        )
    try:
        return Rig.model_validate(content)
    except ValidationError as error:
        raise first_fault(file, error) from error


def not_toml(file: str, what: str, error: Exception, rule: str) -> InputError:
    """What is told of a text that is no TOML.

    Args:
        file: its name.
        what: it should be.
        error: of the parser, which names a line, or the end.
        rule: of TOML that is broken most often in such files.
    """
    if "(at end of document)" in str(error):
        mend = "see what was opened last and not closed: a bracket, a quote, or a key without a value"
    else:
        mend = f"correct that line; decimals take a point, texts stand in quotes, and {rule}"
    return InputError(f"{file}: {error}", f"{what} is valid TOML", mend)


def _table(content: dict[str, Any], key: str) -> dict[str, Any]:
    """A table of a file, empty where it has none of that name."""
    table = content.get(key)
    return table if isinstance(table, dict) else {}


def _read_text(path: Path) -> str:
    if not path.exists():
        raise InputError(f"{path} does not exist", "a rig is a TOML file", "correct the path")
    if path.is_dir():
        raise InputError(f"{path} is a directory", "a rig is a TOML file", "name the file inside it")
    try:
        return path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path.name}: byte {error.start + 1} is not UTF-8",
            "a rig file is a text in UTF-8",
            "save it from a text editor with that encoding",
        ) from error
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}", "a rig file can be read", "correct its permissions") from error


def _write_whole(text: str, path: Path) -> None:
    """Write beside the target first, so that a reader sees the old file or the new one and nothing between."""
    target = path.resolve()
    draft = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
    try:
        draft.write_bytes(text.encode("utf-8"))
        if target.exists():
            shutil.copymode(target, draft)
        draft.replace(target)
    except OSError as error:
        raise InputError(
            f"{path} cannot be written: {error.strerror}",
            "a rig is written into an existing folder that is open for writing",
            "create the folder or choose another path",
        ) from error
    finally:
        draft.unlink(missing_ok=True)
