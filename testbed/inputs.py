"""What a command works on: a rig file and records, read once, with the digests by which a run is recognised."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from models.errors import InputError
from models.record import AnyRecord, Record
from models.rig import Rig
from testbed import __version__
from testbed.doubts import rig_doubts
from testbed.records.copies import is_same_test
from testbed.records.read import FirstModeError, UnusableChannelsError, read_record, unusable
from testbed.whole_rig import whole_rig


@dataclass(frozen=True, eq=False)
class Inputs:
    """A rig and its records.

    Attributes:
        rig_path: the rig file.
        rig: what it says.
        record_paths: all records, those kept aside last.
        records: to compare with or learn from.
        holdout: kept aside.
        digests: version, SHA-256 of every file's bytes, and the channels left out.
    """

    rig_path: Path
    rig: Rig
    record_paths: tuple[Path, ...]
    records: tuple[AnyRecord, ...]
    holdout: tuple[AnyRecord, ...]
    digests: dict[str, Any]

    @property
    def findings(self) -> tuple[str, ...]:
        """What is odd about the rig file, and what the reader noticed in the records."""
        timed = [record for record in (*self.records, *self.holdout) if isinstance(record, Record)]
        odd = [f"{self.rig_path.name}: {doubt}" for doubt in rig_doubts(self.rig)]
        return (*odd, *(finding for record in timed for finding in record.findings))


def read_inputs(
    rig_path: Path,
    records: Sequence[Path],
    holdout: Sequence[Path] = (),
    *,
    without: Sequence[str] = (),
    strict: bool = True,
) -> Inputs:
    """Read a rig and its records.

    Args:
        rig_path: the rig file.
        records: files.
        holdout: files kept aside.
        without: channels to leave out.
        strict: whether a dead, missing or implausible channel is an error.

    Raises:
        InputError: a file that cannot be used, two records of one name, or one that copies another.
    """
    rig = whole_rig(rig_path)
    check_names([*records, *holdout])
    read = _read_all(rig, rig_path, (*records, *holdout), without, strict=strict)
    learnt, aside = read[: len(records)], read[len(records) :]
    _check_learnt(learnt)
    _check_aside(learnt, aside)
    return Inputs(
        rig_path,
        rig,
        (*records, *holdout),
        learnt,
        aside,
        {
            "version": __version__,
            "rig": sha256(rig_path),
            "records": {path.name: sha256(path) for path in records},
            "holdout": {path.name: sha256(path) for path in holdout},
            "without": sorted(without),
        },
    )


def _check_learnt(learnt: Sequence[AnyRecord]) -> None:
    for record, other in combinations(learnt, 2):
        shared = set(record.sensors) & set(other.sensors)
        # Of one test each may hold channels that the other lacks: then neither is a copy.
        if len(shared) == min(len(record.sensors), len(other.sensors)) and is_same_test(record, other):
            raise InputError(
                f"{other.name}: the same samples as {record.name}",
                "every record is another test: one that is given twice would count as two",
                "leave one of them out",
            )


def _check_aside(learnt: Sequence[AnyRecord], aside: Sequence[AnyRecord]) -> None:
    for record in aside:
        copied = next((other.name for other in learnt if is_same_test(record, other)), None)
        if copied is not None:
            raise InputError(
                f"--holdout {record.name}: the same samples as {copied}",
                "a record kept aside is another test than those that are learnt from",
                "keep another record aside, or leave this one out",
            )


def _read_all(
    rig: Rig, rig_path: Path, paths: Sequence[Path], without: Sequence[str], *, strict: bool
) -> tuple[AnyRecord, ...]:
    """All records, or all channels that a strict reading refuses, so that one command can leave them out."""
    read, refused = [], []
    for path in paths:
        try:
            read.append(_read_beside(rig, rig_path, path, without, strict=strict))
        except UnusableChannelsError as error:
            refused.append(error)
    if refused:
        names = [name for error in refused for name in error.names]
        strangers = [name for error in refused for name in error.strangers]
        raise unusable("; ".join(error.given for error in refused), names, rig, without, strangers)
    return tuple(read)


def _read_beside(rig: Rig, rig_path: Path, path: Path, without: Sequence[str], *, strict: bool) -> AnyRecord:
    """A record; if it does not fit the rig and the rig file is odd, that is told too."""
    try:
        return read_record(path, rig, without=without, strict=strict)
    except UnusableChannelsError:
        raise
    except InputError as error:
        odd = next(rig_doubts(rig), None)
        if odd is None:
            raise
        see = f"{rig_path.name}: {odd}"
        of_rig = isinstance(error, FirstModeError)
        mend = f"see {see}; or else {error.mend}" if of_rig else f"{error.mend}; or see {see}"
        raise InputError(error.given, error.expected, mend) from None


def check_names(paths: Sequence[Path]) -> None:
    """Whether each record has a name of its own, by which results and reports call it.

    Raises:
        InputError: two have the same.
    """
    for name, number in Counter(path.name for path in paths).items():
        if number > 1:
            raise InputError(
                f"{name} is named {number} times",
                "each record is named once, and a record kept aside is not one to learn from",
                "name it once, or rename one of two different files",
            )


def sha256(path: Path) -> str:
    """Hexadecimal SHA-256 of a file's bytes."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
