"""The proposed tests over files: one file a case, kept when it is done, and a page of all that are there."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from models.errors import InputError
from testbed.hidden_effects.crew import RunCase, Workers
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.proposed import run_proposed
from testbed.hidden_effects.proposed_page import promises_to_settle, proposed_page, proposed_summary
from testbed.hidden_effects.run import cases_of, finished_in, run_missing, write_page
from testbed.hidden_effects.sets import SETS
from testbed.outputs import Json


def with_a_group(results: Path) -> tuple[Task, ...]:
    """The cases in which the diagnosis stated a group: first those whose test was to settle it, the newest batch first.

    What a diagnosis of long ago could not tell apart, today's may; a law that holds the other one within it, no test
    tells from that, and the diagnosis says so.

    Args:
        results: folder that ``testbed benchmark hidden-effects`` wrote.

    Raises:
        InputError: a folder without cases, or none of them with a group.
    """
    cases = finished_in(results)
    grouped = [case for case in cases if case["judged"]["verdict"] == "missing_effect"]
    grouped = [case for case in grouped if case["diagnosis"]["indistinguishable"]]
    if not grouped:
        raise InputError(
            f"{results}: {len(cases)} finished cases, none with a stated group",
            "a folder of testbed benchmark hidden-effects, with cases in which effects cannot be told apart",
            "name the folder that holds cases/ and summary.json, or run that benchmark first",
        )
    order = {seed: number for each in SETS.values() for number, seed in enumerate(each.batches, 1)}

    def rank(case: Json) -> tuple[bool, int, str]:
        promised = promises_to_settle(case["diagnosis"].get("next_experiment", {}))
        return not promised, -order.get(case["seed"], 0), case["case"]  # last those of seeds put aside since

    return tuple(Task.of(case) for case in sorted(grouped, key=rank))


def run_next_experiments(
    tasks: Sequence[Task],
    out: Path,
    workers: Workers,
    *,
    threads: int,
    command: Sequence[str],
    progress: Progress,
    run: RunCase = run_proposed,
) -> Json:
    """Carry out the proposed tests of cases that are not there yet, then write what came of all that are asked for.

    Args:
        tasks: cases in which a group was stated.
        out: folder of the results.
        workers: who runs them.
        threads: of each diagnosis.
        command: as typed, for the page.
        progress: told of each case.
        run: what a case is run by; tests give a quick one.

    Returns:
        the content of ``summary.json``.

    Raises:
        InputError: a folder that cannot be written.
    """
    run_missing(tasks, out, workers, run, threads=threads, progress=progress, line=_line)
    summary = proposed_summary(cases_of(out, tasks))
    write_page(out, summary, proposed_page(summary, shlex.join(command)))
    return summary


def _line(case: Json) -> str:
    return f"{case['case']}: {case.get('failure', case.get('outcome'))}"
