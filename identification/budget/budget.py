"""The error budget of several records: what of each response a linear model, and what a perfect model, could reach."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.budget.modes import LevelChange, level_changes
from identification.budget.realisations import Level, levels_of
from identification.budget.split import Split, split_record
from identification.budget.unsplit import Unsplit, unsplit
from models.errors import InputError
from models.record import AnyRecord, Record


@dataclass(frozen=True, eq=False)
class Budget:
    """What the records say about themselves, before any model is blamed.

    Attributes:
        splits: records whose excitation repeats, in the order given.
        others: the others, with what can be said of them.
        levels: the first ones by level of excitation, from the lowest up.
        changes: the lowest level beside each higher one.
        excitation_unit: as findings write it.
    """

    splits: tuple[Split, ...]
    others: tuple[Unsplit, ...]
    levels: tuple[Level, ...]
    changes: tuple[LevelChange, ...]
    excitation_unit: str

    def split_of(self, name: str) -> Split | None:
        """The split of the record of that name, None where it does not split."""
        return next((split for split in self.splits if split.record.name == name), None)

    def findings(self) -> tuple[str, ...]:
        """The budget in an engineer's words."""
        from identification.budget.words import findings_of

        return findings_of(self)


def budget_of(records: Sequence[AnyRecord], excitation_unit: str = "") -> Budget:
    """Split the records' responses into what a linear rig answers, distortion, noise, transient and time variation.

    A record that does not repeat is no error: the budget says what it can tell and what not.

    Args:
        records: of one rig, of any kind; those of several levels and realisations are compared.
        excitation_unit: for the findings.

    Raises:
        InputError: there is no record.

    Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), chapters 4 and 6; for
    the reading, P. Z. Csurcsia, B. Peeters, J. Schoukens, User-friendly nonlinear nonparametric estimation framework
    for vibro-acoustic industrial measurements with multiple inputs, MSSP 145 (2020) 106926.
    """
    if not records:
        raise InputError("no record", "a budget is of one record at least", "name a record")
    splits: list[Split] = []
    others: list[Unsplit] = []
    for record in records:
        split = split_record(record) if isinstance(record, Record) and np.any(record.responses) else None
        if split is None:
            others.append(unsplit(record))
        else:
            splits.append(split)
    levels = levels_of(splits)
    return Budget(tuple(splits), tuple(others), levels, level_changes(levels), excitation_unit)
