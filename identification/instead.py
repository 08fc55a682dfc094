"""Another law in the place of one that is not established, where it explains the records as well.

A law with more numbers bends itself to what a simpler one does, and then the records tell none of them. Taken out, it
leaves all of the misfit again; but what it stood for was weighed beside it, in the same round.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

from identification.acceptance import comes_as_near
from identification.evidence import SIMPLER, Ranked
from identification.exchange import fit_at
from identification.fit import Fit
from identification.session import Session


@dataclass(frozen=True, eq=False)
class Instead:
    """A model with another law in an effect's place.

    Attributes:
        fit: of the model.
        ranked: the effect's round, with the other law first.
    """

    fit: Fit
    ranked: list[Ranked]


def instead_of(
    session: Session, calibrated: Fit, found: Fit, index: int, ranked: Sequence[Ranked], asked: Sequence[str]
) -> Instead | None:
    """The best other law of an effect's round with which the model comes as near to the records; None where none does.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        found: with the effect that is not established.
        index: of that effect.
        ranked: its round.
        asked: kinds that were found not to be established.
    """
    effects = found.hypothesis.effects
    for row in ranked:
        if not row.refitted or row.effect.kind in asked:
            continue
        others = (*effects[:index], row.effect, *effects[index + 1 :])
        try:
            now = fit_at(session, calibrated, replace(row.fit.hypothesis, effects=others), polished=True)
        except ArithmeticError:
            continue
        if comes_as_near(now, found):
            first = replace(row, fit=now, effect=now.hypothesis.effects[index])
            return Instead(now, _ordered(first, [other for other in ranked if other is not row], asked))
    return None


def _ordered(first: Ranked, others: Sequence[Ranked], asked: Sequence[str]) -> list[Ranked]:
    """The rows with this one first: what is not established has the odds of a number that is not needed, at most."""
    most = first.log_evidence - log(SIMPLER)
    rows = [
        replace(row, log_evidence=min(row.log_evidence, most)) if row.effect.kind in asked else row for row in others
    ]
    return [first, *sorted(rows, key=lambda row: -row.log_evidence)]
