"""What was found while something else was missing too, judged once more beside what was found after it.

The first effect of several answers for all that is missing at the time, and a law with more numbers bends further
towards what it is not. Once the others stand, its rivals of that time are tried again in its place: sequential
replacement, as in A. J. Miller, Subset Selection in Regression (2002), section 3.4.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from identification.evidence import Ranked, reweighed
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.in_its_place import judged_beside
from identification.session import Session
from models.effects import Effect

MOST_TRIALS = 4
"""Effects judged again: two of two, and once more what stood beside an exchange."""

MOST_RIVALS = 5
"""Kinds tried in an effect's place, the best of its round."""


@dataclass(frozen=True, eq=False)
class Exchange:
    """The model after its effects were judged again.

    Attributes:
        fit: of the model.
        rounds: effects ranked beside all others, for each effect of the model.
        labels: what was exchanged for what, in words.
        newest: index of the effect that was put in last, if any was.
    """

    fit: Fit
    rounds: list[list[Ranked]]
    labels: tuple[str, ...] = ()
    newest: int | None = None

    @property
    def others(self) -> list[int]:
        """Indices of all effects but the newest."""
        return [index for index in range(len(self.fit.hypothesis.effects)) if index != self.newest]


def exchanged(
    session: Session, calibrated: Fit, found: Fit, rounds: list[list[Ranked]], waiting: Sequence[int]
) -> Exchange:
    """Effects judged again beside the others, and exchanged where another explains more with less.

    Args:
        session: with the records.
        calibrated: the model without effects.
        found: with all of them.
        rounds: effects ranked in the round of each.
        waiting: indices of those to judge; once one is exchanged, all others are judged beside it.
    """
    return in_turn(Exchange(found, rounds), waiting, partial(_judged_again, session, calibrated))


def in_turn(
    now: Exchange,
    waiting: Sequence[int],
    judge: Callable[[Exchange, int], Exchange],
    is_enough: Callable[[Fit], bool] = lambda _: False,
) -> Exchange:
    """Effects judged one after the other; once one is exchanged, all others are judged beside it.

    Args:
        now: the model.
        waiting: indices of the effects to judge.
        judge: the model after one of them was.
        is_enough: of what model none is judged any more.
    """
    waiting = list(waiting)
    for _ in range(MOST_TRIALS):
        if not waiting or is_enough(now.fit):
            break
        index = waiting.pop(0)
        after = judge(now, index)
        if len(after.labels) > len(now.labels):
            waiting = after.others
        now = after
    return now


def fit_at(session: Session, calibrated: Fit, hypothesis: Hypothesis, *, polished: bool = False) -> Fit:
    """The fit of a model where it is, or from there to the end.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        hypothesis: the model.
        polished: to the end.
    """
    unknowns = (*calibrated.unknowns, *effect_unknowns(hypothesis))
    if polished:
        return fit(session.fitting, hypothesis, unknowns, precise=True)
    return fit(session.fitting, hypothesis, unknowns, max_iterations=0, precise=True)


def _judged_again(session: Session, calibrated: Fit, now: Exchange, index: int) -> Exchange:
    """One effect judged again."""
    hypothesis, ranked = now.fit.hypothesis, now.rounds[index]
    effect, bare = hypothesis.effects[index], hypothesis.without_effect(index)
    others = bare.effects
    rivals = list(_rivals(effect, ranked))
    kinds = session.kinds_at_a_place(hypothesis.rig)
    beside = " and ".join(other.label() for other in others)
    session.progress(f"{effect.label()} judged again beside {beside}")
    try:
        base = fit_at(session, calibrated, bare)
        leader = fit_at(session, calibrated, replace(hypothesis, effects=(*others, effect)))
        rows = judged_beside(leader, session.fitting, base, rivals, kinds, session.progress)
    except ArithmeticError:  # without the effect nothing stands
        return now
    rounds = [*now.rounds[:index], beside_rows(rows, ranked), *now.rounds[index + 1 :]]
    best = rows[0]
    if best.effect.kind == effect.kind and best.effect.place.sleeve == effect.place.sleeve:
        return replace(now, rounds=rounds)
    effects = (*others[:index], best.effect, *others[index:])
    last = fit_at(session, calibrated, replace(best.fit.hypothesis, effects=effects), polished=True)
    less = "a place less to fit" if best.effect.kind == effect.kind else "less"
    session.decide(
        f"{effect.label()} exchanged for {best.effect.label()}: beside {beside} that explains the records as well with "
        f"{less}, or better; residual from {now.fit.ratio:.2f} to {last.ratio:.2f} times the noise; "
        f"{best.effect.in_words()}"
    )
    label = f"{effect.label()} exchanged for {best.effect.label()}"
    return Exchange(last, rounds, (*now.labels, label), index)


def beside_rows(rows: Sequence[Ranked], earlier: Sequence[Ranked]) -> list[Ranked]:
    """A new ranking with what only an earlier one holds, as far behind its best as it was there.

    Args:
        rows: of the new ranking, all refitted.
        earlier: sorted.
    """
    kinds = {row.effect.kind for row in rows}
    old = [replace(row, refitted=False) for row in earlier if row.effect.kind not in kinds]
    return reweighed([earlier[0], *old], rows)


def _rivals(effect: Effect, ranked: Sequence[Ranked]) -> Iterator[Effect]:
    """The best of each other kind in the round."""
    seen = {effect.kind}
    for row in ranked:
        if row.effect.kind not in seen and len(seen) <= MOST_RIVALS:
            seen.add(row.effect.kind)
            yield row.effect
