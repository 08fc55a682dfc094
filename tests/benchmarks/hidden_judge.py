"""Whether a diagnosis is right, from its JSON alone."""

from typing import Any

Json = dict[str, Any]

NEAR = 0.05
"""Positions closer than this share of the beam's length are the same."""


def judged(diagnosis: Json, truth: Json | None, sleeves: dict[str, float], length: float) -> Json:
    """What the table needs to know of one case.

    Args:
        diagnosis: as ``diagnosis.json``.
        truth: kind and place of the hidden effect, or None where nothing was hidden.
        sleeves: position of each sleeve, m from the clamp.
        length: of the beam, m.

    Returns:
        ``right``: the verdict, and the first effect's kind and place; ``kind_right``: the kind alone; ``grouped``:
        right, or the diagnosis says that it cannot tell its first effect from the true one; ``holdout_ratio``: error
        over noise on the record held out; ``calibrated_nrmse``: of the calibrated model on the records to learn from.
    """
    effects, groups = diagnosis["effects"], diagnosis["indistinguishable"]
    first = effects[0] if effects else None
    holdout = diagnosis["holdout"]
    scored: Json = {
        "verdict": diagnosis["verdict"],
        "found": first,
        "n_found": len(effects),
        "holdout_ratio": holdout["updated"] / holdout["noise_nrmse"] if holdout else None,
        "calibrated_nrmse": next((row["nrmse"] for row in diagnosis["error"] if row["model"] == "calibrated"), None),
        "seconds": diagnosis["seconds"],
    }
    if truth is None:
        right = diagnosis["verdict"] == "complete"
        return scored | {"right": right, "kind_right": right, "grouped": right}
    if first is None or diagnosis["verdict"] != "missing_effect":
        return scored | {"right": False, "kind_right": False, "grouped": False}
    together = [group for group in groups if any(_same(first, other, sleeves, length) for other in group)]
    named = [other for group in together for other in group]
    kind_right = first["kind"] == truth["kind"]
    grouped = any(_same(truth, other, sleeves, length) for other in (first, *named))
    same_kind = [other for other in named if other["kind"] == first["kind"]]
    right = kind_right and any(_same(truth, other, sleeves, length) for other in (first, *same_kind))
    return scored | {"right": right, "kind_right": kind_right, "grouped": grouped}


def _same(one: Json, other: Json, sleeves: dict[str, float], length: float) -> bool:
    """The same kind at the same place; a sleeve is where it is."""
    if one["kind"] != other["kind"] or one.get("sensor") != other.get("sensor"):
        return False
    here, there = (_position(effect, sleeves) for effect in (one, other))
    if here is None or there is None:
        return here is there
    return abs(here - there) <= NEAR * length


def _position(effect: Json, sleeves: dict[str, float]) -> float | None:
    if effect.get("sensor") is not None:
        return None
    sleeve = effect.get("sleeve")
    return sleeves[sleeve] if sleeve is not None else effect.get("position")
