"""``testbed crosscheck``: modal against MuJoCo against Exudyn."""

import sys
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Jobs, Out, RigFile, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed crosscheck rig.toml --out results/crosscheck"
MISSED = 1

Against = Annotated[
    list[str] | None,
    typer.Option("--against", metavar="NAME", help="Simulator; may be repeated; mujoco and exudyn unless given."),
]
OwnSeed = Annotated[int, typer.Option("--seed", min=0, help="Seed of the excitation's phases.")]


def crosscheck(
    rig: RigFile,
    *,
    against: Against = None,
    out: Out = None,
    seed: OwnSeed = 7,
    jobs: Jobs = 2,
    as_json: AsJson = False,
) -> None:
    """Modal against MuJoCo against Exudyn: crosscheck.json, a page and figures; status 1 if bounds are missed."""
    folder = out_folder(out, rig, "crosscheck.json", "README.md", "figures/")
    with progress() as tell:
        from testbed.crosscheck.run import run_crosscheck

        others, command = against or ["mujoco", "exudyn"], ["testbed", *sys.argv[1:]]
        content = run_crosscheck(rig, others, folder, seed=seed, jobs=jobs, command=command, progress=tell)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
    else:
        rows = [
            (m["rig"], m["quantity"], m["simulator"], m["value"], m["bound"], m["unit"], m["holds"])
            for m in content["measures"]
        ]
        print_table(("rig", "quantity", "against", "difference", "bound", "unit", "holds"), rows)
        say(f"written: {folder}/README.md, crosscheck.json and figures")
    if not content["holds"]:
        raise typer.Exit(MISSED)
