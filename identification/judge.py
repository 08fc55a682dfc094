"""Which effect is missing? Look for suspects, refit the best with all numbers, rank them by evidence."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter

from identification.calibrate import beginning, calibrate, pulled, set_in_motion
from identification.detail import in_more_detail
from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common, ranked_together, reranked, with_evidence
from identification.fit import Fit, fit
from identification.in_its_place import (
    EXPLAINED,
    RULED_OUT,
    Leader,
    against,
    refit_sketched,
    settled_apart,
    with_others_there,
)
from identification.in_step import tried_with
from identification.look import View, afar, beside
from identification.noise_left import NOISE_NEAR
from identification.onset import of_whole
from identification.pieces import fit_from_own_starts
from identification.progress import Progress
from identification.reached import is_faint, takes_away
from identification.sketch import (
    FAR_BEHIND,
    HEATS,
    REACHED,
    Sketch,
    apart,
    by_share,
    is_alike,
)
from models.effects import Registry

Look = Callable[[View, Fit, Progress], list[Sketch]]
"""A way to look for suspects: in a view, beside the calibrated model, told what is being done."""

FINALISTS, LASTING_FINALISTS = 4, 3
"""Sketches that are refitted, and beside them those of kinds that act over the length of a record: these are sketched
on more of the records, so that their shares are not to be held against the others'."""

REFITS_PER_KIND = 2


def judge(
    views: Sequence[View],
    fitting: Evaluator,
    base: Fit,
    progress: Progress,
    is_noise: Callable[[Fit], bool] = lambda _: False,
) -> list[Ranked]:
    """All effects worth a refit, the one with the most evidence first.

    Args:
        views: what to look for suspects in; kinds that act over the length of a record in one of their own, which is
            looked at last where another kind reaches the noise without them, in its view or refitted, and not at all
            where it does everywhere.
        fitting: records to refit on.
        base: the calibrated model on those.
        progress: told what is being done.
        is_noise: whether what a fit leaves is noise that was told too low.
    """
    instant = next((view for view in views if not view.is_lasting), None)
    lasting = [view for view in views if view.is_lasting]
    late = instant is not None and instant.is_late  # where a drift has come to look like a step
    kinds = {} if instant is None else instant.registry
    ranked: list[Ranked] = []
    refits: Refits = {}
    looks = looks_from(base) if instant is None or not instant.is_unbent else [beside, afar]
    for number, look in enumerate(looks):
        if number > 0:
            progress("nothing seen so far reaches the noise; looking from elsewhere")
        if instant is not None and instant.is_late:
            there = instant.there.hypothesis
            begun = replace(base.hypothesis, motions=there.motions, offsets=there.offsets)
            found = look(instant, replace(base, hypothesis=begun), progress)
            sketches = [_of_whole(sketch, fitting) for sketch in found]
        else:
            sketches = [] if instant is None else look(instant, base, progress)
        if lasting and (number > 0 or late or not _is_met(sketches, fitting, base, refits, progress)):
            sketches += [sketch for view in lasting for sketch in beside(view, base, progress)]
            lasting = []
        rows = _weighed(ranked, sketches, fitting, base, kinds, progress, refits)
        ranked = _first_in_detail(rows, fitting, progress)
        if ranked and (ranked[0].fit.ratio < EXPLAINED or is_noise(ranked[0].fit)):
            return ranked
    # What reached the noise in the seconds of its view does not in all that is fitted.
    sketches = [sketch for view in lasting for sketch in beside(view, base, progress)]
    return _weighed(ranked, sketches, fitting, base, kinds, progress, refits) if sketches else ranked


Refits = dict[Sketch, Fit | None]
"""Sketches that were refitted before they were compared; None where the model with them diverges."""


def _is_met(sketches: Sequence[Sketch], fitting: Evaluator, base: Fit, refits: Refits, progress: Progress) -> bool:
    """Whether a suspect reaches the noise that the calibrated model does not: in its sketch, or the best one refitted.

    A few steps on the beginning of the records leave numbers of the rig where they are wrong, and with them a misfit.
    What a refit leaves is less than would have another effect looked for beside it.
    """
    if base.ratio <= REACHED or not sketches:
        return False
    if any(sketch.fit.ratio < REACHED for sketch in sketches):
        return True
    best = sketches[0]
    if best.share <= 0.0:
        return False
    progress(_refitting(best, fitting))
    found = refits[best] = refit_sketched(fitting, base, best.fit.hypothesis)
    return found is not None and found.ratio < REACHED and not is_faint(fitting, found)


def _refitting(sketch: Sketch, fitting: Evaluator) -> str:
    return f"refitting {sketch.effect.label()} with all numbers on {fitting.extent}"


def _weighed(
    known: list[Ranked],
    sketches: Sequence[Sketch],
    fitting: Evaluator,
    base: Fit,
    kinds: Registry,
    progress: Progress,
    refits: Refits,
) -> list[Ranked]:
    """What was refitted before and the best of these sketches, refitted, the one with the most evidence first."""
    more = finals(sketches, fitting, base, kinds, progress, known=known, refits=refits)
    others = [row for row in known if row.refitted or not any(is_alike(row.fit, new.fit) for new in more)]
    return settled_apart(fitting, ranked_together(others, more), progress) if known else more


def _first_in_detail(ranked: list[Ranked], fitting: Evaluator, progress: Progress) -> list[Ranked]:
    """The ranking with the first of it in more detail, where that tells much; effects before it stay as in all rows."""
    if not ranked or ranked[0].fit.ratio < EXPLAINED:
        return ranked
    first = ranked[0].fit
    finer = in_more_detail(fitting, first, progress, which=slice(-1, None))
    return ranked if finer is first else reranked(ranked, finer)


def looks_from(base: Fit) -> list[Look]:
    """How suspects are looked for, one way after the other for as long as nothing reaches the noise.

    Args:
        base: the calibrated model.
    """
    if base.ratio <= SMALL and not pulled(base):
        return [beside]
    return [beside, afar] if base.ratio <= LARGE else [afar, beside]


SMALL, LARGE = 3.0, 8.0
"""Residual over noise of the calibrated model: up to the first its neighbourhood alone tells suspects apart, above the
second the beginning of the records is seen first, since nothing is linear."""


def _of_whole(sketch: Sketch, fitting: Evaluator) -> Sketch:
    """A sketch on parts of the records without what these parts have for themselves."""
    hypothesis = of_whole(sketch.fit.hypothesis, [target.record for target in fitting.targets])
    return replace(sketch, fit=replace(sketch.fit, hypothesis=hypothesis))


def finals(
    sketches: Sequence[Sketch],
    fitting: Evaluator,
    base: Fit,
    registry: Registry,
    progress: Progress,
    known: Sequence[Ranked] = (),
    refits: Mapping[Sketch, Fit | None] | None = None,
) -> list[Ranked]:
    """The best sketches refitted, but for those that plainly stay above the noise that another has reached.

    Nor is refitted what takes next to nothing away beside what a refit has (``_next_to_nothing``); but the best of each
    family is, in each look.

    Args:
        sketches: of suspects.
        fitting: records to refit on.
        base: the model without an effect more.
        registry: kinds to try where the first of them has come to.
        progress: told what is being done.
        known: refitted before; what is like one of them is not refitted again.
        refits: of sketches that were refitted already.
    """
    lasting = [sketch for sketch in sketches if sketch.effect.family == "time"]
    instant = [sketch for sketch in sketches if sketch.effect.family != "time"]
    families = _best(instant, FINALISTS), _best(lasting, LASTING_FINALISTS)
    best, ahead = by_share([*families[0], *families[1]]), [family[0] for family in families if family]
    refitted = [row.fit for row in known if row.refitted]
    finalists = [sketch for sketch in best if not any(is_alike(sketch.fit, found) for found in refitted)]
    ranked, done = list[Ranked](), refits or {}
    beaten: list[tuple[Fit, float]] = []
    leader: tuple[Sketch, Leader] | None = None
    for sketch in finalists:
        if leader is not None and _is_out(sketch, leader[0]):
            beaten.append((sketch.fit, max(sketch.fit.ratio / leader[0].fit.ratio, RULED_OUT)))
            continue
        is_asked = sketch in done or sketch in ahead
        behind = None if is_asked else _next_to_nothing(sketch, base, [*refitted, *(row.fit for row in ranked)])
        if behind is not None:
            progress(f"{sketch.effect.label()} takes next to nothing away and is not refitted")
            beaten.append((sketch.fit, behind))
            continue
        if sketch not in done:
            progress(_refitting(sketch, fitting))
        found = sketch.fit.hypothesis
        if leader is not None:
            first, farther = against(leader[1], base, found)
            if first is not None and farther > RULED_OUT:
                beaten.append((first, farther))
            if first is None or farther > RULED_OUT:
                continue
            found = first.hypothesis
        result = done[sketch] if sketch in done else refit_sketched(fitting, base, found)
        if result is not None:
            effect = result.hypothesis.effects[-1]
            progress(f"{effect.label()} leaves {result.ratio:.2f} times the noise, {base.ratio:.2f} without it")
            ranked.append(Ranked.of(result, sketch=sketch.fit))
            if _leads(result, sketch) and (leader is None or result.ratio < leader[1].fit.ratio):
                leader = (sketch, Leader(result, fitting))
    ordered = with_others_there(fitting, base, with_evidence(ranked), registry, progress)
    return [*ordered, *_beaten_rows(ordered or known, beaten)]


def _beaten_rows(ordered: Sequence[Ranked], beaten: Sequence[tuple[Fit, float]]) -> list[Ranked]:
    """Rows of what was not refitted: so many times as far off as the first of a ranking."""
    rows: list[Ranked] = []
    for fit_there, farther in beaten:
        behind = 0.5 * (farther**2 - 1.0) * ordered[0].fit.chi2 / misfit_in_common(ordered)
        evidence = ordered[0].log_evidence - behind
        rows.append(Ranked(fit_there.hypothesis.effects[-1], fit_there, refitted=False, log_evidence=evidence))
    return rows


NEXT_TO_NOTHING, GROWTH = 0.25, 0.15
"""Share of what a refit has taken of the misfit beyond the noise, up to which a sketch that takes it away is not
refitted, and the share of the cost that it must stay behind by at least: of 40 sketches in five hidden cases, by
slopes that were formed anew, none grew by more when they were refitted. What is left out took up to two fifths of a
search."""


def _next_to_nothing(sketch: Sketch, base: Fit, refitted: Sequence[Fit]) -> float | None:
    """Times as far off as the best refit, of a sketch that takes next to nothing away beside it; None for others.

    Where the model without the suspect nearly reaches the noise on the sketch's part of the records, that tells little.

    Args:
        sketch: of a suspect.
        base: the model without it, on the records of the refits.
        refitted: the model with other suspects.
    """
    if not refitted or sketch.base.ratio <= EXPLAINED:
        return None
    best = min(refitted, key=attrgetter("cost"))
    most, growth = takes_away(base, best), GROWTH / (1.0 - 1.0 / sketch.base.ratio**2)
    if takes_away(sketch.base, sketch.fit) >= min(NEXT_TO_NOTHING * most, most - growth):
        return None
    return max(RULED_OUT, sketch.fit.ratio / sketch.base.ratio * base.ratio / best.ratio)


def _leads(result: Fit, sketch: Sketch) -> bool:
    """Whether a refit reaches the noise, or comes near it where its sketch has.

    Records longer than those of the sketch hold more of what impacts make of the force's noise.
    """
    return result.ratio < CLOSE_ENOUGH or (result.ratio < NOISE_NEAR and sketch.fit.ratio < CLOSE_ENOUGH)


def _is_out(sketch: Sketch, best: Sketch) -> bool:
    """Whether a sketch already shows that it will not reach what the best one reached."""
    left_behind = sketch.base is best.base and sketch.share < LEFT_BEHIND * best.share
    return left_behind or sketch.fit.ratio > RULED_OUT * best.fit.ratio


LEFT_BEHIND = 0.85
"""A sketch that takes away a smaller share of what the best one does is not refitted when that reaches the noise."""


def _best(sketches: Sequence[Sketch], most: int) -> list[Sketch]:
    """The best of sketches on the same records, a few of each kind, without those far behind."""
    chosen: list[Sketch] = []
    for sketch in apart(by_share(sketches)):
        same = [other for other in chosen if other.effect.kind == sketch.effect.kind]
        behind = len(chosen) >= LEAST_REFITS and sketch.share < FAR_BEHIND * chosen[0].share
        if len(same) < REFITS_PER_KIND and not behind and sketch.share > 0:
            chosen.append(sketch)
    return chosen[:most]


LEAST_REFITS = 3
"""Finalists at least, however far behind on their part of the records."""


def restarted(evaluator: Evaluator, base: Fit, found: Fit) -> Fit:
    """The best of the fit and of fits with its last effect that start from the rig file's numbers again.

    States at the start of records are sought anew as well: without the effect others fit best.

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
            start = set_in_motion(window, replace(start, starts={}), unknowns)
            first = fit(window, start, alone, tolerance=1e-2)
            again = fit_from_own_starts(evaluator, calibrate(evaluator, first.hypothesis, unknowns))
        except ArithmeticError:
            continue
        best = min(best, again, key=lambda f: f.cost)
        if best.ratio < CLOSE_ENOUGH:
            break
    return best


CLOSE_ENOUGH = 1.1
"""Residual over noise at which no other start is tried."""
