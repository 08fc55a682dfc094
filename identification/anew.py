"""One of several effects looked for anew beside the others: every kind at every place, from the numbers found so far.

The first of two effects is looked for while the other is missing too, and stands where it imitates both; the second
makes up for that. Together they leave the rig's numbers near the truth, so that beside either of them the other is seen
as it is, which was not to be seen before: a step of block coordinate descent whose search is global (J. C. Bezdek and
R. J. Hathaway, Neural, Parallel and Scientific Computations 11 (2003) 351).
"""

from dataclasses import replace
from functools import partial
from math import inf

from identification.calibrate import concerning
from identification.evidence import Ranked
from identification.exchange import Exchange, exchanged, fit_at, in_turn
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis
from identification.judge import Look, finals
from identification.look import View, beside
from identification.prepare import cut_to
from identification.reached import LEAST_SHARE, reaches_noise, takes_away
from identification.rounds import SCREEN_SECONDS, told_apart
from identification.session import Session

NEAR_THE_TRUTH = 3.0
"""Residual over noise up to which the numbers beside several effects are near enough to see others by."""


def looked_for_anew(session: Session, calibrated: Fit, now: Exchange) -> Exchange:
    """Effects exchanged for what explains more at any place, until the noise is reached or none does.

    What stood beside an effect that was none of the rig's is judged again beside the one that took its place.

    Args:
        session: with the records; told.
        calibrated: the model without effects.
        now: the model with all of them, and what was weighed.
    """
    if len(now.fit.hypothesis.effects) < 2:
        return now
    after = in_turn(
        now, range(len(now.fit.hypothesis.effects)), partial(_anew, session, calibrated), partial(_is_enough, session)
    )
    if after is now:
        return now
    again = exchanged(session, calibrated, after.fit, after.rounds, after.others)
    newest = after.newest if again.newest is None else again.newest
    return replace(again, labels=(*after.labels, *again.labels), newest=newest)


def _is_enough(session: Session, found: Fit) -> bool:
    """The noise is reached, or the numbers are too far off to see other effects by."""
    return found.ratio > NEAR_THE_TRUTH or reaches_noise(session.fitting, found)


def _anew(session: Session, calibrated: Fit, now: Exchange, index: int) -> Exchange:
    """The model with one effect exchanged, or the same where nothing takes enough of the misfit away in its place."""
    effect, bare = now.fit.hypothesis.effects[index], now.fit.hypothesis.without_effect(index)
    beside_them = " and ".join(other.label() for other in bare.effects)
    session.progress(f"looking for {effect.label()} anew beside {beside_them}")
    try:
        rows = told_apart(session, judged_anew(session, calibrated, bare))
        if not rows:
            return now
        best = rows[0].effect
        effects = (*bare.effects[:index], best, *bare.effects[index:])
        last = fit_at(session, calibrated, replace(rows[0].fit.hypothesis, effects=effects), polished=True)
    except ArithmeticError:  # without the effect nothing stands
        return now
    if takes_away(now.fit, last) < LEAST_SHARE:
        return now
    label = f"{effect.label()} exchanged for {best.label()}"
    session.decide(
        f"{label}: looked for anew beside {beside_them}, that explains more; residual from {now.fit.ratio:.2f} to "
        f"{last.ratio:.2f} times the noise; {best.in_words()}"
    )
    rounds = [*now.rounds[:index], rows, *now.rounds[index + 1 :]]
    return Exchange(last, rounds, (*now.labels, label), index)


WORTH_REFITTING = 2.0
"""Residual over noise that a first fit of one of them comes to, where suspects have to reach the noise to count."""


def judged_anew(session: Session, calibrated: Fit, bare: Hypothesis, near: float = inf) -> list[Ranked]:
    """Every kind at every place judged beside the effects of a model, from its numbers.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        bare: the model without the one that is looked for, its numbers as they were found beside it.
        near: as ``ranked_beside`` has it.

    Raises:
        ArithmeticError: the motion of that model leaves the finite numbers.
    """
    return ranked_beside(session, fit_at(session, calibrated, bare), beside, near)


def ranked_beside(session: Session, base: Fit, look: Look, near: float = inf) -> list[Ranked]:
    """Every kind at every place judged beside a model.

    Kinds that act over the length of a record are left out: looking for them takes whole records.

    Args:
        session: with the records.
        base: the model, on what is fitted.
        look: how suspects are looked for.
        near: residual over noise that one of the first fits has to come to, for any to be fitted further.
    """
    evaluator = cut_to(session.searching(base), SCREEN_SECONDS, session.limits, 2)
    there = fit(evaluator, base.hypothesis, concerning(base, evaluator), max_iterations=0)
    kinds = session.kinds_on(base.hypothesis.rig, but=("time",))
    sketches = look(View(evaluator, there, kinds), base, session.progress)
    if min((sketch.fit.ratio for sketch in sketches), default=inf) > near:
        return []
    return finals(sketches, session.fitting, base, kinds, session.progress)
