"""``testbed benchmark``: what the diagnosis is worth, on cases that nobody has seen."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from testbed.cli.options import AsJson, Out, out_folder
from testbed.cli.progress import progress

if TYPE_CHECKING:
    from testbed.hidden_effects.crew import Workers

EXAMPLE = "Example: testbed benchmark hidden-effects --set tuning --cases 20 --out results/tuning"
NEXT = "Example: testbed benchmark next-experiments results/hidden_effects --out results/next_experiments"
AGAIN = "Example: testbed benchmark again results/hidden_effects --cases 40 --jobs 1 --threads 2 --out results/again"
MISSED = 1

Results = Annotated[Path, typer.Argument(metavar="RESULTS", help="Folder that benchmark hidden-effects wrote.")]
Jobs = Annotated[
    int | None, typer.Option("--jobs", min=1, help="Cases at a time; all cores unless given.", show_default=False)
]
Threads = Annotated[int, typer.Option("--threads", min=1, help="Of each diagnosis.")]
Scheduler = Annotated[
    str | None, typer.Option("--scheduler", metavar="ADDRESS", help="Of a Dask cluster.", show_default=False)
]

benchmark = typer.Typer(help="What the diagnosis is worth, on random rigs.", no_args_is_help=True, epilog=EXAMPLE)


@benchmark.callback()
def _benchmarks() -> None:
    """What the diagnosis is worth, on random rigs."""


@benchmark.command("hidden-effects", epilog=EXAMPLE)
def hidden_effects(
    *,
    case_set: Annotated[
        Literal["tuning", "reported", "varied"],
        typer.Option("--set", help="Cases to tune on, to report, or of other tests; seeds and generators differ."),
    ] = "reported",
    cases: Annotated[int, typer.Option("--cases", min=1, help="The first so many of the order.")] = 200,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only", metavar="KIND", help="A kind, nothing, two or outside; may be repeated.", show_default=False
        ),
    ] = None,
    out: Out = None,
    jobs: Jobs = None,
    threads: Threads = 1,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
) -> None:
    """Hide effects in random rigs, diagnose, count; goes on where it was stopped; status 1 if a bar is missed."""
    named = Path("hidden_effects" if case_set == "reported" else f"hidden_effects_{case_set}")
    folder = out_folder(out, named, "README.md", "summary.json", "figures/", "cases/")
    with progress() as tell:
        from testbed.hidden_effects.plan import planned
        from testbed.hidden_effects.run import run_hidden_effects

        tasks = planned(case_set, cases, only or ())
        workers = _workers(jobs, threads, scheduler)
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


@benchmark.command("next-experiments", epilog=NEXT)
def next_experiments(
    results: Results,
    *,
    cases: Annotated[
        int | None, typer.Option("--cases", min=1, help="The first so many; all unless given.", show_default=False)
    ] = None,
    out: Out = None,
    jobs: Jobs = None,
    threads: Threads = 1,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
) -> None:
    """Carry out the tests proposed where a group was stated, diagnose again; status 1 where one misleads or fails."""
    folder = out_folder(out, Path("next_experiments"), "README.md", "summary.json", "cases/")
    with progress() as tell:
        from testbed.hidden_effects.proposed_run import run_next_experiments, with_a_group

        tasks = with_a_group(results)[:cases]
        command = ["testbed", *sys.argv[1:]]
        summary = run_next_experiments(
            tasks, folder, _workers(jobs, threads, scheduler), threads=threads, command=command, progress=tell
        )
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(summary)
    else:
        print_table(("outcome", "cases"), list(summary["outcomes"].items()))
        say(f"written: {folder}/README.md and summary.json; {summary['cases']} cases in {folder}/cases")
    if summary["outcomes"]["wrong"] or summary["failed"]:
        raise typer.Exit(MISSED)


@benchmark.command("again", epilog=AGAIN)
def again(
    results: Results,
    *,
    cases: Annotated[int, typer.Option("--cases", min=1, help="The first so many, spread over the mix.")] = 40,
    out: Out = None,
    jobs: Jobs = None,
    threads: Threads = 1,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
) -> None:
    """Diagnose the newest reported cases again; goes on where it stopped; status 1 where one is lost or fails."""
    folder = out_folder(out, Path("again"), "README.md", "summary.json", "cases/")
    with progress() as tell:
        from testbed.hidden_effects.again import evenly, run_again
        from testbed.hidden_effects.again_page import compared
        from testbed.hidden_effects.bars import threads_of

        reported, command = evenly(results)[:cases], ["testbed", *sys.argv[1:]]
        workers = _workers(jobs, threads, scheduler)
        summary = run_again(reported, results, folder, workers, threads=threads, command=command, progress=tell)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(summary)
    else:
        rows = [(name, row["cases"], row["median"]) for name, row in summary["seconds_by_class"].items()]
        all_rows = [*rows, ("all", summary["seconds"]["cases"], summary["seconds"]["median"])]
        print_table(("class", "cases", f"seconds, median, {threads_of(summary['seconds'])}"), all_rows)
        for line in compared(summary):
            say(line)
        say(f"written: {folder}/README.md and summary.json; {summary['cases']} cases in {folder}/cases")
    if summary["lost"] or summary["failed"]:
        raise typer.Exit(MISSED)


def _workers(jobs: int | None, threads: int, scheduler: str | None) -> "Workers":
    from testbed.hidden_effects.cluster import on_cluster
    from testbed.hidden_effects.crew import on_this_machine

    if scheduler is not None:
        return on_cluster(scheduler)
    return on_this_machine(jobs or max(1, (os.cpu_count() or 1) // threads))
