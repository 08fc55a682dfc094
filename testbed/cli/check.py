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
    from testbed.cli.tables import print_json, print_table, say

    checked = check_files(rig, records or [], without or [])
    n_errors = sum(finding.severity == "error" for finding in checked.findings)
    if as_json:
        findings, channels = (list(map(asdict, each)) for each in (checked.findings, checked.levels))
        print_json({"errors": n_errors, "findings": findings, "channels": channels})
    else:
        for finding in checked.findings:
            say(finding.line)
        if checked.levels:
            heads = ("record", "channel", "unit in the file", "times", "rms", "peak", "SI")
            rows = [(r.record, r.channel, r.label, r.factor, r.rms, r.peak, r.unit) for r in checked.levels]
            print_table(heads, rows, "channels as they were read; a unit in the file that is not theirs shows here")
        say(f"{counted(n_errors, 'error')} in {counted(1 + len(records or []), 'file')}")
    if n_errors:
        raise typer.Exit(2)
