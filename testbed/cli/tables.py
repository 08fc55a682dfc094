"""Results as tables on standard output."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from testbed.outputs import json_text

NOT_KNOWN = "-"


def print_table(columns: Sequence[str], rows: Iterable[Sequence[Any]], title: str | None = None) -> None:
    """Print rows; numbers with three digits, what is not known as a dash.

    Args:
        columns: heads.
        rows: one value a column.
        title: above the table.
    """
    table = Table(*columns, title=title, title_justify="left")
    for row in rows:
        table.add_row(*(shown(value) for value in row))
    say(table)


def say(what: Any) -> None:
    """Print a text or a table, as wide as it is where nobody watches."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=160)
    console.print(what, markup=False, soft_wrap=isinstance(what, str))


def print_json(content: Mapping[str, Any]) -> None:
    """Print JSON as it stands in the files.

    Args:
        content: of the file.
    """
    print(json_text(content), end="")


def shown(value: Any) -> str:
    """A value in a table's cell."""
    if value is None:
        return NOT_KNOWN
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple | list):
        return ", ".join(shown(item) for item in value)
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def print_comparison(content: Mapping[str, Any]) -> None:
    """The content of ``compare.json``.

    Args:
        content: as written.
    """
    keys = ("nrmse", "noise_nrmse", "mre", "frac", "csac", "csf")
    rows = []
    for record in content["records"]:
        rows.append([record["record"], "all", record["nrmse"], record["noise_nrmse"], *[None] * 4])
        rows += [["", channel["sensor"], *(channel[key] for key in keys)] for channel in record["channels"]]
    print_table(("record", "sensor", *keys), rows)
    for record in content["records"]:
        if "modes" in record:
            rows = [list(mode.values()) for mode in record["modes"]]
            heads = ("measured [Hz]", "model [Hz]", "measured damping", "model damping", "MAC")
            print_table(heads, rows, title=record["record"])


def print_diagnosis(content: Mapping[str, Any]) -> None:
    """The content of ``diagnosis.json``: how the error fell, what was added, what else was judged.

    Args:
        content: as written.
    """
    print_table(("model", "NRMSE"), [(row["model"], row["nrmse"]) for row in content["error"]], "error")
    if content["holdout"]:
        print_table(("kept aside", "NRMSE"), list(content["holdout"].items()))
    effects = [
        (named(effect), effect["probability"], name, number["value"], number["std"], number["unit"])
        for effect in content["effects"]
        for name, number in effect["parameters"].items()
    ]
    if effects:
        print_table(("added", "probability", "parameter", "value", "std", "unit"), effects)
    judged = [(named(row), row["probability"], row["nrmse"]) for row in content["candidates"][:5]]
    if judged:
        print_table(("candidate", "probability", "NRMSE"), judged)
    for group in content["indistinguishable"]:
        say(f"cannot be told apart: {', '.join(named(effect) for effect in group)}")
    for finding in content["where"].get("findings", ()):
        say(f"note: {finding}")
    say(f"verdict: {content['verdict']}")


def named(effect: Mapping[str, Any]) -> str:
    """Kind and place of an effect in JSON: ``squeeze_film at sleeve 2``."""
    against = f" against {effect['against']}" if "against" in effect else ""
    if "sleeve" in effect:
        return f"{effect['kind']}{against} at {effect['sleeve']}"
    if "sensor" in effect:
        return f"{effect['kind']}{against} on {effect['sensor']}"
    return f"{effect['kind']}{against}" + (f" at {effect['position']:.3f} m" if "position" in effect else "")
