"""Where a report comes from: enough to make it again."""

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from testbed import __version__
from testbed.inputs import sha256

LIBRARIES = ("numpy", "scipy", "numba")


@dataclass(frozen=True)
class Provenance:
    """What ran, on what.

    Attributes:
        command: as typed.
        date: ISO 8601, UTC.
        seed: of every random choice.
        versions: name -> version, this package's first.
        files: name -> SHA-256, the rig's first.
    """

    command: str
    date: str
    seed: int
    versions: tuple[tuple[str, str], ...]
    files: tuple[tuple[str, str], ...]


def provenance(rig_path: Path, record_paths: Sequence[Path], seed: int, command: str) -> Provenance:
    """The provenance of a run that happens now.

    Args:
        rig_path: the rig file.
        record_paths: all records, those kept aside too.
        seed: of every random choice.
        command: as typed.

    Raises:
        OSError: a file cannot be read.
    """
    return Provenance(
        command=command,
        date=datetime.now(UTC).isoformat(timespec="seconds"),
        seed=seed,
        versions=(
            ("clearance-testbed", __version__),
            ("Python", platform.python_version()),
            *((name, version(name)) for name in LIBRARIES),
        ),
        files=tuple((path.name, sha256(path)) for path in (rig_path, *record_paths)),
    )
