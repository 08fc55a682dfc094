"""Everything that is wrong with a rig file and its records, before anything is computed."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from models.effects import EFFECTS, build_effect
from models.errors import InputError
from models.plant import contact_of
from models.record import FrfRecord, Record
from models.rig import Rig
from models.rig_file import read_rig
from testbed.doubts import rig_doubts
from testbed.records.formats import read_file
from testbed.records.read import read_record
from testbed.records.units import check_sensitivities

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
        return f"{self.severity}: {self.file}: {self.text.removeprefix(f'{Path(self.file).name}: ')}"


def check_files(rig_path: Path, records: Sequence[Path], without: Sequence[str] = ()) -> list[Finding]:
    """All findings of all files; one line that a file is fine where there is none.

    Args:
        rig_path: the rig file.
        records: files.
        without: channels to leave out.
    """
    findings: list[Finding] = []
    rig = None
    try:
        rig = read_rig(rig_path)
        findings += [Finding(str(rig_path), "error", text) for text in _rig_faults(rig, rig_path)]
    except InputError as error:
        findings.append(Finding(str(rig_path), "error", str(error)))
    if rig is not None:
        findings += [Finding(str(rig_path), "finding", text) for text in rig_doubts(rig)]
    if not findings:
        assert rig is not None
        findings.append(Finding(str(rig_path), "fine", _rig_in_words(rig)))
    names = Counter(path.name for path in records)
    for path in records:
        found = list(_of_record(path, rig, without))
        if names[path.name] > 1:
            found.append(Finding(str(path), "error", f"{path.name} is the name of {names[path.name]} records"))
        findings += found
    return findings


def _rig_faults(rig: Rig, path: Path) -> Iterator[str]:
    """What reading alone does not see: sensitivities, laws and effects that the library does not have, or not there."""
    try:
        check_sensitivities(rig)
    except InputError as error:
        yield f"{path.name}: {error}"
    for sleeve in rig.sleeves:
        try:
            contact_of(sleeve)
        except InputError as error:
            yield f"{path.name}: {error}"
    for entry in rig.effects:
        try:
            build_effect(entry, rig, EFFECTS)
        except InputError as error:
            yield f"{path.name}: {error}"


def _rig_in_words(rig: Rig) -> str:
    parts = {"sleeve": len(rig.sleeves), "sensor": len(rig.sensors), "effect": len(rig.effects)}
    return f"{rig.structure.kind}; {', '.join(counted(n, noun) for noun, n in parts.items())}"


def counted(n: int, noun: str) -> str:
    """``1 file``, ``2 files``."""
    return f"{n} {noun}{'s' * (n != 1)}"


def _of_record(path: Path, rig: Rig | None, without: Sequence[str]) -> Iterator[Finding]:
    """Errors and findings of one record; of its format alone where the rig cannot be read."""
    file, strict_error = str(path), None
    try:
        if rig is None:
            read_file(path)
            yield Finding(file, "finding", "can be read; not held against the rig, whose file has errors")
            return
        try:
            record = read_record(path, rig, without=without)
        except InputError as error:
            strict_error = str(error)
            record = read_record(path, rig, without=without, strict=False)
    except InputError as error:
        yield Finding(file, "error", str(error))
        return
    if strict_error is not None:
        yield Finding(file, "error", strict_error)
    findings = record.findings if isinstance(record, Record) else ()
    # What a strict reading refuses, the other leaves out with a finding: one of the two is enough.
    told = [text for text in findings if strict_error is None or not text.endswith("; left out")]
    yield from (Finding(file, "finding", text) for text in told)
    if strict_error is None and not told:
        yield Finding(file, "fine", _record_in_words(record))


def _record_in_words(record: object) -> str:
    if isinstance(record, Record):
        start = "moving at its start" if record.moving_start else "from rest"
        return f"{counted(len(record.sensors), 'sensor')}, {record.duration:.3g} s at {record.fs:g} Hz, {start}"
    return "FRFs" if isinstance(record, FrfRecord) else "mode shapes"
