"""Which effect is missing? Look for suspects, refit the best with all numbers, rank them by evidence."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import inf

from identification.calibrate import Windows, beginning, calibrate, concerning, pulled
from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common, reweighed, with_evidence
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, free_place, own_unknowns
from identification.in_step import tried_with
from identification.look import View, afar, beside
from identification.progress import Progress, silent
from identification.scene import is_same_place, sleeves_of
from identification.screen import promising, survey
from identification.simpler import simpler_ones
from identification.sketch import (
    FAR_BEHIND,
    HEATS,
    REACHED,
    TOLERANCE,
    Sketch,
    apart,
    by_share,
    is_alike,
)
from models.effects import Effect, Registry

REFIT_WINDOWS: Windows = ((0.35, 2.0),)
"""The sketch has seen the beginning."""

FINALISTS = 4
REFITS_PER_KIND = 2


def judge(
    views: Sequence[View],
    fitting: Evaluator,
    base: Fit,
    progress: Progress,
) -> list[Ranked]:
    """All effects worth a refit, the one with the most evidence first.

    Args:
        views: what to look for suspects in; kinds that act over the length of a record in one of their own, which is
            left out where another kind reaches the noise without them, from further off.
        fitting: records to refit on.
        base: the calibrated model on those.
        progress: told what is being done.
    """
    instant = next((view for view in views if not view.is_lasting), None)
    lasting = [view for view in views if view.is_lasting]
    looks = [beside, afar] if base.ratio <= LARGE else [afar, beside]
    if base.ratio <= SMALL and not pulled(base):
        looks = [beside]
    ranked: list[Ranked] = []
    for number, look in enumerate(looks):
        if number > 0:
            progress("nothing seen so far reaches the noise; looking from elsewhere")
        sketches = [] if instant is None else look(instant, base, progress)
        if lasting and (number > 0 or not any(sketch.fit.ratio < REACHED < base.ratio for sketch in sketches)):
            sketches += [sketch for view in lasting for sketch in beside(view, base, progress)]
            lasting = []
        found = _best(sketches, FINALISTS, REFITS_PER_KIND)
        new = [sketch for sketch in found if not any(is_alike(sketch.fit, row.fit) for row in ranked)]
        kinds = {} if instant is None else instant.registry
        more = _finals(new, by_share(sketches), fitting, base, kinds, progress)
        rows = [row for row in (*ranked, *more) if row.refitted]
        ranked = _settled(fitting, reweighed(ranked, rows), progress) if ranked else more
        if ranked and ranked[0].fit.ratio < EXPLAINED:
            break
    return ranked


EXPLAINED = 1.25
"""Residual over noise at which suspects are not looked for in another way."""

SMALL, LARGE = 3.0, 8.0
"""Residual over noise of the calibrated model: up to the first its neighbourhood alone tells suspects apart, above the
second the beginning of the records is seen first, since nothing is linear."""


def _finals(
    finalists: Sequence[Sketch],
    sketches: Sequence[Sketch],
    fitting: Evaluator,
    base: Fit,
    registry: Registry,
    progress: Progress,
) -> list[Ranked]:
    """The finalists refitted, but for those that plainly stay above the noise that another has reached.

    Args:
        finalists: the best sketches.
        sketches: all of them, the best first.
        fitting: records to refit on.
        base: the model without an effect more.
        registry: kinds to try in a sleeve that the first of them has come to.
        progress: told what is being done.
    """
    ranked: list[Ranked] = []
    beaten: list[tuple[Fit, float]] = []
    leader: tuple[Sketch, Fit] | None = None
    for sketch in finalists:
        if leader is not None and _is_out(sketch, leader[0]):
            beaten.append((sketch.fit, max(sketch.fit.ratio / leader[0].fit.ratio, RULED_OUT)))
            continue
        progress(f"refitting {sketch.effect.label()} with all numbers on {fitting.extent}")
        found = sketch.fit.hypothesis
        if leader is not None:
            first, farther = _against(leader[1], fitting, base, found)
            if first is not None and farther > RULED_OUT:
                beaten.append((first, farther))
            if first is None or farther > RULED_OUT:
                continue
            found = first.hypothesis
        result = refit(fitting, base, found.effects[-1], found.values)
        if result is not None:
            ranked.append(Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0))
            if result.ratio < min(CLOSE_ENOUGH, leader[1].ratio if leader else CLOSE_ENOUGH):
                leader = (sketch, result)
    ordered = with_evidence(ranked)
    ordered = with_evidence([*ordered, *_simpler(fitting, base, ordered, sketches)])
    ordered = with_evidence([*ordered, *_of_the_sleeve(fitting, base, ordered, registry)])
    ordered = _settled(fitting, with_evidence([*ordered, *_at_sleeves(fitting, base, ordered)]), progress)
    for fit_there, farther in beaten:
        behind = 0.5 * (farther**2 - 1.0) * ordered[0].fit.chi2 / misfit_in_common(ordered)
        evidence = ordered[0].log_evidence - behind
        ordered.append(Ranked(fit_there.hypothesis.effects[-1], fit_there, refitted=False, log_evidence=evidence))
    return ordered


def judged_beside(
    leader: Fit, fitting: Evaluator, base: Fit, rivals: Iterable[Effect], progress: Progress
) -> list[Ranked]:
    """A fit's last effect and those of the rivals that come near it beside the same other effects, by evidence.

    Args:
        leader: with all effects, the one in question last.
        fitting: records of the fit.
        base: the same without that effect.
        rivals: that may stand in its place, with the numbers they begin from.
        progress: told what is being done.
    """
    row = Ranked(leader.hypothesis.effects[-1], leader, refitted=True, log_evidence=0.0)
    return _settled(fitting, with_evidence([row, *_begun_at_leader(fitting, base, [row], rivals)]), progress)


def _against(leader: Fit, fitting: Evaluator, base: Fit, found: Hypothesis) -> tuple[Fit | None, float]:
    """A model fitted on the beginning, and how many times as far off as the leader it is there.

    It is fitted with the leader's slopes: whatever comes as near to the records has nearly the same.
    """
    window = fitting if fitting.at_rest else beginning(fitting, *REFIT_WINDOWS[0])
    there = fit(window, leader.hypothesis, leader.unknowns, max_iterations=0)
    unknowns = (*base.unknowns, *own_unknowns(found))
    slopes = there.jacobian[: len(base.unknowns)]
    try:
        first = fit(
            window, found, unknowns, max_iterations=ITERATIONS_AGAINST, jacobian=slopes, keep=True, tolerance=TOLERANCE
        )
    except ArithmeticError:
        return None, inf
    return first, first.ratio / there.ratio


ITERATIONS_AGAINST = 8
"""Of a model that has to come near the noise, which another has reached, to be fitted further."""


def _simpler(fitting: Evaluator, base: Fit, ranked: Sequence[Ranked], sketches: Sequence[Sketch]) -> list[Ranked]:
    """Laws with fewer numbers than the first, begun where it has come to, if it has reached the noise."""
    if not ranked or ranked[0].fit.ratio > EXPLAINED:
        return []
    return _begun_at_leader(fitting, base, ranked, simpler_ones(ranked[0].effect, sketches))


def _of_the_sleeve(fitting: Evaluator, base: Fit, ranked: Sequence[Ranked], registry: Registry) -> list[Ranked]:
    """What can sit in a sleeve alone, tried where the first effect's free place has come to one, if it explains all."""
    if not ranked or ranked[0].fit.ratio > EXPLAINED or not free_place(ranked[0].effect):
        return []
    leader = ranked[0].fit.hypothesis
    rig, there = leader.rig, ranked[0].effect.place
    sleeve = next((place for place in sleeves_of(rig) if is_same_place(place, there, rig)), None)
    kinds = {name: kind for name, kind in registry.items() if kind.places == ("sleeve",)}
    if sleeve is None or not kinds:
        return []
    window = fitting if fitting.at_rest else beginning(fitting, *REFIT_WINDOWS[0])
    bare = replace(leader, effects=leader.effects[:-1])
    try:
        ground = fit(window, bare, concerning(base, window), max_iterations=0)
    except ArithmeticError:
        return []
    seen = promising(survey(window, ground, kinds, silent, sleeve.position), 1)
    return _begun_at_leader(fitting, base, ranked, (s.effect for s in seen if s.effect.place == sleeve))


def _begun_at_leader(
    fitting: Evaluator, base: Fit, ranked: Sequence[Ranked], effects: Iterable[Effect]
) -> list[Ranked]:
    """Effects begun beside the first one's numbers of the rig, refitted where they come near what it leaves."""
    leader, rows = ranked[0].fit, []
    as_good = {row.effect.kind for row in ranked if row.fit.ratio < RULED_OUT * leader.ratio}
    for effect in effects:
        if effect.kind in as_good:
            continue
        start = tried_with(fitting, replace(base.hypothesis, values=leader.hypothesis.values), effect)
        first, farther = _against(leader, fitting, base, start)
        if first is None or farther > RULED_OUT:
            continue
        result = refit(fitting, base, first.hypothesis.effects[-1], first.hypothesis.values)
        if result is not None:
            rows.append(Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0))
    return rows


def _at_sleeves(fitting: Evaluator, base: Fit, ranked: Sequence[Ranked]) -> list[Ranked]:
    """The best effects again at a sleeve that their free place has come to, where they have no place to fit."""
    rows = []
    for row in ranked:
        if row.log_evidence < ranked[0].log_evidence - FOR_A_PLACE or not free_place(row.effect):
            continue
        rig = row.fit.hypothesis.rig
        for place in sleeves_of(rig) if "sleeve" in row.effect.places else ():
            if is_same_place(place, row.effect.place, rig):
                result = refit(fitting, base, replace(row.effect, place=place), row.fit.hypothesis.values)
                if result is not None:
                    rows.append(Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0))
    return rows


FOR_A_PLACE = 15.0
"""Evidence that a place to fit costs at most."""


def _settled(fitting: Evaluator, ranked: list[Ranked], progress: Progress) -> list[Ranked]:
    """The ranking with those fitted to the end that the refits' tolerance cannot tell from the first."""
    within = 0.5 * REFIT_TOLERANCE * ranked[0].fit.cost / misfit_in_common(ranked) if ranked else 0.0
    close = [row for row in ranked if row.refitted and row.log_evidence > ranked[0].log_evidence - within]
    if not close[1:]:
        return ranked
    progress(f"{' and '.join(row.effect.label() for row in close)} fit nearly alike; fitting them to the end")
    fits = [fit(fitting, row.fit.hypothesis, row.fit.unknowns, tolerance=0.0, precise=True) for row in close]
    rows = [replace(row, fit=f, effect=f.hypothesis.effects[-1]) for row, f in zip(close, fits, strict=True)]
    return with_evidence([*rows, *ranked[len(close) :]])


def _is_out(sketch: Sketch, best: Sketch) -> bool:
    """Whether a sketch already shows that it will not reach what the best one reached."""
    return sketch.fit.ratio > RULED_OUT * best.fit.ratio or sketch.share < LEFT_BEHIND * best.share


RULED_OUT, LEFT_BEHIND = 1.3, 0.85
"""A sketch so many times as far off as the best one, or that takes away so much less, is not refitted when that reaches
the noise."""


def _best(sketches: Sequence[Sketch], most: int, per_kind: int) -> list[Sketch]:
    """The best sketches, a few of each kind, without those far behind."""
    chosen: list[Sketch] = []
    for sketch in apart(by_share(sketches)):
        same = [other for other in chosen if other.effect.kind == sketch.effect.kind]
        behind = len(chosen) >= LEAST_REFITS and sketch.share < FAR_BEHIND * chosen[0].share
        if len(same) < per_kind and not behind and sketch.share > 0:
            chosen.append(sketch)
    return chosen[:most]


LEAST_REFITS = 3
"""Finalists at least, however far behind."""


def restarted(evaluator: Evaluator, base: Fit, found: Fit) -> Fit:
    """The best of the fit and of fits with its last effect that start from the rig file's numbers again.

    Args:
        evaluator: records to fit.
        base: the model without the effect.
        found: a fit that stopped above the noise, perhaps in a side valley.
    """
    best = found
    effect = found.hypothesis.effects[-1]
    unknowns = found.unknowns
    alone = [u for u in unknowns if u not in base.unknowns]
    for values in ({}, base.hypothesis.values):
        window = beginning(evaluator, *HEATS[-1][:2])
        start = tried_with(window, replace(base.hypothesis, values=values), effect)
        try:
            first = fit(window, start, alone, tolerance=1e-2)
            again = calibrate(evaluator, first.hypothesis, unknowns)
        except ArithmeticError:
            continue
        best = min(best, again, key=lambda f: f.cost)
        if best.ratio < CLOSE_ENOUGH:
            break
    return best


CLOSE_ENOUGH = 1.1
"""Residual over noise at which no other start is tried."""


def refit(evaluator: Evaluator, base: Fit, effect: Effect, values: Mapping[str, float]) -> Fit | None:
    """Everything refitted with one more effect; None where the model with it diverges.

    Args:
        evaluator: records to fit.
        base: the model without the effect, for its effects and unknowns.
        effect: where its fit begins.
        values: of the rig's numbers there.
    """
    hypothesis = tried_with(evaluator, replace(base.hypothesis, values=values), effect)
    try:
        unknowns = (*base.unknowns, *own_unknowns(hypothesis))
        return calibrate(evaluator, hypothesis, unknowns, REFIT_WINDOWS, tolerance=REFIT_TOLERANCE)
    except ArithmeticError:
        return None


REFIT_TOLERANCE = 2e-3
"""Relative decrease of the cost that ends a refit; the one that wins is polished."""
