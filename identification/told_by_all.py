"""What the beginnings of the records leave open, the whole of them may tell."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common, misfit_of
from identification.fit import Fit, fit_to_its_end
from identification.hypothesis import Hypothesis, but_for_effects, effect_unknowns
from identification.in_step import in_step
from identification.outcome import EXCLUDED_BY, distinct, members_of
from identification.pieces import fit_from_own_starts
from identification.session import Session
from models.effects import Effect

MOST_HELD = 3
"""Members held against all records, the most probable first: a group of more tells nobody where to look."""


@dataclass(frozen=True, eq=False)
class Ahead:
    """A member of a round that all records speak for, against the effect that stands.

    Attributes:
        row: of the round.
        fit: of the model with it in that place, to all records.
        against: of the model that stands, to the same.
        by: chi-square that this one leaves more, in the unit of all records.
    """

    row: Ranked
    fit: Fit
    against: Fit
    by: float


def told_by_all(
    session: Session, ranked: Sequence[Ranked], standing: Fit, index: int
) -> tuple[list[Ranked], list[Ahead]]:
    """A round whose most probable members were held against all records, and those that are ahead by these, by how far.

    A round is judged on as much of the records as a search can afford, and what only an earlier one holds was never
    fitted beside the effects found since. So each of these members takes the place of the effect that stands: on that
    part, where it has no fit, and on all records. One that either excludes is as far behind as there. All others, one
    of which no fit stands, and what sits in several parts stay as they were.

    Args:
        session: with the records, told.
        ranked: the round, its effect first.
        standing: the model that stands, fitted to a part of the records.
        index: of the round's effect in it.
    """
    rows, ahead = distinct(ranked), list[Ahead]()
    if len(rows[0].effect.parts()) > 1:
        return rows, ahead
    court, asked = _Court(session, standing, index), [rows[0].effect]
    for _ in range(MOST_HELD):
        members = (row for row in members_of(rows) if row.effect not in asked and len(row.effect.parts()) == 1)
        row = max(members, key=lambda row: row.log_evidence, default=None)
        if row is None:
            break
        place = rows.index(row)
        try:
            rows[place] = court.fitted(row, rows)
            if rows[place] in members_of(rows):
                rows[place], found = court.held(rows[place], rows)
                ahead += [] if found is None else [found]
        except ArithmeticError:
            session.progress(f"{row.effect.label()} leaves the finite numbers and stays as it was")
        asked.append(rows[place].effect)
    return [rows[0], *sorted(rows[1:], key=lambda row: -row.log_evidence)], sorted(ahead, key=lambda each: -each.by)


def behind_by(row: Ranked, first: Ranked, chi2: float, unit: float) -> Ranked:
    """A row that is so far behind the first one, or farther where it was already.

    Args:
        row: of a round.
        first: of the same.
        chi2: that it leaves more, in the unit of the round.
        unit: ``misfit_in_common`` of the round.
    """
    fit = replace(row.fit, chi2=max(row.fit.chi2, first.fit.chi2 + chi2 * unit))
    return replace(row, fit=fit, log_evidence=min(row.log_evidence, first.log_evidence - 0.5 * chi2))


@dataclass(frozen=True, eq=False)
class _Court:
    """Where members are held against the model that stands: the part that was fitted, and all records."""

    session: Session
    standing: Fit
    index: int

    @cached_property
    def part(self) -> "_Stand":
        return _Stand.of(self.session.fitting, self.standing, self.index, lambda begun: begun)

    @cached_property
    def everything(self) -> Evaluator:
        return self.session.all_predicted

    @cached_property
    def whole(self) -> "_Stand":
        return _Stand.of(self.everything, self.session.to_the_end(self.standing), self.index, self.session.told_later)

    def fitted(self, row: Ranked, rows: Sequence[Ranked]) -> Ranked:
        """A member with a fit on the part; its evidence is an earlier round's, and no more than the fit leaves it."""
        if row.refitted:
            return row
        self.session.progress(f"refitting {row.effect.label()}, which cannot be excluded, with all numbers")
        found = self.part.with_effect(row.effect, row.fit.hypothesis.values)
        now = replace(row, effect=found.hypothesis.effects[self.index], fit=found, refitted=True)
        return behind_by(now, rows[0], max(0.0, self.part.behind(found)), misfit_in_common(rows))

    def held(self, row: Ranked, rows: Sequence[Ranked]) -> tuple[Ranked, Ahead | None]:
        """A member as far behind as all records exclude it, or ahead as far as they exclude the effect that stands."""
        part, whole = self.session.fitting, self.everything
        if whole.n_data <= part.n_data:
            return row, None
        label, stands = row.effect.label(), rows[0].effect.label()
        self.session.progress(f"fitting {label}, which cannot be excluded, to all records")
        found = self.whole.with_effect(row.effect, row.fit.hypothesis.values)
        behind = self.whole.behind(found)
        if behind >= EXCLUDED_BY:
            self.session.decide(f"{label} explains {part.extent} as well as {stands}, but not all {whole.extent}")
            return behind_by(row, rows[0], behind, misfit_in_common(rows)), None
        if behind > -EXCLUDED_BY:
            return row, None
        best = self._nearest_from(found)
        by = replace(self.whole, fit=found).behind(best)
        return row, Ahead(row, found, best, by) if by >= EXCLUDED_BY else None

    def _nearest_from(self, found: Fit) -> Fit:
        """The fit of the effect that stands to all records, or another from a member's numbers: it may have stopped."""
        try:
            again = replace(self.whole, fit=found).with_effect(self.whole.fit.hypothesis.effects[self.index])
        except ArithmeticError:
            return self.whole.fit
        return min(self.whole.fit, again, key=lambda each: each.cost)


@dataclass(frozen=True, eq=False)
class _Stand:
    """A model fitted to some records, which of its effects is in question, and how a fit of them is begun."""

    evaluator: Evaluator
    fit: Fit
    index: int
    led: Callable[[Hypothesis], Hypothesis]

    @classmethod
    def of(cls, evaluator: Evaluator, standing: Fit, index: int, led: Callable[[Hypothesis], Hypothesis]) -> "_Stand":
        return cls(evaluator, fit_from_own_starts(evaluator, standing), index, led)

    def with_effect(self, effect: Effect, values: Mapping[str, float] | None = None) -> Fit:
        """The fit with an effect in that place, from the nearer of the numbers of the rig here and others, if given.

        Raises:
            ArithmeticError: the model leaves the finite numbers.
        """
        begun = in_step(self.evaluator, self.fit.hypothesis.with_effect_at(self.index, effect), (effect,))
        starts = [begun] if values is None else [begun, replace(begun, values=values)]
        residuals = self.evaluator.residuals([(start, None) for start in starts])
        stand = [(float(left @ left), start) for left, start in zip(residuals, starts, strict=True) if left is not None]
        if not stand:
            raise ArithmeticError(f"no model with {effect.label()} stays finite")
        _, start = min(stand, key=lambda pair: pair[0])
        start = self.led(start)
        unknowns = (*but_for_effects(self.fit.unknowns), *effect_unknowns(start))
        return fit_from_own_starts(self.evaluator, fit_to_its_end(self.evaluator, start, unknowns))

    def behind(self, found: Fit) -> float:
        """Chi-square beyond what noise leaves that a fit has more than the model here, in its unit."""
        more = (found.chi2 - found.n_data) - (self.fit.chi2 - self.fit.n_data)
        return more / misfit_of(self.fit)
