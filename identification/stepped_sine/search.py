"""Which effect do stepped sines miss? Kinds are tried on the balance of forces, refitted, and ranked by evidence."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from identification.acceptance import LATER_SHARE
from identification.diagnose import MOST_EFFECTS
from identification.evaluate import Evaluator
from identification.evidence import (
    LEAST_EVIDENCE,
    Ranked,
    log_fit,
    log_standing,
    misfit_in_common,
    misfit_of,
    with_evidence,
)
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, Unknown, effect_unknowns, own_unknowns
from identification.parallel import in_parallel
from identification.progress import Progress
from identification.reached import LEAST_SHARE, NOISE_REACHED, takes_away
from identification.scene import places_of
from identification.screen import BETWEEN, Projection
from identification.stepped_sine.balance import Balance
from identification.stepped_sine.record import SteppedSine
from identification.stepped_sine.target import SteppedTarget
from models.effects import Effect, Registry
from models.effects.protocol import Place, Scene

BEGUN = 2
"""Trials of each kind and variant from which it is fitted."""

ITERATIONS = 40

SKETCH_TOLERANCE, TOLERANCE = 3e-3, 2e-4
"""Relative decrease of the cost that ends a fit: of a suspect among many, and of the best of its kind."""


@dataclass(frozen=True, eq=False)
class Addition:
    """One round: what was tried, and the model with the best of it.

    Attributes:
        ranked: kinds, the one with the most evidence first.
        fit: of the first of them.
        odds: logarithm of its odds against the model without it.
        share: of the squared misfit beyond the noise that it takes away.
    """

    ranked: tuple[Ranked, ...]
    fit: Fit
    odds: float
    share: float


def add_effects(
    evaluator: Evaluator, base: Fit, registry: Registry, progress: Progress
) -> tuple[list[Addition], list[str]]:
    """Effects added one after the other as long as each explains enough, by the rules of ``identification.diagnose``.

    Args:
        evaluator: of stepped sines.
        base: the calibrated model.
        registry: kinds to try.
        progress: told what is done.

    Returns:
        the rounds whose effect was added, and what was decided, in words.
    """
    added: list[Addition] = []
    decisions: list[str] = []
    while len(added) < MOST_EFFECTS and base.ratio > NOISE_REACHED:
        found = addition(evaluator, base, registry, progress)
        name = found.fit.hypothesis.effects[-1].label()
        if found.odds < LEAST_EVIDENCE or found.share < (LATER_SHARE if added else LEAST_SHARE):
            decisions.append(f"{name} is the best of the library, but takes away only {found.share:.0%}: not added")
            break
        decisions.append(
            f"{name} added: residual from {base.ratio:.1f} to {found.fit.ratio:.1f} times the noise, {found.share:.0%} "
            f"of the misfit beyond the noise; {found.fit.hypothesis.effects[-1].in_words()}"
        )
        progress(decisions[-1])
        added.append(found)
        for index in reversed(range(len(added) - 1)):
            less = _without(evaluator, added[-1].fit, index)
            if less is None or _speaks_for(added[-1].fit, less) >= LEAST_EVIDENCE:
                continue
            decisions.append(
                f"{added[-1].fit.hypothesis.effects[index].label()} taken out again: it explains nothing more"
            )
            progress(decisions[-1])
            del added[index]
            added[-1] = replace(added[-1], fit=less)
        base = added[-1].fit
    return added, decisions


def _speaks_for(found: Fit, less: Fit) -> float:
    """Logarithm of the odds of a model against one with an effect less, in units of what the better of them leaves."""
    scale = misfit_of(min(found, less, key=lambda each: each.ratio))
    return log_fit(found, scale) - log_fit(less, scale)


def addition(evaluator: Evaluator, base: Fit, registry: Registry, progress: Progress) -> Addition:
    """Every kind beside a model, fitted with all its numbers and ranked.

    Args:
        evaluator: of stepped sines.
        base: the model without it.
        registry: kinds to try.
        progress: told what is done.
    """
    soft = evaluator.with_targets([t.soft() for t in evaluator.targets if isinstance(t, SteppedTarget)])
    there = fit(soft, base.hypothesis, base.unknowns, max_iterations=ITERATIONS, tolerance=TOLERANCE)
    starts = _starts(soft, there, registry)
    progress(f"fitting {len(starts)} suspects beside {_in_words(base.hypothesis)}")
    found = in_parallel(evaluator.jobs, partial(_sketched, soft.with_jobs(1), base.unknowns), starts)
    best_first = _best_of_each(with_evidence([Ranked.of(sketch) for sketch in found if sketch is not None]))
    progress(f"refitting the best of {len(best_first)} kinds and variants to the steady state")
    ended = partial(_to_the_end, soft, evaluator)
    finals = in_parallel(evaluator.jobs, ended, [row.fit for row in best_first])
    ranked = with_evidence([Ranked.of(found) for found in finals if found is not None])
    if not ranked:
        raise ArithmeticError("no effect of the library leaves a steady state")
    best = ranked[0]
    odds = best.log_evidence - log_standing(base, misfit_in_common(ranked))
    return Addition(tuple(ranked), best.fit, odds, takes_away(base, best.fit))


def on_trial(evaluator: Evaluator, final: Fit, index: int, registry: Registry, progress: Progress) -> Addition:
    """One effect of a model taken out, and every kind tried in its place, with all other numbers fitted again.

    Args:
        evaluator: of stepped sines.
        final: the model.
        index: of the effect.
        registry: kinds to try.
        progress: told what is done.
    """
    base = _without(evaluator, final, index)
    if base is None:
        raise ArithmeticError("the model without the effect diverges")
    return addition(evaluator, base, registry, progress)


def _without(evaluator: Evaluator, final: Fit, index: int) -> Fit | None:
    """The model fitted again without one of its effects, or None where that diverges."""
    without = final.hypothesis.without_effect(index)
    rig = tuple(unknown for unknown in final.unknowns if getattr(unknown, "effect", None) is None)
    soft = evaluator.with_targets([t.soft() for t in evaluator.targets if isinstance(t, SteppedTarget)])
    sketch = _tried(soft, without, (*rig, *effect_unknowns(without)), TOLERANCE)
    return None if sketch is None else _to_the_end(soft, evaluator, sketch)


def _in_words(hypothesis: Hypothesis) -> str:
    return " and ".join(effect.label() for effect in hypothesis.effects) or "the linear model"


def _sketched(evaluator: Evaluator, shared: tuple[Unknown, ...], start: Hypothesis) -> Fit | None:
    return _tried(evaluator, start, (*shared, *own_unknowns(start)), SKETCH_TOLERANCE)


def _tried(evaluator: Evaluator, start: Hypothesis, unknowns: Sequence[Unknown], tolerance: float) -> Fit | None:
    """A fit, or None where it diverges."""
    try:
        return fit(evaluator, start, unknowns, max_iterations=ITERATIONS, tolerance=tolerance)
    except ArithmeticError:
        return None


def _to_the_end(soft: Evaluator, evaluator: Evaluator, sketch: Fit) -> Fit | None:
    """A sketch fitted to the end: to the balance of forces, then to the steady state; None where that diverges."""
    first = _tried(soft.with_jobs(1), sketch.hypothesis, sketch.unknowns, TOLERANCE)
    start = sketch if first is None else first
    try:
        return fit(
            evaluator.with_jobs(1),
            start.hypothesis,
            start.unknowns,
            max_iterations=ITERATIONS,
            tolerance=TOLERANCE,
            precise=True,
        )
    except ArithmeticError:
        return None


def _starts(soft: Evaluator, there: Fit, registry: Registry) -> list[Hypothesis]:
    """The most promising trials of each kind and variant beside the model."""
    projection = Projection(there)
    scene = scene_of([t.record for t in soft.targets if isinstance(t, SteppedTarget)], there.hypothesis)
    starts: list[Hypothesis] = []
    for kind in registry.values():
        if "oscillator" not in kind.structures or kind.family == "time":
            continue  # a steady state knows no time
        for place in places_of(kind, there.hypothesis.rig):
            trials = list(kind.trials(replace(scene, place=place)))
            sizes = dict.fromkeys(trial.scaled(factor) for trial in trials for factor in BETWEEN)
            models = [there.hypothesis.with_effects(size) for size in sizes]
            rows = soft.residuals([(model, None) for model in models])
            left = [
                (projection.left_of(row), model) for row, model in zip(rows, models, strict=True) if row is not None
            ]
            starts += _first_of_variants([model for _, model in sorted(left, key=lambda pair: pair[0])])
    return starts


def _first_of_variants(models: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The first few models of each variant of their last effect, the best first."""
    kept: dict[tuple[str, ...], list[Hypothesis]] = {}
    for model in models:
        row = kept.setdefault(variant(model.effects[-1]), [])
        if len(row) < BEGUN:
            row.append(model)
    return [model for row in kept.values() for model in row]


def variant(effect: Effect) -> tuple[str, ...]:
    """Kind and options of an effect."""
    return (effect.kind, *(str(getattr(effect, key)) for key in effect.options))


def _best_of_each(ranked: Sequence[Ranked]) -> list[Ranked]:
    """The first row of each variant."""
    return list({variant(row.effect): row for row in reversed(ranked)}.values())[::-1]


def scene_of(records: Sequence[SteppedSine], hypothesis: Hypothesis) -> Scene:
    """How large the measured motion is, of the sensor that is first.

    Args:
        records: stepped sines of one rig.
        hypothesis: which tells what the sensor reads per displacement.
    """
    motions = [np.abs(r.responses[0] / Balance.of(hypothesis, r).reading[0]) for r in records]
    speeds = [2.0 * np.pi * r.frequency * motion for r, motion in zip(records, motions, strict=True)]
    force = max(float(np.sqrt(0.5 * np.mean(r.force**2))) for r in records)
    speed = max(float(np.sqrt(0.5 * np.mean(s**2))) for s in speeds)
    return Scene(
        place=Place(),
        contact=None,
        structure=hypothesis.plant().structure,
        displacement=max(float(motion.max()) for motion in motions),
        velocity=speed,
        force=force,
        penetration=0.0,
        duration=1.0 / float(min(np.median(np.diff(np.sort(r.frequency))) for r in records)),
        driven_base=False,
        ground_velocity=speed,
    )
