"""Another law in the place of one that is not established, or of one that all records speak against.

A law with more numbers bends itself to what a simpler one does, and then the records tell none of them. Taken out, it
leaves all of the misfit again; but what it stood for was weighed beside it, in the same round. There only what has
fewer numbers is asked: a law with as many may be bent as well.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from math import log

from identification.acceptance import comes_as_near, in_doubt, is_enough
from identification.calibrate import strained
from identification.conclude import settled
from identification.established import of_one_law
from identification.evidence import SIMPLER, Ranked, log_fit, misfit_in_common, misfit_of
from identification.exchange import fit_at
from identification.fit import Fit
from identification.hypothesis import Hypothesis
from identification.outcome import EXCLUDED_BY
from identification.reached import NOISE_REACHED, reaches_noise
from identification.session import Session
from identification.told_by_all import Ahead, behind_by

AS_WELL = "which explains the records as well"
WITHIN = "with which the noise is reached and no number of the rig leaves its tolerance"
AHEAD = "which all records speak for"
"""What speaks for the other law."""


@dataclass(frozen=True, eq=False)
class Instead:
    """A model with another law in an effect's place.

    Attributes:
        fit: of the model.
        ranked: the effect's round, with the other law first.
        words: what speaks for it.
    """

    fit: Fit
    ranked: list[Ranked]
    words: str


def instead_of(
    session: Session, calibrated: Fit, found: Fit, index: int, ranked: Sequence[Ranked], out: Collection[str]
) -> Instead | None:
    """The best simpler law of an effect's round with which the model comes as near to all records, or None.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        found: with the effect whose law is not established, fitted to the end of the records just before.
        index: of that effect.
        ranked: its round.
        out: kinds that gave way in its place before.
    """
    effects, before = found.hypothesis.effects, session.to_the_end(found)
    for row in ranked:
        simpler = len(row.effect.parts()) == 1 and row.effect.n_numbers < effects[index].n_numbers
        if not row.refitted or not simpler or row.effect.kind in out:
            continue
        others = (*effects[:index], row.effect, *effects[index + 1 :])
        numbers = (row.fit.hypothesis, found.hypothesis)[: len(effects)]  # beside other effects either may be bent
        now = _fitted(session, calibrated, [replace(each, effects=others) for each in numbers])
        if now is None or not comes_as_near(now, found):
            continue
        as_it_was, said = session.as_it_is(), len(session.decisions)
        ended = session.to_the_end(now)
        if ended.n_data == before.n_data and comes_as_near(ended, before):
            return Instead(now, _put_first(row, now, index, ranked, out), AS_WELL)
        _undo(session, as_it_was, said)
    return None


def within_tolerances(
    session: Session, calibrated: Fit, found: Fit, index: int, ranked: Sequence[Ranked], out: Collection[str]
) -> Instead | None:
    """The best law of an effect's round that reaches the noise with every number within its tolerance, or None.

    An effect whose size the records do not tell, beside a number at the end of its tolerance, may have improved a
    little on what another says of that number. What left its tolerance is a finding, whatever is made of it.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        found: with the effect whose size is not established.
        index: of that effect.
        ranked: its round.
        out: kinds that gave way in its place before.
    """
    rest = found.hypothesis.without_effect(index).effects
    for row in ranked if strained(found) else []:
        if not row.refitted or len(row.effect.parts()) > 1 or row.effect.kind in out:
            continue
        if row.fit.ratio > NOISE_REACHED or strained(row.fit):
            continue
        beside = row.fit.hypothesis.effects[:-1]
        others = beside if [e.kind for e in beside] == [e.kind for e in rest] else rest
        effects = (*others[:index], row.effect, *others[index:])
        now = _fitted(session, calibrated, [replace(row.fit.hypothesis, effects=effects)])
        as_it_was, said = session.as_it_is(), len(session.decisions)
        if now is not None and is_enough(session, now) and _holds_throughout(session, now):
            return Instead(now, _put_first(row, now, index, ranked, out), WITHIN)
        _undo(session, as_it_was, said)
    return None


def ahead_by_all(
    session: Session,
    calibrated: Fit,
    found: Fit,
    index: int,
    ranked: Sequence[Ranked],
    ahead: Ahead,
    predicts: Callable[[Hypothesis], bool] = lambda _: False,
) -> Instead | None:
    """A law that all records speak for in the place of one that stands; None where it would not stand itself.

    It has to explain all records as well as that one does the part, to stay finite in whole records, to be established,
    and to have the odds by which a candidate is excluded, with what was known of its numbers and how many there are.

    Args:
        session: with the records; as it was where there is none.
        calibrated: the model without effects, for its unknowns.
        found: with the effect that stands.
        index: of that effect.
        ranked: its round.
        ahead: the law (``told_by_all``).
        predicts: whether a model predicts records that were kept aside.
    """
    label, numbers = ahead.row.effect.label(), ahead.row.effect.n_numbers - found.hypothesis.effects[index].n_numbers
    scale, said = misfit_of(ahead.fit), len(session.decisions)
    odds = log_fit(ahead.fit, scale) - log_fit(ahead.against, scale) - log(SIMPLER) * numbers
    if odds < 0.5 * EXCLUDED_BY:
        return None
    before, now = session.as_it_is(), None
    try:
        there = fit_at(session, calibrated, ahead.fit.hypothesis)
        as_near = max(there.ratio, ahead.fit.ratio) <= max(found.ratio, NOISE_REACHED)
        if as_near and session.holds(there.hypothesis):
            last = settled(session, there)
            are_two = of_one_law(last, in_motion=bool(session.everything.timed)) is None
            now = there if are_two and in_doubt(session, calibrated, there, last, predicts) is None else None
    except ArithmeticError:
        session.progress(f"{label} leaves the finite numbers")
    del session.decisions[said:]  # of a model that does not stand, or is judged again as the one that does
    if now is not None:
        return Instead(now, _put_ahead(ahead, ranked), AHEAD)
    session.back_to(before)
    session.decide(f"all records speak for {label}, which would not stand itself")
    return None


def _undo(session: Session, before: Session, said: int) -> None:
    """The session as it was before a law was held against all records in vain, and what was said of that unsaid."""
    session.back_to(before)
    del session.decisions[said:]


def _put_ahead(ahead: Ahead, ranked: Sequence[Ranked]) -> list[Ranked]:
    """The round with a row first, and the one that stood as far behind it as all records say."""
    stood, *others = ranked
    others = [each for each in others if each is not ahead.row]
    first = replace(ahead.row, log_evidence=max(each.log_evidence for each in (ahead.row, *others)))
    others.append(behind_by(stood, first, ahead.by, misfit_in_common(ranked)))
    return [first, *sorted(others, key=lambda each: -each.log_evidence)]


def _holds_throughout(session: Session, now: Fit) -> bool:
    """Whether the noise is reached within the tolerances on all that can be followed."""
    ended = session.to_the_end(now)
    return reaches_noise(session.all_predicted, ended) and not strained(ended)


def _fitted(session: Session, calibrated: Fit, starts: Sequence[Hypothesis]) -> Fit | None:
    """The best fit from these starts; None where no model stands."""
    fits = []
    for start in starts:
        try:
            fits.append(fit_at(session, calibrated, start, polished=True))
        except ArithmeticError:
            continue
    return min(fits, key=lambda each: each.cost, default=None)


def _put_first(row: Ranked, now: Fit, index: int, ranked: Sequence[Ranked], out: Collection[str]) -> list[Ranked]:
    """The round with a row first, fitted now: what gave way to it has the odds of a number not needed, at most."""
    first = replace(row, fit=now, effect=now.hypothesis.effects[index])
    most = first.log_evidence - log(SIMPLER)
    rows = [
        replace(each, log_evidence=min(each.log_evidence, most)) if each.effect.kind in out else each
        for each in ranked
        if each is not row
    ]
    return [first, *sorted(rows, key=lambda each: -each.log_evidence)]
