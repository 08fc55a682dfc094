"""What the beginnings of the records leave open, the whole of them may tell."""

from collections.abc import Sequence
from dataclasses import replace

from identification.evidence import Ranked, misfit_in_common, misfit_of
from identification.fit import Fit
from identification.in_step import in_step
from identification.outcome import EXCLUDED_BY, members_of
from identification.pieces import fit_from_own_starts
from identification.session import Session


def told_by_all(session: Session, ranked: Sequence[Ranked], standing: Fit, index: int) -> list[Ranked]:
    """A round whose members that its records do not exclude have been held against all records.

    A round is judged on as much of the records as a search can afford. A member that fits all of them nearly as well as
    the model that stands is as it was; of another the chi-square and the evidence are those of all records: as far
    behind the first one's as there. What sits in several parts, and what no fit to all records stands for, stays as it
    was, and so does what was never refitted.

    Args:
        session: with the records.
        ranked: the round, its effect first.
        standing: the model that stands, fitted to a part of the records.
        index: of the round's effect in it.
    """
    first, rows = ranked[0], list(ranked)
    others = [row for row in members_of(ranked) if row is not first and row.refitted]
    doubtful = [row for row in others if len(first.effect.parts()) == len(row.effect.parts()) == 1]
    if not doubtful or session.all_predicted.n_data <= session.fitting.n_data:
        return rows
    ended, unit = session.to_the_end(standing), misfit_in_common(ranked)
    for row in doubtful:
        behind = _behind(session, row, ended, index)
        if behind is None or behind < EXCLUDED_BY:
            continue
        session.decide(
            f"{row.effect.label()} explains {session.fitting.extent} as well as {first.effect.label()}, but not all "
            f"{session.all_predicted.extent}"
        )
        fitted = replace(row.fit, chi2=first.fit.chi2 + behind * unit)
        evidence = min(row.log_evidence, first.log_evidence - 0.5 * behind)
        rows[rows.index(row)] = replace(row, fit=fitted, log_evidence=evidence)
    return [first, *sorted(rows[1:], key=lambda row: -row.log_evidence)]


def _behind(session: Session, row: Ranked, ended: Fit, index: int) -> float | None:
    """Chi-square that all records leave more than with the effect that stands, in their unit; None where no fit stands.

    Args:
        session: with the records.
        row: whose effect is put in the place of the one that stands.
        ended: the model that stands, fitted to all records.
        index: of the effect in it.
    """
    whole, effects = session.all_predicted, ended.hypothesis.effects
    beside = replace(ended.hypothesis, effects=(*effects[:index], row.effect, *effects[index + 1 :]))
    beside = in_step(whole, beside, (row.effect,))
    starts = [beside, replace(beside, values=row.fit.hypothesis.values)]
    residuals = whole.residuals([(start, None) for start in starts])
    stand = [(float(left @ left), start) for left, start in zip(residuals, starts, strict=True) if left is not None]
    if not stand:
        return None
    least, start = min(stand, key=lambda pair: pair[0])
    unit = misfit_of(ended)
    if least - ended.chi2 >= EXCLUDED_BY * unit:
        try:
            least = fit_from_own_starts(whole, session.fit_of_all(start)).chi2
        except ArithmeticError:
            return None
    return (least - ended.chi2) / unit
