"""The models a results folder has held: numbered rig files that nothing deletes, and which of them is current."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from models.errors import InputError
from models.rig import Rig
from models.rig_file import read_rig, write_rig
from testbed.outputs import check_open, json_text, staged

FOLDER, INDEX, UPDATED = "history", "history.json", "rig.updated.toml"
BY_HAND = "changed by hand"


@dataclass(frozen=True)
class Entry:
    """One model.

    Attributes:
        number: 1, 2, ... in the order of writing.
        parent: the model that it was made from, None for a rig as given.
        model: its label, e.g. ``+ squeeze_film at sleeve 2``.
        nrmse: its error on the records of that command, None where none was computed.
        time: of writing, ISO 8601.
        command: that wrote it.
    """

    number: int
    parent: int | None
    model: str
    nrmse: float | None
    time: str
    command: str

    @property
    def file(self) -> str:
        """Name of its rig file inside ``history``."""
        return f"{self.number:04d}.toml"


@dataclass(frozen=True)
class Model:
    """A model to remember: its label, its rig and its error."""

    label: str
    rig: Rig
    nrmse: float | None


@dataclass(frozen=True)
class History:
    """All entries of a results folder, and the number of the current one."""

    entries: tuple[Entry, ...] = ()
    current: int | None = None

    def entry(self, number: int) -> Entry:
        """The entry of that number."""
        return self.entries[number - 1]

    def added(self, label: str, nrmse: float | None, parent: int | None, command: str) -> "History":
        """With one more entry, which becomes the current one."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        new = Entry(len(self.entries) + 1, parent, label, nrmse, now, command)
        return History((*self.entries, new), new.number)

    @property
    def as_json(self) -> dict[str, Any]:
        """The content of ``history.json``."""
        entries = [{**asdict(entry), "file": entry.file} for entry in self.entries]
        return {"current": self.current, "entries": entries}


def read_history(out: Path) -> History:
    """The history of a results folder; empty where it has none.

    Args:
        out: the folder.

    Raises:
        InputError: the index is damaged.
    """
    path = out / FOLDER / INDEX
    if not path.exists():
        return History()
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        entries = tuple(
            Entry(**{key: value for key, value in entry.items() if key != "file"}) for entry in content["entries"]
        )
        history = History(entries, content["current"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise _damaged(path, str(error)) from error
    numbers = [entry.number for entry in entries]
    if numbers != list(range(1, len(entries) + 1)) or (history.current not in numbers and history != History()):
        raise _damaged(path, "its numbers do not fit together")
    return history


def _damaged(path: Path, reason: str) -> InputError:
    return InputError(
        f"{path}: {reason}",
        "the index of a history is written by this program alone",
        "restore it from a backup, or move the folder history away to begin anew",
    )


def check_history(out: Path) -> None:
    """Whether the history of a results folder can be read and added to, before there is something to add.

    Args:
        out: the folder.

    Raises:
        InputError: the index is damaged, or something is where it or the updated rig is to be written.
    """
    check_open(out, (UPDATED, f"{FOLDER}/{INDEX}"))
    read_history(out)


def remember(out: Path, stage: Path, models: Sequence[Model], *, like: Path, command: str) -> None:
    """Put models into the history and the last one into ``rig.updated.toml``.

    The first model is what the command was given: where the history holds the same rig already, the others follow it.

    Args:
        out: the results folder.
        stage: where its next files are being written.
        models: in the order of making.
        like: the rig file whose comments are kept.
        command: that made them.
    """
    history = read_history(out)
    (stage / FOLDER).mkdir(exist_ok=True)
    parent = _known(out, history, models[0].rig)
    for model in models[0 if parent is None else 1 :]:
        history = history.added(model.label, model.nrmse, parent, command)
        parent = history.current
        write_rig(model.rig, stage / FOLDER / history.entries[-1].file, like)
    history = replace(history, current=parent)
    write_rig(models[-1].rig, stage / UPDATED, like)
    (stage / FOLDER / INDEX).write_text(json_text(history.as_json), encoding="utf-8")


def _known(out: Path, history: History, rig: Rig) -> int | None:
    """The newest entry that holds this rig."""
    return next((e.number for e in reversed(history.entries) if _holds(out / FOLDER / e.file, rig)), None)


def _holds(path: Path, rig: Rig) -> bool:
    try:
        return read_rig(path) == rig
    except InputError:  # a file that somebody's editor left broken is kept all the same
        return False


def step_back(out: Path) -> Entry:
    """Make the model before the current one the updated rig; a file changed by hand is kept as an entry first.

    Args:
        out: the results folder.

    Returns:
        the entry that is now current.

    Raises:
        InputError: there is no history, or nothing before the current model.
    """
    history = some_history(out)
    with staged(out) as stage:
        (stage / FOLDER).mkdir()
        history = _with_hand_changes(out, stage, history)
        assert history.current is not None
        now = history.entry(history.current)
        if now.parent is None:
            raise InputError(
                f"{out}: the current model, {now.model}, is the first of its line",
                "a step back needs a model before",
                "testbed history shows all models that the folder keeps",
            )
        return _make_current(out, stage, history, now.parent)


def step_forward(out: Path) -> Entry:
    """Undo a step back: make the newest model that was made from the current one the updated rig.

    Args:
        out: the results folder.

    Returns:
        the entry that is now current.

    Raises:
        InputError: there is no history, or no model was made from the current one.
    """
    history = some_history(out)
    with staged(out) as stage:
        (stage / FOLDER).mkdir()
        history = _with_hand_changes(out, stage, history)
        later = [entry.number for entry in history.entries if entry.parent == history.current]
        if not later:
            raise InputError(
                f"{out}: nothing was made from the current model",
                "a step forward needs one that was stepped back from",
                "testbed history shows all models that the folder keeps",
            )
        return _make_current(out, stage, history, later[-1])


def some_history(out: Path) -> History:
    """The history of a results folder that must have one.

    Args:
        out: the folder.

    Raises:
        InputError: it has none, or the index is damaged.
    """
    history = read_history(out)
    if history.current is None:
        raise InputError(
            f"{out}: no history", "testbed diagnose and testbed add keep one in their --out folder", "name that folder"
        )
    return history


def _with_hand_changes(out: Path, stage: Path, history: History) -> History:
    """The history with the updated rig as a new entry, if somebody changed it since."""
    assert history.current is not None
    updated, kept = out / UPDATED, out / FOLDER / history.entry(history.current).file
    if not updated.exists() or updated.read_bytes() == kept.read_bytes():
        return history
    history = history.added(BY_HAND, None, history.current, "an editor")
    (stage / FOLDER / history.entries[-1].file).write_bytes(updated.read_bytes())
    return history


def _make_current(out: Path, stage: Path, history: History, number: int) -> Entry:
    entry = history.entry(number)
    (stage / UPDATED).write_bytes((out / FOLDER / entry.file).read_bytes())
    (stage / FOLDER / INDEX).write_text(json_text(replace(history, current=number).as_json), encoding="utf-8")
    return entry
