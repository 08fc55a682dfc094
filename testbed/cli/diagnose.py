"""``testbed diagnose``: where the rig's model fails, what is missing, and the rig with it."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from testbed.cli.options import AsJson, Jobs, Out, Records, RigFile, Seed, Without, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed diagnose rig.toml sweep.uff burst.uff --holdout multisine.uff --out results/rig"

Holdout = Annotated[
    list[Path] | None,
    typer.Option(
        "--holdout", metavar="RECORD", help="Judge the updated model on this record; may be repeated.",
        show_default=False,
    ),
]  # fmt: skip
Alike = Annotated[
    bool, typer.Option("--alike", help="The same may be wrong with all sleeves: try it in all of them at once too.")
]
Within = Annotated[
    float | None,
    typer.Option(
        "--within", metavar="MINUTES", min=0.0,
        help="Begin no further search after so many minutes; what stands then is concluded.", show_default=False,
    ),
]  # fmt: skip
Again = Annotated[bool, typer.Option("--again", help="Repeat a run whose results are there already.")]


MOST_TOLD = 4
"""Findings on the files that are told in words before the work begins."""


def diagnose(
    rig: RigFile,
    records: Records,
    *,
    holdout: Holdout = None,
    out: Out = None,
    without: Without = None,
    seed: Seed = 0,
    jobs: Jobs = 2,
    alike: Alike = False,
    within: Within = None,
    again: Again = False,
    as_json: AsJson = False,
) -> None:
    """Find what the rig lacks, add it, refit, until the noise: diagnosis.json, rig.updated.toml, report.html."""
    diagnose_files(
        rig, records, holdout or [], out_folder(out, rig), without or [], seed=seed, jobs=jobs, again=again,
        as_json=as_json, alike=alike, within=within,
    )  # fmt: skip


def diagnose_files(
    rig: Path,
    records: list[Path],
    holdout: list[Path],
    out: Path,
    without: list[str],
    *,
    seed: int,
    jobs: int,
    again: bool,
    as_json: bool,
    alike: bool = False,
    within: float | None = None,
) -> dict[str, Any]:
    """Run the loop and print what it found; shared with ``demo``, which holds it against the truth."""
    with progress() as tell:
        from testbed.inputs import read_inputs
        from testbed.run import run_diagnosis

        inputs = read_inputs(rig, records, holdout, without=without, strict=False)
        for finding in inputs.findings[:MOST_TOLD]:
            tell(finding)
        if more := len(inputs.findings[MOST_TOLD:]):
            tell(f"and {more} more findings on the files, told with the result; testbed check shows them at once")
        command = ["testbed", *sys.argv[1:]]
        outcome = run_diagnosis(
            inputs, out, seed=seed, jobs=jobs, again=again, command=command, progress=tell, alike=alike, within=within
        )
    from testbed.cli.tables import print_diagnosis, print_json, say

    if as_json:
        print_json(outcome.diagnosis)
        return outcome.diagnosis
    print_diagnosis(outcome.diagnosis)
    if outcome.kept:
        say("an earlier run of the same rig, records, options and version; --again repeats it")
    say(f"report: {out}/report.html; updated rig: {out}/rig.updated.toml")
    if "excitation" in outcome.diagnosis["next_experiment"]:
        say(f"the next experiment as a file: {out}/next_experiment.toml")
    return outcome.diagnosis
