"""Results as tables on standard output."""

from collections.abc import Iterable, Mapping, Sequence
from math import floor, log10
from typing import Any

from rich.console import Console
from rich.table import Table

from models.effects import EFFECTS
from testbed.outputs import json_text

NOT_KNOWN = "-"

ONE_STD = "+- 1 std"
"""In the head of a column of what ``measured`` writes."""


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
    errors = [(row["model"], row["nrmse"], row["noise_nrmse"]) for row in content["error"]]
    print_table(("model", "NRMSE", "noise alone"), errors, "error")
    if content["holdout"]:
        rows = [("noise" if label == "noise_nrmse" else label, error) for label, error in content["holdout"].items()]
        print_table(("kept aside", "NRMSE"), rows)
    effects = [
        (named(effect), chance_of(effect["probability"]), *number)
        for effect in content["effects"]
        for number in _numbers(effect)
    ]
    if effects:
        print_table(("added", "probability", "parameter", f"value {ONE_STD}", "unit"), effects)
    judged = [(named(row), chance_of(row["probability"]), row["nrmse"]) for row in content["candidates"][:5]]
    if judged:
        others = " and ".join(named(effect) for effect in content["candidates_beside"])
        beside = f"{others} and the calibrated rig" if others else "the calibrated rig"
        print_table(("candidate", "probability", "NRMSE"), judged, f"first round, each beside {beside}")
    for group in content["indistinguishable"]:
        say(f"cannot be told apart by the records, tolerances aside: {', '.join(named(effect) for effect in group)}")
    _print_notes(content)
    say(f"verdict: {content['verdict']}")
    print_next(content["next_experiment"])


def _print_notes(content: Mapping[str, Any]) -> None:
    """What was noticed in files and records; then, apart, what only the model before its effects were added shows."""
    before = content["where"].get("of_calibrated", ())
    for finding in content["where"].get("findings", ()):
        if finding not in before:
            say(f"note: {finding}")
    if before:
        added = ", before the effects above were added: signs of what was missing, no faults of the result"
        say(f"the calibrated model{added if content['effects'] else ''}:")
        for finding in before:
            say(f"  - {finding.removeprefix('calibrated model: ')}")


def _numbers(effect: Mapping[str, Any]) -> list[tuple[str | None, str | None, str | None]]:
    """Name, value and unit of each; one empty row where it has none."""
    rows = effect["parameters"].items()
    return [(name, measured(number), number["unit"]) for name, number in rows] or [(None, None, None)]


def print_next(content: Mapping[str, Any]) -> None:
    """What to measure next.

    Args:
        content: ``next_experiment`` of ``diagnosis.json``.
    """
    keys = ("do", "minutes", "expected_probability", "separation", "confirmed")
    if "options" in content:
        rows = [[option[key] for key in keys] for option in content["options"]]
        print_table(("test", "minutes", "expected probability", "separation", "confirmed"), rows, "next experiment")
    say(f"next: {content['do']}: {content['why']}")


OPTIONS = sorted({key for kind in EFFECTS.values() for key in kind.options})
"""Keys by which kinds choose a variant."""

LEAST_CHANCE = 1e-4
"""Probabilities below it are all alike."""


def chance_of(probability: float) -> str:
    """A probability in a table's cell."""
    return f"< {LEAST_CHANCE:g}" if probability < LEAST_CHANCE else f"{probability:.3g}"


def measured(number: Mapping[str, Any]) -> str:
    """A fitted value and its standard deviation, to two digits of that: ``1.49814 +- 0.00057``.

    Args:
        number: with ``value`` and ``std``, numbers or lists of them.
    """
    value, std = number["value"], number["std"]
    if isinstance(value, list | tuple):
        stds = std if isinstance(std, list | tuple) else [std] * len(value)
        return ", ".join(measured({"value": v, "std": s}) for v, s in zip(value, stds, strict=True))
    if not std:
        return shown(value)
    digits = max(2, 2 + floor(log10(abs(value) or std)) - floor(log10(std)))
    return f"{value:.{digits}g} +- {std:.2g}"


def named(effect: Mapping[str, Any]) -> str:
    """Kind and place of an effect in JSON: ``squeeze_film at sleeve 2``."""
    against = "".join(f" {key} {effect[key]}" for key in OPTIONS if key in effect)
    if "sleeve" in effect:
        return f"{effect['kind']}{against} at {effect['sleeve']}"
    if "sensor" in effect:
        pair = f" and {effect['other']}" if "other" in effect else ""
        return f"{effect['kind']}{against} on {effect['sensor']}{pair}"
    return f"{effect['kind']}{against}" + (f" at {effect['position']:.3f} m" if "position" in effect else "")


def print_effects(content: Mapping[str, Any]) -> None:
    """The library of effects.

    Args:
        content: by kind, of ``testbed.effects_page.library``.
    """
    rows = [
        (
            kind,
            " or ".join(about["places"]) or NOT_KNOWN,
            "\n".join(f"{name} [{number['unit']}]" for name, number in about["parameters"].items()),
            "\n".join(f"{aspect}: {text}" for aspect, text in about["signature"].items()),
        )
        for kind, about in content.items()
    ]
    print_table(("kind", "place", "parameters", "where it shows"), rows)
