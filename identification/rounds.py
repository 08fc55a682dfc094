"""One round of looking for what is missing: the measurement first, then the physics of the rig."""

from collections.abc import Sequence
from dataclasses import replace

from identification.calibrate import concerning, pulled
from identification.carried import carried_through, louder_by
from identification.elsewhere import elsewhere
from identification.evaluate import Evaluator
from identification.evidence import (
    Ranked,
    reranked,
    reweighed,
)
from identification.faults import LARGE, suspicion
from identification.fit import LOOK, LOOK_TOLERANCE, Fit, fit
from identification.followed_again import explains_its_own
from identification.hypothesis import Hypothesis
from identification.in_its_place import EXPLAINED, with_others_there
from identification.judge import judge, restarted
from identification.look import View
from identification.onset import goes_on, onset_of
from identification.pieces import most_missed
from identification.places_open import with_other_valleys
from identification.prepare import Horizon, cut_to, followed_long
from identification.reached import NOISE_REACHED
from identification.session import Session
from identification.sketch import afresh
from identification.tangent_ties import tied
from models.effects import Registry

SCREEN_SECONDS, TIME_SECONDS = 5.0, 10.0
"""Seconds of records that are used for the screening, and for the screening of effects in time."""


PIECES_SECONDS = 3.0
"""The same of those that are missed most, where records are followed in pieces: each of them tells all it can."""


def look_round(session: Session, base: Fit) -> tuple[list[Ranked], Fit | None]:
    """Effects ranked, and a calibration without the best of them if that is better than the one so far."""
    kinds, instant = session.kinds_on(base.hypothesis.rig), session.kinds_on(base.hypothesis.rig, but=("time",))
    lasting = {name: kind for name, kind in kinds.items() if name not in instant and session.everything.timed}
    searching = session.searching(base)
    first = view_of(searching, session.limits, base, instant, SCREEN_SECONDS, 2)
    suspected = suspicion(first.evaluator, first.there)
    ranked: list[Ranked] = []
    if suspected:
        session.decide(suspected.words)
        faults = _unbent(replace(first, registry=suspected.kinds(instant), channels=suspected.channels), base)
        ranked = carried_through(session, judge([faults], session.fitting, base, session.progress))
        first = replace(first, channels=suspected.beside(base.hypothesis.rig))
    # One mode that is damped less is louder in all channels, too: a force is held against all physics.
    if suspected.of_force or not (ranked and ranked[0].fit.ratio <= NOISE_REACHED):
        views = [_in_pieces(session, searching, base, first) or _where_it_shows(session, searching, base, first)]
        if lasting:
            followed = followed_long(searching, TIME_SECONDS, session.limits)
            views.append(view_of(*followed, base, lasting, TIME_SECONDS, 1))
        ranked = judge(
            views,
            session.fitting,
            base,
            session.progress,
            lambda found: explains_its_own(session, found) or louder_by(session, base, found) is not None,
        )
    return (ranked, _recalibrated(session, base, ranked[0].fit)) if ranked else ([], None)


def view_of(
    searching: Evaluator, limits: Sequence[Horizon], base: Fit, kinds: Registry, seconds: float, most: int
) -> View:
    """So many seconds of the loudest records, the quietest and those between, and the calibrated model there.

    Args:
        searching: all records.
        limits: how far each can be predicted.
        base: the calibrated model.
        kinds: to look for.
        seconds: in all.
        most: of the records at most.
    """
    evaluator = cut_to(searching, seconds, limits, most)
    return View(evaluator, _there(evaluator, base.hypothesis, base), kinds)


def _there(evaluator: Evaluator, model: Hypothesis, base: Fit) -> Fit:
    """A model on some of the records, with the slopes there."""
    return fit(evaluator, model, concerning(base, evaluator), max_iterations=1)


def _fitted_there(view: View, base: Fit) -> Fit:
    """The rig's numbers fitted on what is viewed alone, from the calibrated ones and from those that were given."""
    found = [view.there]
    for start in (view.there.hypothesis, afresh(view.there.hypothesis)):
        try:
            found.append(fit(view.evaluator, start, concerning(base, view.evaluator), max_iterations=LOOK))
        except ArithmeticError:
            continue
    return min(found, key=lambda each: each.cost)


def _unbent(view: View, base: Fit) -> View:
    """The view with the model that all channels but the suspected ones tell, where they tell one.

    A channel at fault has bent the calibrated numbers. Where neighbouring motions part, such a model knows nothing of
    the channel any more, and not how late it is.
    """
    suspected = [place.sensor for place in view.channels or () if place.sensor is not None and place.other is None]
    if not suspected or view.there.ratio < LARGE:
        return view
    timed = view.evaluator.timed
    rest = [target.only([name for name in target.record.sensors if name not in suspected]) for target in timed]
    kept = [target for target in rest if target.record.sensors]
    if not kept:
        return view
    heard = view.evaluator.with_targets([*view.evaluator.at_rest, *kept])
    try:
        told = _fitted_there(replace(view, evaluator=heard, there=_there(heard, view.there.hypothesis, base)), base)
        if told.ratio > EXPLAINED:
            return view
        there = fit(view.evaluator, told.hypothesis, concerning(base, view.evaluator), max_iterations=0)
    except ArithmeticError:
        return view
    return replace(view, there=there, is_unbent=True)


def _in_pieces(session: Session, searching: Evaluator, base: Fit, view: View) -> View | None:
    """The pieces of records that are missed most, where more is missed there than in the view."""
    missed = most_missed(session.fitting, base, PIECES_SECONDS)
    if not missed:
        return None
    evaluator = searching.with_targets(missed)
    there = _there(evaluator, base.hypothesis, base)
    if there.ratio <= view.there.ratio:
        return None
    names = ", ".join(target.record.name for target in missed)
    session.decide(f"most is missed where records were begun again: suspects are looked for in {names} on")
    return replace(view, evaluator=evaluator, there=there, is_late=True)


def _where_it_shows(session: Session, searching: Evaluator, base: Fit, view: View) -> View:
    """The view, or, where its seconds show no misfit, as many from where one begins in the records.

    Numbers that what shows later has pulled away leave a misfit where nothing is missing: there they are fitted again.
    """
    if not searching.timed or not goes_on(base.hypothesis):
        return view
    quiet, model = view.there, base.hypothesis
    if quiet.ratio > NOISE_REACHED and pulled(base):
        quiet = _fitted_there(view, base)
        model = quiet.hypothesis
    if quiet.ratio > NOISE_REACHED:
        return view
    seen = {target.record.name: target.record.duration for target in view.evaluator.timed}
    try:
        onset = onset_of(searching, model, session.limits, seen)
    except ArithmeticError:  # beyond what was fitted nothing holds it
        return view
    if onset is None:
        return view
    evaluator = cut_to(onset.evaluator, SCREEN_SECONDS, onset.limits, 2)
    moved = replace(view, evaluator=evaluator, there=_there(evaluator, onset.hypothesis, base), is_late=True)
    if moved.there.ratio <= max(NOISE_REACHED, quiet.ratio):
        return view
    names = ", ".join(target.record.name for target in evaluator.timed)
    session.decide(f"the misfit shows late: suspects are looked for in {names} on")
    return moved


def _recalibrated(session: Session, base: Fit, found: Fit) -> Fit | None:
    """A calibration from the numbers found beside an effect, where that ends below the one so far.

    It is looked where it goes first, and followed to its end, which takes longest, only where it is far enough below.
    """
    if base.hypothesis.effects:
        return None
    without, slopes = replace(found.hypothesis, effects=()), found.jacobian[: len(base.unknowns)]
    try:
        look = fit(
            session.fitting, without, base.unknowns, max_iterations=LOOK, jacobian=slopes, tolerance=LOOK_TOLERANCE
        )
        if look.cost > WORTH_MORE * base.cost:
            return None
        again = fit(session.fitting, look.hypothesis, base.unknowns, like=look)
        if not _is_below(again, base):
            return None
        return fit(session.fitting, again.hypothesis, base.unknowns, jacobian=again.jacobian, precise=True)
    except ArithmeticError:  # beside the effect the numbers may have gone where nothing stands without it
        return None


def _is_below(again: Fit, base: Fit) -> bool:
    """Whether another calibration ends so far below the one so far that it matters."""
    return base.cost - again.cost > max(100.0, 0.02 * base.cost)


WORTH_MORE = 1.2
"""Times the cost of the calibration so far, up to which a look at another one may end to be followed."""


def with_other_starts(session: Session, base: Fit, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking after other starts were tried for the best effect, where its fit stopped above the noise.

    Where the noise is reached, what cannot be told from the best is tried at other places.
    """
    if not ranked:
        return ranked
    if ranked[0].fit.ratio <= NOISE_REACHED:
        return with_other_valleys(session, base, ranked)
    found = ranked[0].fit
    session.progress(f"{ranked[0].effect.label()}: the fit stopped above the noise; trying other places and starts")
    moved = min((found, *elsewhere(session.fitting, base, found, session.registry)), key=lambda each: each.cost)
    better = restarted(session.fitting, base, moved)
    rows = reranked(ranked, better)
    if better is found:
        return rows
    refitted = [row for row in rows if row.refitted]
    kinds = session.kinds_at_a_place(base.hypothesis.rig)
    return reweighed(rows, with_others_there(session.fitting, base, refitted, kinds, session.progress))


def told_apart(session: Session, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking without differences that only larger motion could show, where none was seen."""
    return ranked if session.everything.timed else tied(ranked)
