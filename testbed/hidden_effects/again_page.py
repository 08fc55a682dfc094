"""What came of reported cases that were diagnosed again: kept, lost, mended, seconds, and a page in Markdown."""

from collections.abc import Iterator, Sequence
from math import isclose
from typing import Any

from testbed.hidden_effects.bars import threads_of
from testbed.hidden_effects.proposed_page import failures
from testbed.hidden_effects.scores import class_of, seconds, seconds_by_class
from testbed.outputs import Json

ABOUT = """\
Cases of the newest closed batches of the hidden-effect benchmark, spread over their classes and kinds as evenly as
their number allows, drawn again and diagnosed by one diagnosis, whose code has the stamp below. They were looked at
when they were reported, and the diagnosis was mended since: what is right here tells what a change has lost and mended,
not how good the diagnosis is on cases that nobody has seen. What a case takes tells of this diagnosis; the seconds on
the page of the benchmark are those of each batch's own.
"""

DRAWN = ("engine", "hidden", "rig", "built", "snr_db")
"""What two draws of a case have in common, if they are the same."""

DRAWN_OTHERWISE = "drawn_otherwise"

OUTCOMES = ("kept", "lost", "mended", "missed", DRAWN_OTHERWISE)
"""Right before and now, before alone, now alone, neither; another draw, which is not compared."""

SAME = 1e-3
"""Relative difference of numbers that are the same: sizes come from a search."""


def again_summary(reported: Sequence[Json], again: Sequence[Json]) -> Json:
    """The content of ``summary.json``.

    Args:
        reported: cases as they were reported, at least one.
        again: the same, done or failed, as their files hold them.
    """
    done = [case for case in again if "judged" in case]
    rows = [_row(old, new) for old, new in zip(reported, again, strict=True) if "judged" in new]
    return {
        "set": reported[0]["set"],
        "seeds": sorted({case["seed"] for case in reported}),
        "stamp": done[0]["stamp"] if done else None,
        "cases": len(again),
        **{outcome: [row["case"] for row in rows if row["outcome"] == outcome] for outcome in OUTCOMES},
        "failed": [{"case": case["case"], "failure": case["failure"]} for case in again if case not in done],
        "seconds": seconds(done),
        "seconds_by_class": seconds_by_class(done, done[0]["seconds"]["threads"] if done else 1),
        "rows": rows,
    }


def _outcome(old: Json, new: Json) -> str:
    if not all(is_same(old.get(key), new.get(key)) for key in DRAWN):
        return DRAWN_OTHERWISE
    if old["judged"]["right"]:
        return "kept" if new["judged"]["right"] else "lost"
    return "mended" if new["judged"]["right"] else "missed"


def is_same(one: Any, other: Any) -> bool:
    """Whether two plain values are the same but for the last digits of their numbers.

    Args:
        one: of a case's file.
        other: of another file of it.
    """
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(is_same(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(is_same, one, other))
    if isinstance(one, float) and isinstance(other, float | int):
        return isclose(one, other, rel_tol=SAME)
    return bool(one == other)


def _row(old: Json, new: Json) -> Json:
    return {
        "case": new["case"],
        "class": class_of(new),
        "outcome": _outcome(old, new),
        "reported": {**_judged(old), **old["seconds"]},
        "again": {**_judged(new), **new["seconds"]},
    }


def _judged(case: Json) -> Json:
    return {key: case["judged"][key] for key in ("right", "named")}


def again_page(summary: Json, command: str) -> str:
    """The page.

    Args:
        summary: content of ``summary.json``.
        command: that makes it again.
    """
    seeds = ", ".join(map(str, summary["seeds"]))
    about = f"Set `{summary['set']}`, seeds {seeds}; stamp of the code: {summary['stamp']}."
    lines = ["# Reported cases, diagnosed again", "", f"Made by `{command}`.", "", ABOUT, about, ""]
    lines += [*compared(summary), "", *_seconds(summary), "", "## One by one", "", *_rows(summary["rows"])]
    return "\n".join([*lines, *failures(summary["failed"])]) + "\n"


def compared(summary: Json) -> Iterator[str]:
    """What has become of the cases, a sentence a line.

    Args:
        summary: content of ``summary.json``.
    """
    kept, lost, mended, missed = (summary[key] for key in ("kept", "lost", "mended", "missed"))
    told = f": {_listed(lost)} not any more." if lost else "."
    yield f"Of {len(kept) + len(lost)} that were right when they were reported {len(kept)} still are{told}"
    told = f": {_listed(mended)}." if mended else "."
    yield f"Of {len(mended) + len(missed)} that were not {len(mended)} are right now{told}"
    if summary[DRAWN_OTHERWISE]:
        yield f"Drawn otherwise than they were reported, and not counted: {_listed(summary[DRAWN_OTHERWISE])}."
    if summary["failed"]:
        yield f"Failed: {_listed([row['case'] for row in summary['failed']])}."


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _seconds(summary: Json) -> Iterator[str]:
    taken = summary["seconds"]
    if not taken["cases"]:
        return
    yield f"| | cases | seconds of a diagnosis, median, {threads_of(taken)} |"
    yield "|---|---|---|"
    yield f"| all | {taken['cases']} | **{taken['median']:.3g}** |"
    for name, row in summary["seconds_by_class"].items():
        if row["cases"]:
            yield f"| {name} | {row['cases']} | {row['median']:.3g} |"


def _rows(rows: Sequence[Json]) -> Iterator[str]:
    yield "| case | as reported | seconds, threads | now | seconds, threads |"
    yield "|---|---|---|---|---|"
    for row in rows:
        cells = " | ".join(_cell(row[key]) for key in ("reported", "again"))
        yield f"| `{row['case']}` | {cells} |"


def _cell(stated: Json) -> str:
    mark = "right" if stated["right"] else f"**wrong**: {stated['named']}"
    return f"{mark} | {stated['diagnosis']:.0f}, {stated['threads']}"
