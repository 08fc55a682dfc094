"""Which effect is missing? Screen all, sketch the promising, refit the best with all numbers, rank by evidence."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import log, pi

import numpy as np

from identification.calibrate import beginning, calibrate, strained
from identification.evaluate import Evaluator
from identification.fit import Fit, fit
from identification.hypothesis import EffectUnknown, Hypothesis, PlaceUnknown, Unknown, effect_unknowns
from identification.screen import promising, screen
from models.effects import Effect, Registry
from models.rig import Beam

Progress = Callable[[str], None]

SKETCHES_PER_KIND = 2
MOST_SKETCHES = 10
FINALISTS = 4
REFITS_PER_KIND = 2

FAR_BEHIND = 0.5
"""A suspect whose sketch takes away less than this share of what the best one does is left out."""


@dataclass(frozen=True, eq=False)
class Ranked:
    """A suspect after its fit.

    Attributes:
        effect: the last effect of the fit's hypothesis.
        fit: with all unknowns refitted, or the sketch.
        refitted: whether all unknowns were.
        log_evidence: not yet normalised.
    """

    effect: Effect
    fit: Fit
    refitted: bool
    log_evidence: float


@dataclass(frozen=True, eq=False)
class _Sketch:
    """A first fit of a suspect on the beginning of the records.

    Attributes:
        base: the model without the suspect on the same part.
        fit: with it.
    """

    base: Fit
    fit: Fit

    @property
    def share(self) -> float:
        """Share of the cost that the suspect takes away, less what its parameters cost in evidence."""
        return (self.base.cost - self.fit.cost + 2.0 * log_occam(self.fit)) / max(self.base.cost, 1.0)


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
    start = replace(base.hypothesis, values={}) if strained(base) and base.ratio > SMALL else base.hypothesis
    sketches: list[_Sketch] = []
    for evaluator, there, registry in screening:
        shortlist = promising(screen(evaluator, there, registry, progress), SKETCHES_PER_KIND)[:MOST_SKETCHES]
        lasting = any(kind.family == "time" for kind in registry.values())
        whole = lasting or base.ratio < SMALL
        window = evaluator if whole else beginning(evaluator, *SKETCH_WINDOW)
        bare = fit(window, start, concerning(base, window), max_iterations=SKETCH_ITERATIONS, tolerance=1e-2)
        kept = shortlist[: MOST_SKETCHES // 2] if whole else shortlist
        progress(f"sketching {len(kept)} suspects on {_seconds(window):.1f} s of records")
        for suspect in kept:
            quick = _fitted(window, start, base, suspect.effect)
            if quick is not None:
                sketches.append(_Sketch(bare, quick))
    return _finals(_best(sketches, FINALISTS, REFITS_PER_KIND), fitting, base, progress)


def _finals(finalists: Sequence[_Sketch], fitting: Evaluator, base: Fit, progress: Progress) -> list[Ranked]:
    """The finalists refitted, unless the first reaches the noise and the beginning alone already rules another out."""
    ranked: list[Ranked] = []
    ruled_out: list[_Sketch] = []
    for sketch in finalists:
        hypothesis = sketch.fit.hypothesis
        if ranked and ranked[0].fit.ratio < CLOSE_ENOUGH and sketch.fit.ratio > RULED_OUT * finalists[0].fit.ratio:
            ruled_out.append(sketch)
            continue
        progress(f"refitting {hypothesis.effects[-1].label()} with all numbers on {_seconds(fitting):.0f} s of records")
        result = refit(fitting, base, hypothesis.effects[-1], hypothesis.values)
        if result is not None:
            ranked.append(Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0))
    ordered = with_evidence(ranked)
    for sketch in ruled_out:
        behind = 0.5 * (sketch.fit.cost - finalists[0].fit.cost)
        effect = sketch.fit.hypothesis.effects[-1]
        ordered.append(Ranked(effect, sketch.fit, refitted=False, log_evidence=ordered[0].log_evidence - behind))
    return ordered


SMALL = 1.5
"""Residual over noise below which the beginning of the records is too short to tell suspects apart."""

RULED_OUT = 1.3
"""A sketch this many times as far off as the best one, when that reaches the noise, is not refitted."""


def _best(sketches: Sequence[_Sketch], most: int, per_kind: int) -> list[_Sketch]:
    """The best sketches, a few of each kind, without those far behind."""
    chosen: list[_Sketch] = []
    for sketch in sorted(sketches, key=lambda s: -s.share):
        effect = sketch.fit.hypothesis.effects[-1]
        same = [other for other in chosen if other.fit.hypothesis.effects[-1].kind == effect.kind]
        repeated = any(_same_place(effect, other.fit.hypothesis.effects[-1], sketch.fit) for other in same)
        behind = len(chosen) >= LEAST_REFITS and sketch.share < FAR_BEHIND * chosen[0].share
        if len(same) < per_kind and not behind and not repeated and sketch.share > 0:
            chosen.append(sketch)
    return chosen[:most]


LEAST_REFITS = 3
"""Finalists at least, however far behind."""


def _same_place(one: Effect, other: Effect, result: Fit) -> bool:
    """Two fits that ended at the same place along the beam, with the same options."""
    if any(getattr(one, key) != getattr(other, key) for key in one.options):
        return False
    structure, here, there = result.hypothesis.rig.structure, one.place.position, other.place.position
    if here is None or there is None or one.place.sleeve != other.place.sleeve or not isinstance(structure, Beam):
        return one.place == other.place
    return abs(here - there) < SAME_PLACE * structure.length


SAME_PLACE = 0.02
"""Share of the length within which two positions are one."""


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
        window = beginning(evaluator, *SKETCH_WINDOW)
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
    """Everything refitted with one more effect, from the rig's ``values``; None where the model with it diverges."""
    hypothesis = replace(base.hypothesis, values=values).with_effects(effect)
    try:
        return calibrate(evaluator, hypothesis, _all_unknowns(base, effect), REFIT_WINDOWS, tolerance=REFIT_TOLERANCE)
    except ArithmeticError:
        return None


REFIT_WINDOWS = ((0.35, 2.0),)
"""The sketch has seen the beginning."""

REFIT_TOLERANCE = 2e-3
"""Relative decrease of the cost that ends a refit; the one that wins is polished."""


def concerning(base: Fit, evaluator: Evaluator) -> tuple[Unknown, ...]:
    """The unknowns of a fit that concern the evaluator's records."""
    names = {target.record.name for target in evaluator.targets}
    return tuple(unknown for unknown in base.unknowns if unknown.record is None or unknown.record in names)


def _all_unknowns(base: Fit, effect: Effect) -> tuple[Unknown, ...]:
    """The unknowns of the fit so far, then those of one more effect."""
    hypothesis = base.hypothesis.with_effects(effect)
    index = len(base.hypothesis.effects)
    new = [u for u in effect_unknowns(hypothesis) if isinstance(u, EffectUnknown | PlaceUnknown) and u.effect == index]
    return (*base.unknowns, *new)


def _fitted(evaluator: Evaluator, start: Hypothesis, base: Fit, effect: Effect) -> Fit | None:
    """The effect alone, then everything: the rig's numbers are nearly right, and must not be pulled away first."""
    names = {target.record.name for target in evaluator.targets}
    unknowns = [u for u in _all_unknowns(base, effect) if u.record is None or u.record in names]
    alone = [u for u in unknowns if isinstance(u, EffectUnknown | PlaceUnknown) and u not in base.unknowns]
    try:
        sized = _best_size(evaluator, start, effect)
        first = fit(evaluator, start.with_effects(sized), alone, max_iterations=SKETCH_ITERATIONS, tolerance=2e-2)
        return fit(evaluator, first.hypothesis, unknowns, max_iterations=SKETCH_ITERATIONS, tolerance=2e-2)
    except ArithmeticError:
        return None


def _best_size(evaluator: Evaluator, start: Hypothesis, effect: Effect) -> Effect:
    """The effect at the size that fits best of a few, since least squares finds only the nearest valley."""
    sizes = [effect.scaled(factor) for factor in SIZES]
    rows = evaluator.residuals([(start.with_effects(size), None) for size in sizes])
    costs = [np.inf if row is None else float(row @ row) for row in rows]
    return sizes[int(np.argmin(costs))]


SIZES = (0.1, 0.2, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0, 8.0)
"""Factors on a suspect's size tried before it is fitted."""

SKETCH_WINDOW = (0.1, 0.75)
"""Share of the response's energy, and seconds at least, on which suspects are sketched."""

SKETCH_ITERATIONS = 6


def with_evidence(ranked: Sequence[Ranked]) -> list[Ranked]:
    """Sorted by Laplace's approximation to the evidence, with residuals in units of what the best fit leaves.

    log Z = -cost / (2 s^2) + sum over the effect's unknowns of log(posterior std / prior std); s^2 is 1 where the noise
    is reached and the best reduced chi-square where no model reaches it, so that a misfit common to all does not speak.
    Source: D. J. C. MacKay, Information Theory, Inference, and Learning Algorithms (2003), chapter 28.
    """
    if not ranked:
        return []
    scale = max(1.0, min(r.fit.ratio for r in ranked) ** 2)
    scored = [replace(r, log_evidence=-0.5 * r.fit.cost / scale + log_occam(r.fit)) for r in ranked]
    return sorted(scored, key=lambda r: -r.log_evidence)


def log_occam(result: Fit) -> float:
    """Logarithm of the share of the prior's volume that the data leave to the last effect's unknowns."""
    index = len(result.hypothesis.effects) - 1
    own = [i for i, u in enumerate(result.unknowns) if getattr(u, "effect", None) == index]
    if not own:
        return 0.0
    total = 0.0
    for i, std in zip(own, np.sqrt(np.maximum(np.diag(result.covariance)[own], 1e-300)), strict=True):
        unknown = result.unknowns[i]
        spread = PLACES if isinstance(unknown, PlaceUnknown) else _spread(unknown)
        total += min(0.0, log(np.sqrt(2.0 * pi) * std / spread))
    return total


PLACES = 20.0
"""Prior range of a position in its own coordinate, twentieths of the length."""


def _spread(unknown: Unknown) -> float:
    assert isinstance(unknown, EffectUnknown)
    return float(np.sqrt(2.0 * pi) * (1.0 if unknown.about.scale == "log" else unknown.about.spread / unknown.unit))


def probabilities(log_evidence: Sequence[float]) -> list[float]:
    """Shares of the evidence."""
    weights = np.exp(np.array(log_evidence) - max(log_evidence))
    return [float(w) for w in weights / weights.sum()]


def _seconds(evaluator: Evaluator) -> float:
    return sum(target.record.duration for target in evaluator.targets)
