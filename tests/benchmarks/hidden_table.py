"""The table of the hidden-effect benchmark, from the files of its cases."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.hidden_cases import MANY, NOTHING

Json = dict[str, Any]

COMMAND = "python -m tests.benchmarks.hidden_effects"


def summarise(folder: Path) -> Json:
    """Write ``summary.json`` and ``README.md`` into the folder from the cases in it; the summary is returned.

    Args:
        folder: with one JSON file a case in ``cases``.
    """
    cases = [json.loads(file.read_text(encoding="utf-8")) for file in sorted((folder / "cases").glob("*.json"))]
    hidden = [case for case in cases if case["kind"] != NOTHING]
    nothing = [case for case in cases if case["kind"] == NOTHING]
    kinds = sorted({case["kind"] for case in hidden})
    summary: Json = {
        "command": " and ".join(f"{COMMAND} --seed {seed}" for seed in sorted({case["seed"] for case in cases})),
        "cases": len(cases),
        "hidden": _row(hidden),
        f"hidden, calibrated error below {MANY:g} times the noise": _row([c for c in hidden if _ratio(c) < MANY]),
        f"hidden, calibrated error {MANY:g} times the noise or more": _row([c for c in hidden if _ratio(c) >= MANY]),
        "nothing hidden": _row(nothing),
        "false_alarms": sum(case["judged"]["verdict"] == "missing_effect" for case in nothing if "judged" in case),
        "kinds": {kind: _row([case for case in hidden if case["kind"] == kind]) for kind in kinds},
        "pulls": pulls([case for case in hidden if "judged" in case and case["judged"]["right"]]),
        "misses": [_miss(case) for case in cases if "judged" not in case or not case["judged"]["right"]],
    }
    (folder / "summary.json").write_text(json.dumps(summary, indent=1), encoding="utf-8")
    (folder / "README.md").write_text(_page(summary), encoding="utf-8")
    return summary


def pulls(cases: list[Json]) -> list[float]:
    """Found less true over standard deviation of every number of the effects that were rightly named.

    Args:
        cases: right ones.
    """
    rows = []
    for case in cases:
        found = case["judged"]["found"]["parameters"]
        for name, truth in case["hidden"].items():
            if (
                name in found
                and isinstance(truth, float)
                and isinstance(found[name]["std"], float)
                and found[name]["std"]
            ):
                rows.append((found[name]["value"] - truth) / found[name]["std"])
    return rows


def _row(cases: list[Json]) -> Json:
    done = [case["judged"] for case in cases if "judged" in case]
    ratios = [case["holdout_ratio"] for case in done if case["holdout_ratio"] is not None]
    return {
        "cases": len(cases),
        "right": sum(case["right"] for case in done),
        "kind_right": sum(case["kind_right"] for case in done),
        "right_or_in_group": sum(case["grouped"] for case in done),
        "failed": len(cases) - len(done),
        "holdout_ratio_median": float(np.median(ratios)) if ratios else None,
        "holdout_ratio_worst": float(np.max(ratios)) if ratios else None,
        "seconds_median": float(np.median([case["seconds"] for case in done])) if done else None,
    }


def _ratio(case: Json) -> float:
    """Error of the calibrated model over the noise, as diagnosed, or as expected where the diagnosis failed."""
    nrmse = case["judged"]["calibrated_nrmse"] if "judged" in case else None
    return float(case["expected_ratio"] if nrmse is None or not case["floor"] else nrmse / case["floor"])


def _miss(case: Json) -> Json:
    about = {"case": case["case"], "hidden": case["hidden"], "ratio": _ratio(case)}
    if "judged" not in case:
        return about | {"failure": case["failure"]}
    judged = case["judged"]
    found = {key: value for key, value in (judged["found"] or {}).items() if key != "parameters"} or None
    calibrated = judged["calibrated_nrmse"] / case["floor"] if case["floor"] else None
    return about | {
        "calibrated_ratio": calibrated,
        "verdict": judged["verdict"],
        "found": found,
        "holdout_ratio": judged["holdout_ratio"],
    }


def _page(summary: Json) -> str:
    groups = [key for key, value in summary.items() if isinstance(value, dict) and key != "kinds"]
    rows = [(group, summary[group]) for group in groups]
    rows += [(f"`{kind}`", row) for kind, row in summary["kinds"].items()]
    lines = [
        "# Hidden effects",
        "",
        f"Written by `{summary['command']}`.",
        "",
        "Each case is another rig, a little off its drawing, simulated by the finite",
        "elements of `models/fine` with noise and, but for *nothing hidden*, one effect that the rig file lacks.",
        "*Right*: the effect added first is of the true kind and at the true place (within 5 % of the length, or in a",
        "group that the diagnosis calls indistinguishable); with nothing hidden, the verdict `complete`.",
        "*Held out*: error over noise of the updated model on a record that it has not seen.",
        "",
        "| | cases | right | right kind | right or in its group | held out, median | held out, worst | s, median |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [f"| {name} | " + " | ".join(_cells(row)) + " |" for name, row in rows if row["cases"]]
    far = np.abs(summary["pulls"])
    if len(far):
        lines += [
            "",
            f"Of the {len(far)} numbers of effects rightly named, {np.mean(far < 2.0):.0%} lie within two of their",
            f"standard deviations of the truth; the median distance is {np.median(far):.2g} of them.",
        ]
    lines += ["", f"False alarms: {summary['false_alarms']}.", "", "## Misses", ""]
    lines += [f"- {_in_words(miss)}" for miss in summary["misses"]] or ["None."]
    return "\n".join(lines) + "\n"


def _cells(row: Json) -> list[str]:
    numbers = [str(row[key]) for key in ("cases", "right", "kind_right", "right_or_in_group")]
    keys = ("holdout_ratio_median", "holdout_ratio_worst", "seconds_median")
    return numbers + ["" if row[key] is None else f"{row[key]:.3g}" for key in keys]


def _in_words(miss: Json) -> str:
    hidden = _effect_in_words(miss["hidden"])
    shown = "" if miss["hidden"] is None else f" ({miss['ratio']:.3g} times the noise)"
    if "failure" in miss:
        return f"`{miss['case']}`: {hidden}{shown} failed with {miss['failure']}"
    return f"`{miss['case']}`: {hidden}{shown}; {miss['verdict']}, found {_effect_in_words(miss['found'])}"


def _effect_in_words(effect: Json | None) -> str:
    if effect is None:
        return "nothing"
    place = next((f" at {effect[key]}" for key in ("sleeve", "position", "sensor") if effect.get(key) is not None), "")
    return f"{effect['kind']}{place}"
