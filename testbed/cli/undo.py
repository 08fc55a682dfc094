"""``testbed undo``: one model back, or forward again."""

from typing import Annotated

import typer

from testbed.cli.history import Folder

EXAMPLE = "Example: testbed undo results/rig; and forward again: testbed undo results/rig --redo"


def undo(out: Folder, redo: Annotated[bool, typer.Option("--redo", help="Take back an undo.")] = False) -> None:
    """Make the model before the current one rig.updated.toml; no model is ever deleted."""
    from testbed.cli.tables import say
    from testbed.history import step_back, step_forward

    entry = step_forward(out) if redo else step_back(out)
    error = "" if entry.nrmse is None else f", NRMSE {entry.nrmse:.3g}"
    say(f"{out}/rig.updated.toml is model {entry.number} again: {entry.model}{error}")
