"""Reported cases diagnosed again: whether a change of the diagnosis keeps what it could, and what a case takes now."""

import json
import shlex
from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from models.errors import InputError
from testbed.hidden_effects.again_page import again_page, again_summary
from testbed.hidden_effects.case_run import run_case
from testbed.hidden_effects.crew import RunCase, Workers
from testbed.hidden_effects.newest import newest_of
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.run import PAGE, SUMMARY, finished_in, path_of, run_missing
from testbed.hidden_effects.scores import class_of, in_a_line
from testbed.hidden_effects.sets import SETS
from testbed.outputs import Json, json_text, staged


def evenly(results: Path) -> list[Json]:
    """The newest cases that are enough by themselves, in an order each beginning of which has the whole mix.

    Of the cases by class and kind, every n-th is taken for ever smaller n, so that it leaves nothing to choose.

    Args:
        results: folder that ``testbed benchmark hidden-effects`` wrote.

    Raises:
        InputError: a folder without finished cases of a set.
    """
    cases = [case for case in finished_in(results) if case["seed"] in SETS[case["set"]].batches]
    if not cases:
        raise InputError(
            f"{results}: no finished case of a set",
            "a folder of testbed benchmark hidden-effects",
            "name the folder that holds cases/ and summary.json, or run that benchmark first",
        )
    case_set = cases[0]["set"]
    newest = newest_of([case for case in cases if case["set"] == case_set], SETS[case_set].batches)
    newest.sort(key=lambda case: (class_of(case), case["kind"], case["seed"], case["number"]))
    return [newest[number] for number in bit_reversed(len(newest))]


def bit_reversed(n: int) -> list[int]:
    """The numbers from 0 to n - 1 in an order each beginning of which is spread over all of them.

    Source: J. G. van der Corput, Proc. Akad. Wet. Amsterdam 38 (1935) 813.

    Args:
        n: how many.
    """
    bits = max(n - 1, 0).bit_length()
    turned = (sum((number >> bit & 1) << (bits - 1 - bit) for bit in range(bits)) for number in range(1 << bits))
    return [number for number in turned if number < n]


def run_again(
    reported: Sequence[Json],
    out: Path,
    workers: Workers,
    *,
    threads: int,
    command: Sequence[str],
    progress: Progress,
    run: RunCase = run_case,
) -> Json:
    """Diagnose the cases that are not there yet, then write what came of all that are asked for.

    Args:
        reported: cases as they were reported.
        out: folder of the results, a new one for another diagnosis.
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
    tasks = [Task(case["set"], case["seed"], case["kind"], case["number"]) for case in reported]
    run_missing(tasks, out, workers, run, threads=threads, progress=progress, line=in_a_line)
    again = [json.loads(path_of(out, task).read_text(encoding="utf-8")) for task in tasks]
    summary = again_summary(reported, again)
    with staged(out) as stage:
        (stage / SUMMARY).write_text(json_text(summary), encoding="utf-8")
        (stage / PAGE).write_text(again_page(summary, shlex.join(command)), encoding="utf-8")
    return summary
