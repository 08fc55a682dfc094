"""One of several effects looked for anew beside the others: every kind at every place, from the numbers found so far.

The first of two effects is looked for while the other is missing too, and stands where it imitates both; the second
makes up for that. Together they leave the rig's numbers near the truth, so that beside either of them the other is seen
as it is, which was not to be seen before: a step of block coordinate descent whose search is global (J. C. Bezdek and
R. J. Hathaway, Neural, Parallel and Scientific Computations 11 (2003) 351).
"""

from dataclasses import replace

from identification.acceptance import LEAST_SHARE
from identification.calibrate import concerning
from identification.evidence import Ranked
from identification.exchange import Exchange, exchanged, fit_at
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis
from identification.judge import finals
from identification.look import View, beside
from identification.prepare import cut_to
from identification.reached import reaches_noise
from identification.rounds import SCREEN_SECONDS, takes_away, told_apart
from identification.session import Session

NEAR_THE_TRUTH = 3.0
"""Residual over noise up to which the numbers beside several effects are near enough to see others by."""

MOST_LOOKS = 4
"""Of two effects each twice."""


def looked_for_anew(session: Session, calibrated: Fit, now: Exchange) -> Exchange:
    """Effects exchanged for what explains more at any place, until the noise is reached or none does.

    What stood beside an effect that was none of the rig's is judged again beside the one that took its place.

    Args:
        session: with the records; told.
        calibrated: the model without effects.
        now: the model with all of them, and what was weighed.
    """
    given, waiting = now, list(range(len(now.fit.hypothesis.effects)))
    if len(waiting) < 2:
        return now
    for _ in range(MOST_LOOKS):
        if not waiting or now.fit.ratio > NEAR_THE_TRUTH or reaches_noise(session.fitting, now.fit):
            break
        index = waiting.pop(0)
        after = _anew(session, calibrated, now, index)
        if after is not now:
            waiting = [other for other in range(len(now.fit.hypothesis.effects)) if other != index]
        now = after
    if now is given:
        return now
    others = [other for other in range(len(now.fit.hypothesis.effects)) if other != now.newest]
    again = exchanged(session, calibrated, now.fit, now.rounds, others)
    newest = now.newest if again.newest is None else again.newest
    return replace(again, labels=(*now.labels, *again.labels), newest=newest)


def _anew(session: Session, calibrated: Fit, now: Exchange, index: int) -> Exchange:
    """The model with one effect exchanged, or the same where nothing takes enough of the misfit away in its place."""
    hypothesis = now.fit.hypothesis
    effect, others = hypothesis.effects[index], (*hypothesis.effects[:index], *hypothesis.effects[index + 1 :])
    beside_them = " and ".join(other.label() for other in others)
    session.progress(f"looking for {effect.label()} anew beside {beside_them}")
    try:
        rows = told_apart(session, judged_anew(session, calibrated, replace(hypothesis, effects=others)))
        if not rows:
            return now
        best = rows[0].effect
        effects = (*others[:index], best, *others[index:])
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


def judged_anew(session: Session, calibrated: Fit, bare: Hypothesis) -> list[Ranked]:
    """Every kind at every place judged beside the effects of a model, from its numbers.

    Kinds that act over the length of a record are left out: looking for them takes whole records.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        bare: the model without the one that is looked for, its numbers as they were found beside it.

    Raises:
        ArithmeticError: the motion of that model leaves the finite numbers.
    """
    base = fit_at(session, calibrated, bare)
    evaluator = cut_to(session.searching(base), SCREEN_SECONDS, session.limits, 2)
    there = fit(evaluator, base.hypothesis, concerning(base, evaluator), max_iterations=0)
    structure = base.hypothesis.rig.structure.kind
    kinds = {name: k for name, k in session.registry.items() if structure in k.structures and k.family != "time"}
    sketches = beside(View(evaluator, there, kinds), base, session.progress)
    return finals(sketches, session.fitting, base, kinds, session.progress)
