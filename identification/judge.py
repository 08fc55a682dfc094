"""Which effect is missing? Screen all, sketch the promising, refit the best with all numbers, rank by evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

from identification.calibrate import Windows, beginning, calibrate, concerning, pulled, put_back
from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common, reweighed, with_evidence
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, free_place, own_unknowns
from identification.progress import Progress
from identification.scene import GRID, sleeves_of
from identification.screen import Projection, Suspect, promising, screen, survey
from identification.sketch import (
    FAR_BEHIND,
    HEATS,
    TOLERANCE,
    Sketch,
    afresh,
    apart,
    by_share,
    heats,
    is_alike,
    is_same_place,
    sketched_from_calibrated,
)
from models.effects import Effect, Registry
from models.rig import Beam

REFIT_WINDOWS: Windows = ((0.35, 2.0),)
"""The sketch has seen the beginning."""

PER_KIND = 2
"""Places of each kind that are sketched."""

MOST_LONG_SKETCHES = 8
"""Suspects sketched where it takes whole records."""

FINALISTS = 4
REFITS_PER_KIND = 2


def judge(
    screening: Sequence[tuple[Evaluator, Fit, Registry]],
    fitting: Evaluator,
    base: Fit,
    progress: Progress,
) -> list[Ranked]:
    """All effects worth a refit, the one with the most evidence first.

    Args:
        screening: records to screen on, the calibrated model on them, and the kinds to screen there.
        fitting: records to refit on.
        base: the calibrated model on those.
        progress: told what is being done.
    """
    instant = next((row for row in screening if not _is_lasting(row[2])), None)
    lasting = [row for row in screening if _is_lasting(row[2])]
    looks = [_screened, _surveyed] if base.ratio <= LARGE else [_surveyed, _screened]
    if base.ratio <= SMALL and not pulled(base):
        looks = [_screened]
    ranked: list[Ranked] = []
    for number, look in enumerate(looks):
        if number > 0:
            progress("nothing seen so far reaches the noise; looking from elsewhere")
        sketches = [] if instant is None else look(*instant, base, progress)
        if number == 0:
            for row in lasting:
                sketches += _screened(*row, base, progress)
        found = _best(sketches, FINALISTS, REFITS_PER_KIND)
        new = [sketch for sketch in found if not any(is_alike(sketch.fit, row.fit) for row in ranked)]
        more = _finals(new, fitting, base, progress)
        rows = [row for row in (*ranked, *more) if row.refitted]
        ranked = _settled(fitting, reweighed(ranked, rows), progress) if ranked else more
        if ranked and ranked[0].fit.ratio < EXPLAINED:
            break
    return ranked


EXPLAINED = 1.25
"""Residual over noise at which suspects are not looked for in another way."""


def _is_lasting(registry: Registry) -> bool:
    """Kinds that act over the length of a record, which its beginning does not show."""
    return any(kind.family == "time" for kind in registry.values())


def _screened(evaluator: Evaluator, there: Fit, registry: Registry, base: Fit, progress: Progress) -> list[Sketch]:
    """Sketches of what could take most away beyond the rig's numbers, on longer records than a survey's.

    They begin at the calibrated numbers, but for those that were pulled away, very likely by what is missing. Where the
    beginning of the records tells enough, it is surveyed: nothing has to be in proportion to an effect's size there.
    """
    lasting = _is_lasting(registry)
    start = there.hypothesis if lasting else put_back(there)
    telling = None if lasting else _telling(evaluator, start, base)
    seen = screen(evaluator, there, registry, progress) if telling is None else survey(*telling, registry, progress)
    found = first_of_each_kind(promising(seen, PER_KIND, _distance(there)))[:MOST_LONG_SKETCHES]
    progress(f"sketching {len(found)} suspects on {evaluator.extent}")
    effects = [suspect.effect for suspect in found]
    return sketched_from_calibrated(evaluator, there, start, effects, registry, grown=not lasting)


def _telling(evaluator: Evaluator, start: Hypothesis, base: Fit) -> tuple[Evaluator, Fit] | None:
    """The shortest beginning on which more than noise is left beside the rig's numbers, and the model there."""
    for share, seconds in TELLING_WINDOWS:
        window = beginning(evaluator, share, seconds)
        bare = fit(window, start, concerning(base, window), max_iterations=0)
        if Projection(bare).misfit > TELLING**2 * bare.n_data:
            return window, bare
    return None


TELLING_WINDOWS: Windows = ((0.02, 0.4), (0.1, 0.75), (0.2, 1.5))
"""Shares of the response's energy, and seconds at least, that are surveyed."""

TELLING = 1.3
"""Residual over noise that tells effects apart."""


SMALL, LARGE = 3.0, 8.0
"""Residual over noise of the calibrated model: up to the first its neighbourhood alone tells suspects apart, above the
second the beginning of the records is seen first, since nothing is linear."""


def _surveyed(evaluator: Evaluator, there: Fit, registry: Registry, base: Fit, progress: Progress) -> list[Sketch]:
    """Sketches of the best places of every kind, from the beginning of the records and the numbers as given.

    A calibration without the missing effect pulls the numbers to where they imitate it, and the effect added to that
    makes matters worse; from the numbers as given, it helps.
    """
    del there  # from the numbers as given, not from the calibrated ones
    start = afresh(base.hypothesis)
    short = beginning(evaluator, *HEATS[0][:2])
    bare = fit(short, start, concerning(base, short), max_iterations=0)
    found = promising(survey(short, bare, registry, progress), PER_KIND, _distance(base))
    progress(f"sketching {len(found)} suspects on the beginning of the records")
    return heats(evaluator, start, base, [suspect.effect for suspect in found], registry)


def _distance(base: Fit) -> float:
    """Distance, m, within which two places of the grid lie in one valley."""
    structure = base.hypothesis.rig.structure
    return 1.5 * structure.length / GRID if isinstance(structure, Beam) else 0.0


def first_of_each_kind(suspects: Sequence[Suspect]) -> list[Suspect]:
    """The best place of every kind before the second place of any.

    Args:
        suspects: the best first.
    """
    best = {suspect.effect.kind: suspect for suspect in reversed(suspects)}
    return [*(s for s in suspects if s is best[s.effect.kind]), *(s for s in suspects if s is not best[s.effect.kind])]


def _finals(finalists: Sequence[Sketch], fitting: Evaluator, base: Fit, progress: Progress) -> list[Ranked]:
    """The finalists refitted, but for those that plainly stay above the noise that another has reached."""
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
            first, farther = _beside(leader[1], fitting, base, found)
            if first is not None and farther > RULED_OUT:
                beaten.append((first, farther))
            if first is None or farther > RULED_OUT:
                continue
            found = first.hypothesis
        result = refit(fitting, base, found.effects[-1], found.values, () if leader else REFIT_WINDOWS)
        if result is not None:
            ranked.append(Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0))
            if result.ratio < min(CLOSE_ENOUGH, leader[1].ratio if leader else CLOSE_ENOUGH):
                leader = (sketch, result)
    ordered = with_evidence(ranked)
    ordered = _settled(fitting, with_evidence([*ordered, *_at_sleeves(fitting, base, ordered)]), progress)
    for fit_there, farther in beaten:
        behind = 0.5 * (farther**2 - 1.0) * ordered[0].fit.n_data
        evidence = ordered[0].log_evidence - behind
        ordered.append(Ranked(fit_there.hypothesis.effects[-1], fit_there, refitted=False, log_evidence=evidence))
    return ordered


def _beside(leader: Fit, fitting: Evaluator, base: Fit, found: Hypothesis) -> tuple[Fit | None, float]:
    """A model fitted on the beginning, and how many times as far off as the leader it is there.

    It is fitted with the leader's slopes: whatever comes as near to the records has nearly the same.
    """
    window = beginning(fitting, *REFIT_WINDOWS[0])
    there = fit(window, leader.hypothesis, leader.unknowns, max_iterations=0)
    unknowns = (*base.unknowns, *own_unknowns(found))
    slopes = there.jacobian[: len(base.unknowns)]
    try:
        first = fit(
            window, found, unknowns, max_iterations=ITERATIONS_BESIDE, jacobian=slopes, keep=True, tolerance=TOLERANCE
        )
    except ArithmeticError:
        return None, inf
    return first, first.ratio / there.ratio


ITERATIONS_BESIDE = 8
"""Of a model that has to come near the noise, which another has reached, to be fitted further."""


def _at_sleeves(fitting: Evaluator, base: Fit, ranked: Sequence[Ranked]) -> list[Ranked]:
    """The best effect again at a sleeve that its free place has come to, where it has no place to fit."""
    if not ranked:
        return []
    effect, rig = ranked[0].effect, ranked[0].fit.hypothesis.rig
    rows = []
    for place in sleeves_of(rig) if free_place(effect) and "sleeve" in effect.places else ():
        if is_same_place(place, effect.place, rig):
            result = refit(fitting, base, replace(effect, place=place), ranked[0].fit.hypothesis.values)
            if result is not None:
                rows.append(Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0))
    return rows


def _settled(fitting: Evaluator, ranked: list[Ranked], progress: Progress) -> list[Ranked]:
    """The ranking with those fitted to the end that the refits' tolerance cannot tell from the first."""
    within = 0.5 * REFIT_TOLERANCE * ranked[0].fit.cost / misfit_in_common(ranked) if ranked else 0.0
    close = [row for row in ranked if row.log_evidence > ranked[0].log_evidence - within]
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
        start = replace(base.hypothesis, values=values).with_effects(effect)
        window = beginning(evaluator, *HEATS[-1][:2])
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


def refit(
    evaluator: Evaluator,
    base: Fit,
    effect: Effect,
    values: Mapping[str, float],
    windows: Windows = REFIT_WINDOWS,
) -> Fit | None:
    """Everything refitted with one more effect; None where the model with it diverges.

    Args:
        evaluator: records to fit.
        base: the model without the effect, for its effects and unknowns.
        effect: where its fit begins.
        values: of the rig's numbers there.
        windows: of the first fits.
    """
    hypothesis = replace(base.hypothesis, values=values).with_effects(effect)
    try:
        unknowns = (*base.unknowns, *own_unknowns(hypothesis))
        return calibrate(evaluator, hypothesis, unknowns, windows, tolerance=REFIT_TOLERANCE)
    except ArithmeticError:
        return None


REFIT_TOLERANCE = 2e-3
"""Relative decrease of the cost that ends a refit; the one that wins is polished."""
