"""What came of reported cases that were diagnosed again: counts, seconds, and a page in Markdown."""

from collections.abc import Iterator, Sequence

from testbed.hidden_effects.bars import threads_of
from testbed.hidden_effects.scores import class_of, seconds, seconds_by_class
from testbed.outputs import Json

ABOUT = """\
Cases of the newest batches of the hidden-effect benchmark, spread evenly over their classes and kinds, drawn again and
diagnosed by the diagnosis as it is. They were looked at when they were reported, and the diagnosis was mended since:
what is right here tells that a change has kept what it could, not how good it is on cases that nobody has seen. What a
case takes tells of today's diagnosis; the seconds on the page of the benchmark are those of each batch's own.
"""


def again_summary(reported: Sequence[Json], again: Sequence[Json]) -> Json:
    """The content of ``summary.json``.

    Args:
        reported: cases as they were reported.
        again: the same, done or failed, as their files hold them.
    """
    pairs = list(zip(reported, again, strict=True))
    done = [case for case in again if "judged" in case]
    return {
        "cases": len(again),
        "right": {"reported": _right(reported), "again": _right(done)},
        "seconds": seconds(done),
        "seconds_by_class": seconds_by_class(done, max((case["seconds"]["threads"] for case in done), default=1)),
        "failed": [{"case": case["case"], "failure": case["failure"]} for case in again if case not in done],
        "rows": [_row(old, new) for old, new in pairs if "judged" in new],
    }


def _right(cases: Sequence[Json]) -> int:
    return sum(case["judged"]["right"] for case in cases)


def _row(old: Json, new: Json) -> Json:
    return {
        "case": new["case"],
        "class": class_of(new),
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
    lines = ["# Reported cases, diagnosed again", "", f"Made by `{command}`.", "", ABOUT, *_told(summary), ""]
    return "\n".join([*lines, "## One by one", "", *_rows(summary["rows"]), *_failed(summary["failed"])]) + "\n"


def _told(summary: Json) -> Iterator[str]:
    cases, right, taken = summary["cases"], summary["right"], summary["seconds"]
    yield f"Of {cases} cases {right['reported']} were right when they were reported, {right['again']} are now."
    if not taken["cases"]:
        return
    yield ""
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


def _failed(failed: Sequence[Json]) -> Iterator[str]:
    for row in failed:
        yield ""
        yield f"`{row['case']}` failed: {row['failure']}."
