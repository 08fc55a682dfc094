"""What the beginnings of the records leave open, the whole of them may tell."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, log

from identification.evidence import Ranked, misfit_of, probabilities
from identification.fit import Fit
from identification.outcome import TELLABLE, undecided
from identification.session import Session


def told_by_all(session: Session, ranked: Sequence[Ranked], standing: Fit, index: int) -> list[Ranked]:
    """A round whose members that its records do not exclude have been held against all records.

    A round is judged on as much of the records as a search can afford. A member that fits all of them nearly as well as
    the model that stands is as it was; of another the chi-square and the evidence are those of all records: as far
    behind the first one's as there.

    Args:
        session: with the records.
        ranked: the round, its effect first.
        standing: the model that stands, fitted to a part of the records.
        index: of the round's effect in it.
    """
    first, rows = ranked[0], list(ranked)
    members = [row for row, _ in undecided(ranked, probabilities([row.log_evidence for row in ranked]))]
    doubtful = [row for row in members if row is not first and row.refitted and len(row.effect.parts()) == 1]
    if not doubtful or session.all_predicted.n_data <= session.fitting.n_data:
        return rows
    ended = session.to_the_end(standing)
    unit = misfit_of(ended)
    for row in doubtful:
        found = _on_all(session, row, ended, index, ended.chi2 + EXCLUDED * unit)
        if found is None or found < ended.chi2 + EXCLUDED * unit:
            continue
        session.decide(
            f"{row.effect.label()} explains {session.fitting.extent} as well as {first.effect.label()}, but not all "
            f"{session.all_predicted.extent}"
        )
        behind = found - ended.chi2
        fitted = replace(row.fit, chi2=first.fit.chi2 + behind)
        evidence = min(row.log_evidence, first.log_evidence - 0.5 * behind / unit)
        rows[rows.index(row)] = replace(row, fit=fitted, log_evidence=evidence)
    return [first, *sorted(rows[1:], key=lambda row: -row.log_evidence)]


EXCLUDED = 2.0 * log(1.0 / TELLABLE)
"""How much more chi-square, in units of the round's, a member leaves that is none (``outcome.undecided``)."""


def _on_all(session: Session, row: Ranked, ended: Fit, index: int, enough: float) -> float | None:
    """Chi-square of all records with a member in the place of the effect; None where no fit stands.

    Args:
        session: with the records.
        row: the member.
        ended: the model that stands, fitted to all records.
        index: of the effect in it.
        enough: chi-square below which no fit is needed.
    """
    effects = (*ended.hypothesis.effects[:index], row.effect, *ended.hypothesis.effects[index + 1 :])
    beside = replace(ended.hypothesis, effects=effects)
    starts = [beside, replace(beside, values=row.fit.hypothesis.values)]
    residuals = session.all_predicted.residuals([(start, None) for start in starts])
    costs = [inf if residual is None else float(residual @ residual) for residual in residuals]
    least = min(costs)
    if least < enough or least == inf:
        return least if least < inf else None
    try:
        return session.fit_of_all(starts[costs.index(least)]).chi2
    except ArithmeticError:
        return None
