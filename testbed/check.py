"""Everything that is wrong with a rig file and its records, before anything is computed."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from models.errors import InputError
from models.record import AnyRecord, FrfRecord, Record
from models.rig import Rig
from models.rig_file import read_rig
from testbed.doubts import rig_doubts
from testbed.records.formats import read_file
from testbed.records.levels import Level, levels_of
from testbed.records.read import resolved
from testbed.records.recording import AnyRecording, Recording
from testbed.whole_rig import rig_faults

Severity = Literal["error", "finding", "fine"]


@dataclass(frozen=True)
class Finding:
    """One thing about one file.

    Attributes:
        file: its path as given.
        severity: an ``error`` stops compare and diagnose, or compare alone; a ``finding`` does not.
        text: in words.
    """

    file: str
    severity: Severity
    text: str

    @property
    def line(self) -> str:
        """Severity, path and text, the file's name said once."""
        text = self.text
        for name in (self.file, Path(self.file).name):
            text = text.removeprefix(f"{name}: ").removeprefix(f"{name} ")
        return f"{self.severity}: {self.file}: {text}"


@dataclass(frozen=True)
class Checked:
    """What was seen.

    Attributes:
        findings: of all files; one line that a file is fine where there is none.
        levels: of each channel of each time record that can be read.
    """

    findings: tuple[Finding, ...]
    levels: tuple[Level, ...]


def check_files(rig_path: Path, records: Sequence[Path], without: Sequence[str] = ()) -> Checked:
    """All findings of all files, and how each channel was read.

    Args:
        rig_path: the rig file.
        records: files.
        without: channels to leave out.
    """
    findings: list[Finding] = []
    levels: list[Level] = []
    rig = None
    try:
        rig = read_rig(rig_path)
        findings += [Finding(str(rig_path), "error", f"{rig_path.name}: {fault}") for fault in rig_faults(rig)]
    except InputError as error:
        findings.append(Finding(str(rig_path), "error", str(error)))
    if rig is not None:
        findings += [Finding(str(rig_path), "finding", text) for text in rig_doubts(rig)]
    if not findings:
        assert rig is not None
        findings.append(Finding(str(rig_path), "fine", _rig_in_words(rig)))
    names = Counter(path.name for path in records)
    for path in records:
        found, read = _of_record(path, rig, without)
        levels += read
        if names[path.name] > 1:
            found.append(Finding(str(path), "error", f"{path.name} is the name of {names[path.name]} records"))
        findings += found
    return Checked(tuple(findings), tuple(levels))


def _rig_in_words(rig: Rig) -> str:
    parts = {"sleeve": len(rig.sleeves), "sensor": len(rig.sensors), "effect": len(rig.effects)}
    return f"{rig.structure.kind}; {', '.join(counted(n, noun) for noun, n in parts.items())}"


def counted(n: int, noun: str) -> str:
    """``1 file``, ``2 files``."""
    return f"{n} {noun}{'s' * (n != 1)}"


def _of_record(path: Path, rig: Rig | None, without: Sequence[str]) -> tuple[list[Finding], tuple[Level, ...]]:
    """Errors, findings and levels of one record; errors of its format alone where the rig cannot be read."""
    file = str(path)
    try:
        held = read_file(path)
        if rig is None:
            return [Finding(file, "finding", "can be read; not held against the rig, whose file has errors")], ()
        record, refused = _leniently(held, rig, without)
    except InputError as error:
        return [Finding(file, "error", str(error))], ()
    found = [] if refused is None else [Finding(file, "error", refused)]
    findings = record.findings if isinstance(record, Record) else ()
    # What a strict reading refuses, the other leaves out with a finding: one of the two is enough.
    told = [text for text in findings if refused is None or not text.endswith("; left out")]
    found += [Finding(file, "finding", text) for text in told]
    if not found:
        found.append(Finding(file, "fine", _record_in_words(record)))
    return found, levels_of(held, rig, without) if isinstance(held, Recording) else ()


def _leniently(held: AnyRecording, rig: Rig, without: Sequence[str]) -> tuple[AnyRecord, str | None]:
    """The record, and what a strict reading refuses of it."""
    try:
        return resolved(held, rig, without=without), None
    except InputError as error:
        return resolved(held, rig, without=without, strict=False), str(error)


def _record_in_words(record: object) -> str:
    if isinstance(record, Record):
        start = "moving at its start" if record.moving_start else "from rest"
        return f"{counted(len(record.sensors), 'sensor')}, {record.duration:.3g} s at {record.fs:g} Hz, {start}"
    return "FRFs" if isinstance(record, FrfRecord) else "mode shapes"
