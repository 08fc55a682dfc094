"""``testbed history``: the models that a results folder has held."""

from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson

EXAMPLE = "Example: testbed history results/rig"

Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of results (--out).", show_default=False)]


def history(out: Folder, as_json: AsJson = False) -> None:
    """Print the models that a results folder has held, with their errors and the commands that made them."""
    from testbed.cli.tables import print_json, print_table
    from testbed.history import some_history

    found = some_history(out)
    if as_json:
        print_json(found.as_json)
        return
    rows = [
        ("->" if e.number == found.current else "", e.number, e.parent, e.model, e.nrmse, e.time, e.command)
        for e in found.entries
    ]
    print_table(("now", "number", "made from", "model", "NRMSE", "time", "command"), rows)
