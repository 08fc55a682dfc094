"""From fits to what a person reads: candidates, intervals, groups that cannot be told apart."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, hypot, inf, isfinite, log, sqrt

import numpy as np

from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common, probabilities
from identification.fit import Fit
from identification.hypothesis import EffectUnknown, Hypothesis, PlaceUnknown, RigUnknown, free_place
from identification.reached import LINEAR_APART, NOISE_REACHED
from identification.result import AddedEffect, Candidate, Estimate, Score
from identification.scene import is_same_place, valley
from models.effects import Effect
from models.rig import Rig

TELLABLE = 0.02
"""Candidates with a larger share of the probability than this cannot be excluded."""

EXCLUDED_BY = 2.0 * log(1.0 / TELLABLE)
"""Chi-square, in units of its round, by which a candidate that is as probable beforehand has that share."""

UNTRIED, UNTRIED_BEYOND, UNTRIED_MISSED = 0.05, 0.2, 0.5
"""Probability that what is missing is none of what was judged, or lies in a valley that no start led to: where the
error reaches the noise, where more is left, and where what was learnt does not hold on a record kept aside. Of effects
named in the reported hidden cases up to seed 38803 (results/hidden_effects), as far as their files tell what was left,
18 of 367 and 4 of 21 were not there; the mean of the share given that is 18.5 of 368 and 4.5 of 22 (H. Jeffreys, Proc.
R. Soc. A 186 (1946) 453). Of the five that did not hold on a record kept aside, in the two batches that told so, 3 were
not there."""

UNTRIED_LATER, UNTRIED_LATER_BEYOND = 0.09, 0.5
"""The least of that for an effect that was added beside another, where the error reaches the noise and where more is
left: what the first one leaves for want of a better place or law, a second one takes. Of such effects in the batches
from 16963 to 33301 (results/hidden_effects) 3 of 38 and 4 of 5 were not there, the five in four cases of two batches:
too few to take more than half by."""

AT_REST_ONLY = "from one level of FRFs or mode shapes no nonlinearity can be seen"

LARGEST_LOG_STD = 3.0
"""A standard deviation of more e-folds than this is reported as this: the number is not known at all."""


KNOWN_TO, PLACE_KNOWN_TO = LINEAR_APART, 1e-4
"""What no number is told closer than, as a share of itself, and no place, as a share of the length: two ways to compute
the same rig are as far apart, and noise, however little is left of it over all samples of a record, says nothing of
that."""


def rig_estimates(result: Fit) -> tuple[Estimate, ...]:
    """Calibrated numbers of the rig with standard deviations, none wider than what its owner knew beforehand."""
    rows: list[Estimate] = []
    for unknown, std in zip(result.unknowns, result.std(), strict=True):
        if isinstance(unknown, RigUnknown):
            about = unknown.parameter
            value = result.hypothesis.values.get(about.path, about.value)
            share = min(hypot(float(std) * about.tolerance, KNOWN_TO), about.tolerance)
            rows.append(Estimate(about.path, value, share * value, about.unit))
    return tuple(rows)


def effect_estimates(result: Fit, index: int) -> tuple[Estimate, ...]:
    """Parameters of one effect of the fit with standard deviations, its position among them where it was fitted."""
    effect, stds = result.hypothesis.effects[index], result.std()
    entries: dict[str, list[float]] = {}
    rows: list[Estimate] = []
    names = [name for name, _ in effect.fitted_parameters()]
    for unknown, std in zip(result.unknowns, stds, strict=True):
        if isinstance(unknown, EffectUnknown) and unknown.effect == index:
            value = float(effect.fitted_values()[unknown.entry])
            size = (
                abs(value) * (exp(min(float(std) * unknown.about.spread, LARGEST_LOG_STD)) - 1.0)
                if unknown.about.scale == "log"
                else unknown.unit * std
            )
            widest = _anywhere(value, unknown.about.lower, unknown.about.upper)
            entries.setdefault(names[unknown.entry], []).append(min(hypot(size, KNOWN_TO * value), widest))
        elif isinstance(unknown, PlaceUnknown) and unknown.effect == index:
            where, size = effect.place.position or 0.0, hypot(std * unknown.unit, PLACE_KNOWN_TO * unknown.length)
            rows.append(Estimate("position", where, min(size, _anywhere(where, 0.0, unknown.length)), "m"))
    for name, about in effect.parameters().items():
        value = getattr(effect, name)
        sizes = entries.get(name, [0.0] * (len(value) if isinstance(value, tuple) else 1))
        std_out = tuple(sizes) if isinstance(value, tuple) else sizes[0]
        rows.append(Estimate(name, value, std_out, about.unit))
    return tuple(rows)


def _anywhere(value: float, lower: float, upper: float) -> float:
    """Rms distance from a value of what may lie anywhere between two ends: no number is known less than that."""
    return sqrt((upper - lower) ** 2 / 12.0 + (value - 0.5 * (lower + upper)) ** 2) if isfinite(upper - lower) else inf


@dataclass(frozen=True)
class Tried:
    """Probability that the truth is among what was judged, in the first round and in each later one."""

    first: float
    later: float


def tried(score: Score, *, holds: bool = True) -> Tried:
    """How likely the truth is among what was judged, by what the model that stands leaves.

    Args:
        score: of that model, on the records that it was fitted to.
        holds: whether it explains those that were kept aside, with the numbers learnt or with others.
    """
    reached = score.nrmse <= NOISE_REACHED * score.noise_nrmse
    first = UNTRIED if reached else UNTRIED_BEYOND
    later = UNTRIED_LATER if reached else UNTRIED_LATER_BEYOND
    missed = 0.0 if holds else UNTRIED_MISSED
    return Tried(1.0 - max(first, missed), 1.0 - max(later, missed))


def added_effects(result: Fit, rounds: Sequence[Sequence[Ranked]], among: Tried) -> tuple[AddedEffect, ...]:
    """The effects of the fit, each with its probability in the round that added it.

    Args:
        result: the last fit.
        rounds: what was judged, by effect.
        among: how likely the truth is among it.
    """
    rows: list[AddedEffect] = []
    for index, effect in enumerate(result.hypothesis.effects):
        ranked = rounds[index]
        is_later = ranked[0].fit is not rounds[0][0].fit  # parts of one effect have the round of that
        chances = probabilities([r.log_evidence for r in ranked])
        numbers = effect_estimates(result, index)
        if any(number.name == "position" for number in numbers):
            numbers = across_its_valley(numbers, effect, undecided(ranked, chances), result.hypothesis.rig)
        rows.append(AddedEffect(effect, chances[0] * (among.later if is_later else among.first), numbers))
    return tuple(rows)


def across_its_valley(
    numbers: Sequence[Estimate], effect: Effect, rivals: Sequence[tuple[Ranked, float]], rig: Rig
) -> tuple[Estimate, ...]:
    """The numbers of an effect, known no better than rivals of its kind lie apart that end beside it on the beam.

    A valley so flat that fits from several starts stop at several places of it has no bottom whose curvature would tell
    how far it reaches. The variance is that of the mixture: of each fit about the number told, by its probability.

    Args:
        numbers: of the effect, its position among them.
        effect: as it stands.
        rivals: rows of its round that the records do not exclude, the row that it comes from first, with their
            probabilities.
        rig: whose length says how far a valley reaches.
    """
    near = [(row, chance) for row, chance in rivals[1:] if row.refitted and in_one_valley(row.effect, effect, rig)]
    if not near:
        return tuple(numbers)
    whole = rivals[0][1] + sum(chance for _, chance in near)
    return tuple(_spread(number, [(row.effect, chance / whole) for row, chance in near]) for number in numbers)


def in_one_valley(one: Effect, other: Effect, rig: Rig) -> bool:
    """Whether two effects are one whose place along the beam a fit may move from here to there.

    Args:
        one: effect.
        other: the other one.
        rig: whose length says how far a valley reaches.
    """
    here, there = one.place.position, other.place.position
    if here is None or there is None or not (free_place(one) or free_place(other)):
        return False
    return one.kind == other.kind and one.has_options_of(other) and abs(here - there) < valley(rig)


def _spread(number: Estimate, rivals: Sequence[tuple[Effect, float]]) -> Estimate:
    """A number with the deviation that holds where rivals of its effect have it, by their shares."""
    value, variance = np.array(number.value), np.array(number.std) ** 2
    for effect, share in rivals:
        there = np.array(effect.place.position if number.name == "position" else getattr(effect, number.name))
        if there.shape == value.shape:  # a table in more detail has no such number
            variance = variance + share * (there - value) ** 2
    std = np.sqrt(variance)
    return replace(number, std=tuple(std.tolist()) if std.ndim else float(std))


def candidates_of(
    ranked: Sequence[Ranked], chances: Sequence[float], evaluator: Evaluator, among: float, without: Hypothesis
) -> tuple[Candidate, ...]:
    """What was judged in a round, with its error on the records of the refits.

    What was not refitted would leave no more chi-square, refitted, than the model as it was left, nor than that without
    it; the less of their errors is told.

    Args:
        ranked: of the round.
        chances: shares of the evidence.
        evaluator: the records of the refits.
        among: probability that the truth is among it (``Tried.first``).
        without: the model that the round's effects were tried beside.
    """
    screened = [row.fit.hypothesis for row in ranked if not row.refitted]
    bare, *rest = evaluator.residuals([(model, None) for model in (without, *screened)])
    bounds = iter([min(evaluator.nrmse_of(each) for each in (bare, row) if each is not None) for row in rest])
    return tuple(
        Candidate(
            r.effect,
            among * chance,
            evaluator.nrmse_of(r.fit.residual) if r.refitted else next(bounds),
            r.log_evidence - ranked[0].log_evidence,
            r.refitted,
        )
        for r, chance in zip(ranked, chances, strict=False)
    )


def distinct(ranked: Sequence[Ranked]) -> list[Ranked]:
    """The rows of a round without those of a kind at a place where a better one of that kind is: they are one finding.

    Args:
        ranked: of the round, the best first.
    """
    kept: list[Ranked] = []
    for row in ranked:
        if not any(_is_one(row.effect, other.effect, row.fit.hypothesis.rig) for other in kept):
            kept.append(row)
    return kept


def _is_one(one: Effect, other: Effect, rig: Rig) -> bool:
    """Whether a table of effects names both alike, but for a place that no fit tells from the other."""
    return one.kind == other.kind and one.has_options_of(other) and is_same_place(one.place, other.place, rig)


def groups_of(ranked: Sequence[Ranked], chances: Sequence[float]) -> tuple[tuple[Effect, ...], ...]:
    """Effects of a round that the records cannot tell from the best, places that its fit leaves open among them.

    Args:
        ranked: of the round.
        chances: probabilities of its rows.
    """
    group = tuple(row.effect for row, _ in undecided(ranked, chances))
    return (group,) if len(group) > 1 else ()


def members_of(ranked: Sequence[Ranked]) -> list[Ranked]:
    """The rows of a round that its records do not exclude, by its own evidence.

    Args:
        ranked: of the round, the best first.
    """
    return [row for row, _ in undecided(ranked, probabilities([row.log_evidence for row in ranked]))]


def undecided(ranked: Sequence[Ranked], chances: Sequence[float]) -> tuple[tuple[Ranked, float], ...]:
    """The rows of a round that its records do not exclude, each with a probability of ``TELLABLE`` at least.

    What was known beforehand may speak for one of two that predict the same; the records exclude neither.

    Args:
        ranked: of the round.
        chances: probabilities of its rows.
    """
    if not ranked:
        return ()
    near = ranked[0].fit.chi2 + EXCLUDED_BY * misfit_in_common(ranked)
    pairs = zip(ranked, chances, strict=False)
    return tuple((r, max(p, TELLABLE)) for r, p in pairs if p > TELLABLE or (r.refitted and r.fit.chi2 < near))
