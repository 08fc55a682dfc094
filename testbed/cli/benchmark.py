"""``testbed benchmark``: what the diagnosis is worth, on cases that nobody has seen."""

import os
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from testbed.cli.options import AsJson, Out, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed benchmark hidden-effects --set tuning --cases 20 --out results/tuning"
MISSED = 1

benchmark = typer.Typer(help="What the diagnosis is worth, on random rigs.", no_args_is_help=True, epilog=EXAMPLE)


@benchmark.callback()
def _benchmarks() -> None:
    """What the diagnosis is worth, on random rigs."""


@benchmark.command("hidden-effects", epilog=EXAMPLE)
def hidden_effects(
    *,
    case_set: Annotated[
        Literal["tuning", "reported"],
        typer.Option("--set", help="Cases to tune on, or to report; seeds and generators differ."),
    ] = "reported",
    cases: Annotated[int, typer.Option("--cases", min=1, help="The first so many of the order.")] = 200,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only", metavar="KIND", help="A kind, nothing, two or outside; may be repeated.", show_default=False
        ),
    ] = None,
    out: Out = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", min=1, help="Cases at a time; all cores unless given.", show_default=False)
    ] = None,
    threads: Annotated[int, typer.Option("--threads", min=1, help="Of each diagnosis.")] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Of a Dask cluster.", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Hide effects in random rigs, diagnose, count; goes on where it was stopped; status 1 if a bar is missed."""
    folder = out_folder(out, Path("hidden_effects" if case_set == "reported" else "hidden_effects_tuning"))
    with progress() as tell:
        from testbed.hidden_effects.cluster import on_cluster
        from testbed.hidden_effects.crew import on_this_machine
        from testbed.hidden_effects.plan import planned
        from testbed.hidden_effects.run import run_hidden_effects

        tasks = planned(case_set, cases, only or ())
        at_a_time = jobs or max(1, (os.cpu_count() or 1) // threads)
        workers = on_this_machine(at_a_time) if scheduler is None else on_cluster(scheduler)
        command = ["testbed", *sys.argv[1:]]
        summary = run_hidden_effects(tasks, folder, workers, threads=threads, command=command, progress=tell)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(summary)
    else:
        rows = [
            (bar["name"], bar["value"], bar["bar"], bar["aim"], bar["met"], bar["cases"], newest["value"])
            for bar, newest in zip(summary["bars"], summary["newest"]["bars"], strict=True)
        ]
        print_table(("what", "reached", "bar", "aim", "met", "cases", "newest batches"), rows)
        say(f"written: {folder}/README.md, summary.json and figures; {summary['cases']} cases in {folder}/cases")
    if summary["missed"]:
        raise typer.Exit(MISSED)
