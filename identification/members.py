"""Before a group is stated, its members are fitted: what was judged beside other effects may owe its place to that."""

from collections.abc import Sequence
from dataclasses import replace

from identification.evidence import Ranked, misfit_in_common
from identification.fit import Fit
from identification.hypothesis import effect_unknowns
from identification.in_its_place import refit
from identification.outcome import members_of
from identification.session import Session
from models.effects import Effect

MOST_FITTED = 3
"""Members fitted, the most probable first: a group of more tells nobody where to look."""


def with_members_fitted(session: Session, ranked: Sequence[Ranked]) -> list[Ranked]:
    """A round of whose members the most probable were fitted with all numbers, beside the first one's other effects.

    The evidence of one that was not is an earlier round's; it has no more afterwards than its fit leaves it. A member
    of which no fit stands is as it was.

    Args:
        session: with the records, told.
        ranked: the round, its effect first.
    """
    first, rows, unit = ranked[0], list(ranked), misfit_in_common(ranked)
    for row in [row for row in members_of(ranked) if not row.refitted][:MOST_FITTED]:
        found = _fitted(session, first, row.effect)
        if found is None or found.n_data != first.fit.n_data:
            continue
        behind = max(0.0, found.chi2 - first.fit.chi2) / unit
        evidence = min(row.log_evidence, first.log_evidence - 0.5 * behind)
        rows[rows.index(row)] = replace(Ranked.of(found), log_evidence=evidence)
    return [first, *sorted(rows[1:], key=lambda row: -row.log_evidence)]


def _fitted(session: Session, first: Ranked, effect: Effect) -> Fit | None:
    """A fit of another effect in the first one's place; None where the model leaves the finite numbers."""
    session.progress(f"refitting {effect.label()}, which cannot be excluded, with all numbers")
    others = first.fit.hypothesis.without_effect(first.fit.hypothesis.effects.index(first.effect))
    of_the_rest = tuple(unknown for unknown in first.fit.unknowns if getattr(unknown, "effect", -1) < 0)
    base = replace(first.fit, unknowns=(*of_the_rest, *effect_unknowns(others)))
    return refit(session.fitting, base, others.with_effects(effect))
