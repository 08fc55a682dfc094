"""The benchmark over files: one file a case, written when it is done and kept, and the scores of all that are there."""

import json
import shlex
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path

from identification.progress import Progress
from models.errors import InputError
from testbed.figures.hidden_effects import figures_of
from testbed.figures.save import save
from testbed.hidden_effects.case_run import run_case
from testbed.hidden_effects.crew import RunCase, Workers
from testbed.hidden_effects.page import page_of
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.scores import in_a_line, summary_of
from testbed.hidden_effects.sets import SETS
from testbed.outputs import Json, json_text, keep_json, staged

CASES, SUMMARY, PAGE, EXPLANATIONS = "cases", "summary.json", "README.md", "explanations.toml"


def run_hidden_effects(
    tasks: Sequence[Task],
    out: Path,
    workers: Workers,
    *,
    threads: int,
    command: Sequence[str],
    progress: Progress,
    run: RunCase = run_case,
) -> Json:
    """Run the cases that are not there yet, then write the scores of all cases of the set in the folder.

    Cases of any batch of the set count beside those that are asked for; those of a seed that is none do not.

    Args:
        tasks: cases of one set.
        out: folder of the results; a person may explain cases in its ``explanations.toml``.
        workers: who runs them.
        threads: of each diagnosis.
        command: as typed, for the page.
        progress: told of each case.
        run: what a case is run by; tests give a quick one.

    Returns:
        the content of ``summary.json``.

    Raises:
        InputError: a folder that cannot be written, or explanations that are not TOML.
    """
    explained = explanations(out)
    run_missing(tasks, out, workers, run, threads=threads, progress=progress, line=in_a_line)
    case_set = tasks[0].case_set
    files = [json.loads(file.read_text(encoding="utf-8")) for file in sorted((out / CASES).glob(f"{case_set}-*.json"))]
    cases = [case for case in files if case.get("seed") in SETS[case_set].batches]
    summary = summary_of(cases, case_set)
    with staged(out) as stage:
        (stage / SUMMARY).write_text(json_text(summary), encoding="utf-8")
        (stage / PAGE).write_text(page_of(summary, explained, shlex.join(command)), encoding="utf-8")
        for name, figure in figures_of(summary):
            save(figure, stage / "figures", name)
    return summary


def run_missing(
    tasks: Sequence[Task],
    out: Path,
    workers: Workers,
    run: RunCase,
    *,
    threads: int,
    progress: Progress,
    line: Callable[[Json], str],
) -> None:
    """Run the cases that are not there yet; each is kept as soon as it is done.

    Args:
        tasks: cases that are asked for.
        out: folder of the results.
        workers: who runs them.
        run: what a case is run by.
        threads: of each diagnosis.
        progress: told of each case.
        line: a case as the progress tells it.
    """
    todo = [task for task in tasks if not is_done(path_of(out, task))]
    progress(f"{len(tasks) - len(todo)} of {len(tasks)} cases are there, {len(todo)} to do")
    for done, (task, case) in enumerate(workers(todo, run, threads) if todo else (), start=1):
        keep_json(path_of(out, task), case)
        progress(f"{done}/{len(todo)} {line(case)}")


def cases_of(out: Path, tasks: Sequence[Task]) -> list[Json]:
    """Cases that were run, as their files hold them.

    Args:
        out: folder of the results.
        tasks: the cases.
    """
    return [json.loads(path_of(out, task).read_text(encoding="utf-8")) for task in tasks]


def write_page(out: Path, summary: Json, page: str) -> None:
    """Write ``summary.json`` and the page, both or neither.

    Args:
        out: folder of the results.
        summary: content of the one.
        page: content of the other.

    Raises:
        InputError: a folder that cannot be written.
    """
    with staged(out) as stage:
        (stage / SUMMARY).write_text(json_text(summary), encoding="utf-8")
        (stage / PAGE).write_text(page, encoding="utf-8")


def finished_in(results: Path) -> list[Json]:
    """The cases of a folder of results that came to a diagnosis.

    Args:
        results: folder that ``run_hidden_effects`` wrote.
    """
    cases = [json.loads(file.read_text(encoding="utf-8")) for file in sorted((results / CASES).glob("*.json"))]
    return [case for case in cases if "judged" in case]


def path_of(out: Path, task: Task) -> Path:
    """The file of a case.

    Args:
        out: folder of the results.
        task: the case.
    """
    return out / CASES / f"{task.name}.json"


def is_done(path: Path) -> bool:
    """Whether a case is there; one that failed is tried again.

    Args:
        path: of its file.
    """
    if not path.exists():
        return False
    case = json.loads(path.read_text(encoding="utf-8"))
    return "failure" not in case


def explanations(out: Path) -> dict[str, str]:
    """Why cases were missed, as a person wrote it: case name -> text; empty where nobody did.

    Args:
        out: folder of the results.

    Raises:
        InputError: the file is not TOML with a text for each case.
    """
    file = out / EXPLANATIONS
    if not file.exists():
        return {}
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(
            f"{file}: {error}", 'lines like reported-13903-nothing-3 = "why"', "correct it there"
        ) from error
    for name, text in content.items():
        if not isinstance(text, str):
            raise InputError(f"{file}: {name} = {text!r}", "an explanation is a text", 'write it in quotes: "why"')
    return content
