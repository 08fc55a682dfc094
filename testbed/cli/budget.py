"""``testbed budget``: how the measured response splits, before any physics is blamed."""

from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Out, Records, Without, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed budget multisine_3.uff multisine_6.uff --rig rig.toml"

Rig = Annotated[
    Path | None,
    typer.Option("--rig", metavar="RIG", help="Name the sensors by this rig file, and split what it misses too."),
]
Names = Annotated[
    list[str] | None,
    typer.Option("--channel", metavar="NAME", help="Look at this channel; may be repeated; all unless named."),
]
Excitation = Annotated[
    str | None,
    typer.Option("--excitation", metavar="NAME", help="Channel of the excitation, without a rig; or the only force."),
]


def budget(
    records: Records,
    *,
    rig: Rig = None,
    channel: Names = None,
    excitation: Excitation = None,
    out: Out = None,
    without: Without = None,
    as_json: AsJson = False,
) -> None:
    """Noise, transient, odd and even distortion, time variation of each response: budget.json and figures."""
    folder = out_folder(out, records[0], "budget.json", "figures/")
    with progress() as tell:
        from testbed.budget.run import Order, run_budget

        order = Order(tuple(records), rig, tuple(channel or ()), excitation, tuple(without or ()))
        content = run_budget(order, folder, progress=tell)
    from testbed.cli.budget_table import print_budget
    from testbed.cli.tables import print_json, say

    if as_json:
        print_json(content)
        return
    print_budget(content)
    drawn = any(record["repeats"] for record in content["records"])
    say(f"written: {folder}/budget.json{' and figures' if drawn else '; no figures, since no record can be split'}")
