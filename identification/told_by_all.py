"""What the beginnings of the records leave open, the whole of them may tell."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common, misfit_of
from identification.fit import Fit, fit_to_its_end
from identification.hypothesis import effect_unknowns
from identification.in_step import in_step
from identification.outcome import EXCLUDED_BY, distinct, members_of
from identification.pieces import fit_from_own_starts
from identification.session import LAST_ITERATIONS, Session

MOST_HELD = 3
"""Members held against all records, the most probable first: a group of more tells nobody where to look."""


def told_by_all(session: Session, ranked: Sequence[Ranked], standing: Fit, index: int) -> list[Ranked]:
    """A round whose most probable members have been held against all records, the effect that stands first.

    A round is judged on as much of the records as a search can afford, and what only an earlier one holds was never
    fitted beside the effects found since. So each of these members takes the place of the effect that stands: on that
    part, where it has no fit, and on all records; its evidence becomes what they say. A member of which no fit stands,
    and what sits in several parts, stays as it was.

    Args:
        session: with the records, told.
        ranked: the round, its effect first.
        standing: the model that stands, fitted to a part of the records.
        index: of the round's effect in it.
    """
    rows = distinct(ranked)
    asked = [rows[0].effect]
    while len(asked) <= MOST_HELD and len(rows[0].effect.parts()) == 1:
        members = (row for row in members_of(rows) if row.effect not in asked and len(row.effect.parts()) == 1)
        row = next(members, None)
        if row is None:
            break
        place = rows.index(row)
        try:
            if not row.refitted:
                rows[place] = _fitted(session, rows, row, standing, index)
            if rows[place] in members_of(rows):
                rows = _held(session, rows, place, standing, index)
        except ArithmeticError:
            session.progress(f"{row.effect.label()} leaves the finite numbers and stays as it was")
        asked.append(rows[place].effect)
    return [rows[0], *sorted(rows[1:], key=lambda row: -row.log_evidence)]


def _fitted(session: Session, rows: Sequence[Ranked], row: Ranked, standing: Fit, index: int) -> Ranked:
    """A member fitted on the part; its evidence is an earlier round's, and no more than the fit leaves it."""
    session.progress(f"refitting {row.effect.label()}, which cannot be excluded, with all numbers")
    stand = _Stand.of(session.fitting, standing, index)
    found = stand.with_effect(row)
    behind = max(0.0, stand.behind(found))
    chi2 = rows[0].fit.chi2 + behind * misfit_in_common(rows)
    evidence = min(row.log_evidence, rows[0].log_evidence - 0.5 * behind)
    return Ranked(found.hypothesis.effects[index], replace(found, chi2=chi2), refitted=True, log_evidence=evidence)


def _held(session: Session, rows: list[Ranked], place: int, standing: Fit, index: int) -> list[Ranked]:
    """The rows, a member with the chi-square and the evidence of all records; the same where the part is all there is.

    Where all records speak for it, the others have more chi-square, not it less: none is below what noise leaves.
    """
    part, whole, first, row = session.fitting, session.all_predicted, rows[0], rows[place]
    if whole.n_data <= part.n_data:
        return rows
    session.progress(f"fitting {row.effect.label()}, which cannot be excluded, to all records")
    stand = _Stand.of(whole, session.to_the_end(standing), index)
    found = stand.with_effect(row)
    behind, unit = stand.behind(found), misfit_in_common(rows)
    if behind >= EXCLUDED_BY:
        label, stands = row.effect.label(), first.effect.label()
        session.decide(f"{label} explains {part.extent} as well as {stands}, but not all {whole.extent}")
    evidence = row.log_evidence + 0.5 * ((row.fit.chi2 - first.fit.chi2) / unit - behind)
    rows = [_with_more(each, max(0.0, -behind) * unit) for each in rows]
    fit = replace(row.fit, chi2=first.fit.chi2 + max(0.0, behind) * unit)
    rows[place] = replace(row, fit=fit, log_evidence=evidence, whole=found.hypothesis)
    return rows


def _with_more(row: Ranked, chi2: float) -> Ranked:
    return replace(row, fit=replace(row.fit, chi2=row.fit.chi2 + chi2)) if row.refitted and chi2 else row


@dataclass(frozen=True, eq=False)
class _Stand:
    """The model that stands, fitted to some records, and which of its effects is in question."""

    evaluator: Evaluator
    fit: Fit
    index: int

    @classmethod
    def of(cls, evaluator: Evaluator, standing: Fit, index: int) -> "_Stand":
        return cls(evaluator, fit_from_own_starts(evaluator, standing), index)

    def with_effect(self, row: Ranked) -> Fit:
        """The fit with a row's effect in that place, from the nearer of its numbers of the rig and those that stand.

        Raises:
            ArithmeticError: the model leaves the finite numbers.
        """
        model = self.fit.hypothesis
        effects = (*model.effects[: self.index], row.effect, *model.effects[self.index + 1 :])
        begun = in_step(self.evaluator, replace(model, effects=effects), (row.effect,))
        starts = [begun, replace(begun, values=row.fit.hypothesis.values)]
        residuals = self.evaluator.residuals([(start, None) for start in starts])
        stand = [(float(left @ left), start) for left, start in zip(residuals, starts, strict=True) if left is not None]
        if not stand:
            raise ArithmeticError(f"no model with {row.effect.label()} stays finite")
        _, start = min(stand, key=lambda pair: pair[0])
        of_the_rest = (unknown for unknown in self.fit.unknowns if getattr(unknown, "effect", -1) < 0)
        unknowns = (*of_the_rest, *effect_unknowns(start))
        return fit_from_own_starts(self.evaluator, fit_to_its_end(self.evaluator, start, unknowns, LAST_ITERATIONS))

    def behind(self, found: Fit) -> float:
        """Chi-square beyond what noise leaves that a fit has more than the model that stands, in its unit."""
        more = (found.chi2 - found.n_data) - (self.fit.chi2 - self.fit.n_data)
        return more / misfit_of(self.fit)
