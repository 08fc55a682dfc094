"""The error budget of a report: how the records split before any model is blamed, and what a model could still gain."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from identification.budget import budget_of
from identification.budget.gain import gain_of
from identification.budget.split import Cause, Split
from identification.result import Diagnosis, Stage
from models.arrays import FloatArray
from models.rig import Rig
from testbed.quantities import unit_of
from testbed.report.words import percent

CAUSES: tuple[Cause, ...] = ("odd", "even", "odd_or_even", "time_variation")


@dataclass(frozen=True)
class BudgetTable:
    """The budget of the records learned from.

    Attributes:
        causes: of distortion and change that some record tells of.
        rows: one of each record whose excitation repeats: its name, its parts, and two models' errors, as texts.
        findings: in an engineer's words, of the other records too.
    """

    causes: tuple[str, ...] = ()
    rows: tuple[Mapping[str, object], ...] = ()
    findings: tuple[str, ...] = ()


MOST_SAMPLES = 4_000_000
"""Of all channels together that a report splits: some 200 B each are held at once."""


def budget_table(diagnosis: Diagnosis, rig: Rig) -> BudgetTable | None:
    """The budget of the time records, None where there is none; no rows where no excitation repeats.

    Args:
        diagnosis: finished.
        rig: as its owner describes it.
    """
    records = [row.record for row in diagnosis.final.score.records]
    if not records:
        return None
    if sum(record.responses.size for record in records) > MOST_SAMPLES:
        return BudgetTable(findings=("The records are too long to be split here: testbed budget splits them.",))
    unit = unit_of(rig.excitation.quantity) if rig.excitation is not None else ""
    budget = budget_of(records, unit)
    told = [cause for cause in CAUSES if any(not np.isnan(s.shares[cause].total).all() for s in budget.splits)]
    rows: list[Mapping[str, object]] = [
        {
            "record": split.record.name,
            "noise": _share(split, split.noise.sum(axis=1)),
            "causes": [_part(split, cause) for cause in told],
            "models": [_model(split, stage) for stage in (diagnosis.calibrated, diagnosis.final)],
        }
        for split in budget.splits
    ]
    return BudgetTable(tuple(cause.replace("_", " ") for cause in told), tuple(rows), budget.findings())


def _model(split: Split, stage: Stage) -> Mapping[str, str]:
    """What a model misses of a record, and what of that a perfect one would not."""
    predicted = stage.score.of(split.record.name).predicted
    gain = gain_of(split, predicted)
    parts = {"error": gain.error, "possible": gain.possible, "nonlinear": gain.nonlinear}
    return {name: _share(split, part.sum(axis=1)) for name, part in parts.items()}


def _part(split: Split, cause: Cause) -> str:
    """The part of a cause, where it is found."""
    share = split.shares[cause]
    if np.isnan(share.total).all():
        return "not told"
    found = np.where(share.found.any(axis=1), np.nan_to_num(share.total), 0.0)
    return _share(split, found) if found.any() else "not above chance"


def _share(split: Split, power: FloatArray) -> str:
    """(n,) mean squares as one share: each sensor's of its own, rms over the sensors."""
    whole = np.maximum(split.mean_square, np.finfo(float).tiny)
    return percent(float(np.sqrt(np.mean(power / whole))))
