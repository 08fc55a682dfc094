"""Reported cases diagnosed again: what a change of the diagnosis has lost and mended, and what a case takes now."""

import json
import shlex
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

import identification
import models
from identification.progress import Progress
from models.errors import InputError
from testbed.hidden_effects.again_page import again_page, again_summary
from testbed.hidden_effects.bars import threads_of
from testbed.hidden_effects.case_run import run_case
from testbed.hidden_effects.crew import RunCase, Workers
from testbed.hidden_effects.newest import newest_of
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.run import CASES, cases_of, finished_in, run_missing, write_page
from testbed.hidden_effects.scores import class_of, in_a_line
from testbed.hidden_effects.sets import SETS
from testbed.outputs import Json


def evenly(results: Path) -> list[Json]:
    """The newest cases that are enough by themselves, in an order each beginning of which is spread over their mix.

    They are sorted by class and kind, and every n-th is taken for ever smaller n, so that nothing is left to choose.
    Those of a batch that is still open count where no other is: each one more would move the order.

    Args:
        results: folder that ``testbed benchmark hidden-effects`` wrote.

    Raises:
        InputError: a folder without finished cases of a batch, or with those of two sets.
    """
    finished = finished_in(results)
    cases = [case for case in finished if case["seed"] in SETS[case["set"]].batches]
    if not cases:
        raise InputError(
            f"{results}: {len(finished)} finished cases, none of a batch that counts",
            "a folder of testbed benchmark hidden-effects, with cases of today's batches",
            "name the folder that holds cases/ and summary.json, or run that benchmark first",
        )
    sets = sorted({case["set"] for case in cases})
    if len(sets) > 1:
        raise InputError(
            f"{results}: cases of the sets {' and '.join(sets)}",
            "cases of one set",
            "keep each set in a folder of its own, as testbed benchmark hidden-effects does unless told otherwise",
        )
    batches = SETS[sets[0]].batches
    closed = {seed for seed, batch in batches.items() if batch.cases is not None}
    newest = newest_of([case for case in cases if case["seed"] in closed] or cases, batches)
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


def stamp() -> str:
    """A digest of the code that makes a diagnosis: the models and the identification."""
    digest = sha256()
    for package in (models, identification):
        for file in sorted(Path(package.__path__[0]).rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def run_stamped(task: Task, threads: int = 1) -> Json:
    """A case as ``run_case`` runs it, with the stamp of what diagnosed it.

    Args:
        task: the case.
        threads: of the diagnosis.
    """
    return run_case(task, threads) | {"stamp": stamp()}


def run_again(
    reported: Sequence[Json],
    results: Path,
    out: Path,
    workers: Workers,
    *,
    threads: int,
    command: Sequence[str],
    progress: Progress,
    run: RunCase = run_stamped,
) -> Json:
    """Diagnose the cases that are not there yet, then write what came of all that are asked for.

    Args:
        reported: cases as they were reported.
        results: their folder.
        out: folder of the results, of one diagnosis on one number of threads.
        workers: who runs them.
        threads: of each diagnosis.
        command: as typed, for the page.
        progress: told of each case.
        run: what a case is run by; tests give a quick one.

    Returns:
        the content of ``summary.json``.

    Raises:
        InputError: a folder that cannot be written, that of the reported cases, or one that holds other diagnoses.
    """
    _refuse_others(results, out, threads)
    tasks = [Task.of(case) for case in reported]
    run_missing(tasks, out, workers, run, threads=threads, progress=progress, line=in_a_line)
    summary = again_summary(reported, cases_of(out, tasks))
    write_page(out, summary, again_page(summary, shlex.join(command)))
    return summary


def _refuse_others(results: Path, out: Path, threads: int) -> None:
    if out.resolve() == results.resolve():
        raise InputError(
            f"--out {out}: the folder of the reported cases",
            "cases that are diagnosed again go into a folder of their own",
            "name another one, such as results/again",
        )
    expected = stamp(), threads
    for file in sorted((out / CASES).glob("*.json")):
        case = json.loads(file.read_text(encoding="utf-8"))
        if "failure" not in case and _made_by(case) != expected:
            raise InputError(
                f"{file}: another diagnosis, or one on another number of threads",
                f"in one folder cases of one diagnosis, today's, on {threads_of({'threads': [threads]})}",
                "name another folder with --out, or remove this one",
            )


def _made_by(case: Json) -> tuple[str, int] | None:
    """The stamp of the diagnosis and its threads; None where it was made by another command."""
    return (case["stamp"], case["seconds"]["threads"]) if "stamp" in case else None
