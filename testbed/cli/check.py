"""``testbed check``: what is wrong with the files."""

from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, RigFile, Without

EXAMPLE = "Example: testbed check rig.toml sweep.uff burst.uff"

Records = Annotated[
    list[Path] | None,
    typer.Argument(metavar="RECORD", help="Records to hold against the rig.", show_default=False),
]


def check(rig: RigFile, records: Records = None, without: Without = None, as_json: AsJson = False) -> None:
    """Everything that is wrong with a rig file and its records, before anything is computed; exit status 2 if so."""
    from dataclasses import asdict

    from testbed.check import check_files, counted
    from testbed.cli.tables import print_json, say

    findings = check_files(rig, records or [], without or [])
    n_errors = sum(finding.severity == "error" for finding in findings)
    if as_json:
        print_json({"errors": n_errors, "findings": [asdict(finding) for finding in findings]})
    else:
        for finding in findings:
            say(finding.line)
        say(f"{counted(n_errors, 'error')} in {counted(1 + len(records or []), 'file')}")
    if n_errors:
        raise typer.Exit(2)
