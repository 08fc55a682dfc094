"""``testbed simulate``: a virtual test with virtual sensors."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from testbed.cli.options import AsJson, Jobs, Out, RigFile, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed simulate rig.toml multisine.toml --with mujoco --out records"

ExperimentFile = Annotated[
    Path,
    typer.Argument(metavar="EXPERIMENT", help="Experiment (TOML); see docs/experiments.md.", show_default=False),
]
With = Annotated[str, typer.Option("--with", metavar="NAME", help="Simulator: modal, mujoco or exudyn.")]
Format = Annotated[Literal["uff", "h5"], typer.Option("--format", help="Of the records.")]
Parts = Annotated[
    int | None,
    typer.Option("--parts", min=4, max=1000, help="Modes, segments or elements; chosen and explained unless given."),
]
Steps = Annotated[
    int | None, typer.Option("--steps", min=1, help="Steps per sample; chosen and explained unless given.")
]
TruthFile = Annotated[
    Path | None,
    typer.Option("--truth", metavar="FILE", help="Test the rig of an earlier virtual test, whose truth.toml this is."),
]
Prefix = Annotated[str, typer.Option("--prefix", metavar="TEXT", help="Before the names of the records.")]
OwnSeed = Annotated[
    int | None,
    typer.Option("--seed", min=0, help="Seed of every random choice; the experiment's own unless given."),
]
Spatial = Annotated[
    bool, typer.Option("--spatial", help="Let the beam leave the rig's plane, in sleeves that are round.")
]


def simulate(
    rig: RigFile,
    experiment: ExperimentFile,
    *,
    using: With = "modal",
    out: Out = None,
    form: Format = "uff",
    parts: Parts = None,
    steps: Steps = None,
    spatial: Spatial = False,
    truth: TruthFile = None,
    prefix: Prefix = "",
    seed: OwnSeed = None,
    jobs: Jobs = 2,
    as_json: AsJson = False,
) -> None:
    """Carry out a virtual test: records, truth.toml, simulation.json and figures of the contacts."""
    folder = out_folder(out, experiment, "simulation.json", "truth.toml", "figures/")
    with progress() as tell:
        from models.simulators.protocol import Resolution
        from testbed.simulate_run import Order, run_experiment

        order = Order(
            rig, experiment, using, Resolution(parts, steps, spatial=spatial), f".{form}", truth, prefix, seed
        )
        content = run_experiment(order, folder, jobs=jobs, progress=tell)
    from testbed.check import counted
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
        return
    for choice in content["records"][0]["choices"]:
        say(f"{using}: {choice}")
    rows = [
        (row["record"], c["sleeve"], c["impacts"], c["share_closed"], c["largest_force"], 1e3 * c["deepest"])
        for row in content["records"]
        for c in row["contacts"]
    ]
    heads = ("record", "sleeve", "impacts", "share closed", "largest force [N]", "deepest [mm]")
    if rows:
        print_table(heads, rows, "in the sleeves")
    worst = max(row["energy_fault"] for row in content["records"])
    say(f"energy that nobody accounts for: {worst:.2g} of what was moved, at most")
    for line in clipped_lines(content):
        say(line)
    files = f"{folder}/truth.toml{', simulation.json and figures' if rows else ' and simulation.json'}"
    say(f"written: {counted(len(content['records']), 'record')}, {files}")


def clipped_lines(content: Mapping[str, Any]) -> list[str]:
    """A warning for each record in which sensors stand at the end of their range, and what to do about it.

    Args:
        content: of ``simulation.json``.
    """
    lines = []
    for row in content["records"]:
        clipped = row.get("clipped", ())
        if clipped:
            worst = max(clipped, key=lambda each: each["share"])
            others = [each["channel"] for each in clipped if each is not worst]
            besides = f" ({', '.join(others)} too)" if others else ""
            lines.append(
                f"warning: {row['record']}: {worst['channel']} is clipped at {worst['range']:.4g} {worst['unit']} in "
                f"{worst['share']:.1%} of its samples{besides}; check, compare and diagnose refuse such a record; "
                "lower the excitation's level, or give the sensor a larger range in [sensors]"
            )
    return lines
