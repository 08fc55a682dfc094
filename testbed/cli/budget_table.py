"""The table of an error budget."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from testbed.cli.tables import NOT_KNOWN, print_table, say

PARTS = ("noise", "transient", "odd", "even", "odd_or_even", "time_variation")


def print_budget(content: Mapping[str, Any]) -> None:
    """The content of ``budget.json``: each part as a share of the sensor's rms, and the findings.

    Args:
        content: as written.
    """
    parts = [p for p in PARTS if any(_known(c["rms_of"].get(p)) for r in content["records"] for c in r["channels"])]
    modelled = any(c.get("model") for r in content["records"] for c in r["channels"])
    rows = []
    for record in content["records"]:
        for i, channel in enumerate(record["channels"]):
            row = [record["record"] if i == 0 else "", channel["sensor"], channel["rms"], channel["unit"]]
            row += [_share(channel["rms_of"].get(part), channel["rms"]) for part in parts]
            if modelled:
                model = channel.get("model") or {}
                row += [_share(model.get(key), channel["rms"]) for key in ("error", "possible", "nonlinear")]
            rows.append(row)
    heads = ["record", "sensor", "rms", "unit", *(part.replace("_", " ") for part in parts)]
    if modelled:
        heads += ["model's error", "a perfect model gains", "of it no linear one"]
    print_table(heads, rows, "rms of each part as a share of the sensor's")
    for finding in content["findings"]:
        say(f"- {finding}")


def _known(value: float | None) -> bool:
    return value is not None and isfinite(value)


def _share(value: float | None, rms: float | None) -> str:
    if value is None or rms is None or not _known(value) or not rms:
        return NOT_KNOWN
    return f"{value / rms:.2%}" if value > 0.0 else "none"
