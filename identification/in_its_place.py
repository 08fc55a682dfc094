"""What else may stand where the best effect has come to: simpler laws, a sleeve's own, the same at a sleeve.

Whatever explains the records nearly has the rig's numbers nearly right, so others are begun beside those numbers, and
followed only where they come near.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from identification.calibrate import WINDOWS, Windows, beginning, calibrate, concerning
from identification.evaluate import Evaluator
from identification.evidence import (
    LEAST_EVIDENCE,
    Ranked,
    log_fit,
    misfit_in_common,
    misfit_of,
    reweighed,
    with_evidence,
)
from identification.far_numbers import said_of_far_numbers
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, PlaceUnknown, free_place, own_unknowns
from identification.in_step import in_step, tried_with
from identification.pieces import fit_from_own_starts
from identification.progress import Progress, silent
from identification.scene import is_same_place, sleeves_of, valley
from identification.screen import Suspect, promising, survey
from identification.sketch import TOLERANCE, is_alike
from models.effects import Effect, Place, Registry
from models.rig import Beam

REFIT_WINDOWS: Windows = ((0.35, 2.0),)
"""The sketch has seen the beginning."""

EXPLAINED = 1.25
"""Residual over noise at which suspects are not looked for in another way."""

RULED_OUT = 1.3
"""What is so many times as far off as one that has reached the noise is not fitted further."""


def judged_beside(
    leader: Fit, fitting: Evaluator, base: Fit, known: Iterable[Effect], registry: Registry, progress: Progress
) -> list[Ranked]:
    """A fit's last effect and others in its place that come near it beside the same other effects, by evidence.

    Args:
        leader: with all effects, the one in question last.
        fitting: records of the fit.
        base: the same without that effect.
        known: rivals with the numbers they begin from.
        registry: kinds that are tried where the effect sits, too.
        progress: told what is being done.
    """
    row = Ranked.of(leader)
    rivals = {effect.kind: effect for effect in (*_seen_there(leader, fitting, base, registry), *known)}
    rows = with_evidence([row, *begun_at_leader(fitting, base, [row], rivals.values())])
    return settled_apart(fitting, _with_sleeves(fitting, base, rows), progress)


def _seen_there(leader: Fit, fitting: Evaluator, base: Fit, registry: Registry) -> list[Effect]:
    """The best of each kind where the last effect sits, if that has a place along the beam or is on an oscillator."""
    place, bare = leader.hypothesis.effects[-1].place, without_last(leader.hypothesis)
    if isinstance(bare.rig.structure, Beam):
        if place.position is None:
            return []
        return [s.effect for s in seen_at(place.position, fitting, base, bare, registry)[:MOST_SEEN]]
    return [s.effect for s in seen_at(None, fitting, base, bare, registry) if s.effect.place == place][:MOST_SEEN]


MOST_SEEN = 6
"""Kinds tried in an effect's place because they show there."""


@dataclass(frozen=True, eq=False)
class Leader:
    """A fit that others are held against on the beginning of its records.

    Attributes:
        fit: of the records.
        fitting: they themselves.
    """

    fit: Fit
    fitting: Evaluator

    @cached_property
    def there(self) -> Fit:
        """Its model on the beginning, with the slopes there."""
        return fit(self.window, self.fit.hypothesis, self.fit.unknowns, max_iterations=0)

    @cached_property
    def window(self) -> Evaluator:
        """The beginning."""
        return self.fitting if self.fitting.at_rest else beginning(self.fitting, *REFIT_WINDOWS[0])


def against(leader: Leader, base: Fit, found: Hypothesis) -> tuple[Fit | None, float]:
    """A model fitted on the beginning, and how many times as far off as the leader it is there.

    It is fitted with the leader's slopes: whatever comes as near to the records has nearly the same.
    """
    unknowns = (*base.unknowns, *own_unknowns(found))
    slopes = leader.there.jacobian[: len(base.unknowns)]
    try:
        first = fit(
            leader.window,
            found,
            unknowns,
            max_iterations=ITERATIONS_AGAINST,
            jacobian=slopes,
            keep=True,
            tolerance=TOLERANCE,
        )
    except ArithmeticError:
        return None, inf
    return first, first.ratio / leader.there.ratio


ITERATIONS_AGAINST = 8
"""Of a model that has to come near the noise, which another has reached, to be fitted further."""


def with_others_there(
    fitting: Evaluator, base: Fit, ranked: Sequence[Ranked], registry: Registry, progress: Progress
) -> list[Ranked]:
    """The rows, and what else explains as much where the first of them has come to, by evidence.

    Args:
        fitting: records of the fits.
        base: the model without an effect more.
        ranked: sorted, all refitted.
        registry: kinds to try there.
        progress: told what is being done.
    """
    rows = with_evidence([*ranked, *_simpler_rows(fitting, base, ranked, registry)])
    far = said_of_far_numbers(rows[0].fit, registry) if rows else ()
    said = [row for start in far for row in begun_at_leader(fitting, base, rows, *start)]
    rows = with_evidence([*rows, *said])
    rows = with_evidence([*rows, *_of_the_sleeve(fitting, base, rows, registry)])
    return settled_apart(fitting, _with_sleeves(fitting, base, rows), progress)


def _simpler_rows(fitting: Evaluator, base: Fit, ranked: Sequence[Ranked], registry: Registry) -> list[Ranked]:
    """Laws with fewer numbers than the first, tried where it sits, from the numbers of the rig that it has come to.

    Where its place is fitted, so are those that have none: a place is a number more.

    A law with more numbers has more ways down, and may reach what is there at an end of itself (an absorber so stiff
    that it is a mass, hysteresis that yields at once, which is friction), while the plain law itself was stopped on its
    way.
    """
    if not ranked:
        return []
    leader = ranked[0].effect
    sort, most = "position" if leader.place.sleeve is None else "sleeve", _n_numbers(leader)
    fewer = {name: kind for name, kind in registry.items() if sort in kind.places and has_fewer(kind, most)}
    seen = _seen_there(ranked[0].fit, fitting, base, fewer) if fewer else []
    there = [replace(effect, place=leader.place) for effect in seen]
    return begun_at_leader(fitting, base, ranked, [*there, *_of_the_whole_beam(fitting, base, ranked[0], registry)])


def has_fewer(kind: type[Effect], numbers: int) -> bool:
    """Whether a kind that acts by itself has fewer numbers for a fit.

    Args:
        kind: of law.
        numbers: of another.
    """
    alone = kind.part_kind() == kind.kind
    return alone and sum(about.fitted for about in kind.parameters().values()) < numbers


def _n_numbers(effect: Effect) -> int:
    """Numbers of an effect for a fit; a law in time has as many as its table."""
    return len(effect.fitted_values()) if effect.family == "time" else effect.n_numbers


def _of_the_whole_beam(fitting: Evaluator, base: Fit, first: Ranked, registry: Registry) -> list[Effect]:
    """The best of the kinds that change the whole beam and have fewer numbers than the first with its place."""
    if not free_place(first.effect):
        return []
    whole = {name: kind for name, kind in registry.items() if kind.family == "structure" and not kind.places}
    most = _n_numbers(first.effect) + 1  # with its place
    fewer = {name: kind for name, kind in whole.items() if has_fewer(kind, most)}
    seen = seen_at(None, fitting, base, without_last(first.fit.hypothesis), fewer) if fewer else []
    return [suspect.effect for suspect in seen[:MOST_SEEN]]


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
    assert sleeve.position is not None
    seen = seen_at(sleeve.position, fitting, base, without_last(leader), kinds)
    return begun_at_leader(fitting, base, ranked, (s.effect for s in seen if s.effect.place == sleeve))


def seen_at(
    position: float | None, fitting: Evaluator, base: Fit, bare: Hypothesis, registry: Registry, per_kind: int = 1
) -> Sequence[Suspect]:
    """The best of each kind at a place, or anywhere, seen from the numbers that a model has without an effect of its.

    Args:
        position: along the beam, m; None for anywhere.
        fitting: records, of which the beginning is looked at.
        base: the model without that effect, for its unknowns.
        bare: the model itself, without the effect.
        registry: kinds to try.
        per_kind: places of each kind, in different valleys.
    """
    window = fitting if fitting.at_rest else beginning(fitting, *REFIT_WINDOWS[0])
    try:
        ground = fit(window, bare, concerning(base, window), max_iterations=0)
    except ArithmeticError:
        return []
    return promising(survey(window, ground, registry, silent, position), per_kind, valley(bare.rig))


def without_last(hypothesis: Hypothesis, n_effects: int = 1) -> Hypothesis:
    """The model without its last effects, all its numbers as they are.

    Args:
        hypothesis: the model.
        n_effects: how many are taken out.
    """
    return replace(hypothesis, effects=hypothesis.effects[:-n_effects])


def begun_at_leader(
    fitting: Evaluator,
    base: Fit,
    ranked: Sequence[Ranked],
    effects: Iterable[Effect],
    values: Mapping[str, float] | None = None,
) -> list[Ranked]:
    """Effects begun beside the first one's numbers of the rig, or others, refitted where they come near what it leaves.

    A kind of which a row explains as much as the first is left out; one that is merely near may have been stopped in a
    valley beside its own, or at another place.
    """
    leader, rows = Leader(ranked[0].fit, fitting), []
    bare, scale = without_last(leader.fit.hypothesis), misfit_of(leader.fit)
    as_good = [row.effect for row in ranked if log_fit(leader.fit, scale) - log_fit(row.fit, scale) < LEAST_EVIDENCE]
    for effect in effects:
        if any(other.kind == effect.kind and _may_be_one(other.place, effect.place) for other in as_good):
            continue
        start = tried_with(fitting, replace(bare, values=values or bare.values), effect)
        first, farther = against(leader, base, _sized(fitting, start))
        if first is None or farther > RULED_OUT:
            continue
        begun = replace(bare, values=first.hypothesis.values).with_effects(first.hypothesis.effects[-1])
        result = refit(fitting, base, begun)
        if result is not None:
            rows.append(Ranked.of(result))
    return rows


def _may_be_one(one: Place, other: Place) -> bool:
    """Whether two places are not two sleeves."""
    return None in (one.sleeve, other.sleeve) or one.sleeve == other.sleeve


def _sized(fitting: Evaluator, found: Hypothesis) -> Hypothesis:
    """The model with its last effect's own numbers, but for its place, where they fit ever longer beginnings best.

    All others are right already, or nearly so: moved together with a size that is not yet, they go astray, and where
    neighbouring motions part they do not come back. What acts in time is known from more than a beginning.
    """
    own = [unknown for unknown in own_unknowns(found) if not isinstance(unknown, PlaceUnknown)]
    if not own or found.effects[-1].family == "time":
        return found
    for window in [fitting] if fitting.at_rest else [beginning(fitting, *each) for each in WINDOWS]:
        try:
            found = fit(window, found, own, max_iterations=ITERATIONS_AGAINST, tolerance=1e-2).hypothesis
        except ArithmeticError:
            break
    return found


def _with_sleeves(fitting: Evaluator, base: Fit, ranked: Sequence[Ranked]) -> list[Ranked]:
    """The rows, and the best of them again at a sleeve to which their free place has come, where they have no place.

    A row with a free place is left out where the same law at the sleeve says as much without it: they are one.
    """
    fixed = [row for found in ranked for row in _at_its_sleeve(fitting, base, found, ranked[0])]
    rows: list[Ranked] = []
    for row in with_evidence([*ranked, *fixed]):
        if not (free_place(row.effect) and any(_is_one(row, better) for better in rows)):
            rows.append(row)
    return rows


def _at_its_sleeve(fitting: Evaluator, base: Fit, found: Ranked, best: Ranked) -> Iterator[Ranked]:
    if found.log_evidence < best.log_evidence - FOR_A_PLACE or not free_place(found.effect):
        return
    rig = found.fit.hypothesis.rig
    for place in sleeves_of(rig) if "sleeve" in found.effect.places else ():
        if is_same_place(place, found.effect.place, rig):
            there = without_last(found.fit.hypothesis).with_effects(replace(found.effect, place=place))
            result = refit(fitting, base, there)
            if result is not None:
                yield Ranked.of(result)


def _is_one(row: Ranked, better: Ranked) -> bool:
    """Whether a better row is the same law at the sleeve where this one's free place has come to."""
    one, other = row.effect, better.effect
    at_sleeve = other.place.sleeve is not None and is_same_place(one.place, other.place, row.fit.hypothesis.rig)
    return at_sleeve and one.kind == other.kind and not one.is_variant_of(other)


FOR_A_PLACE = 15.0
"""Evidence that a place to fit costs at most."""


def settled_apart(fitting: Evaluator, ranked: list[Ranked], progress: Progress) -> list[Ranked]:
    """The ranking with those fitted to the end that the refits' tolerance cannot tell from the first.

    Of those that came to the same numbers at the same place one is left. Above the noise there is nothing to tell apart
    among those of one kind in one valley.
    """
    within = 0.5 * REFIT_TOLERANCE * ranked[0].fit.cost / misfit_in_common(ranked) if ranked else 0.0
    ranked = _but_once(ranked)
    close = [row for row in ranked if row.refitted and row.log_evidence > ranked[0].log_evidence - within]
    close = _but_once(close, _are_one) if close and ranked[0].fit.ratio > EXPLAINED else close
    if not close[1:]:
        return ranked
    progress(f"{' and '.join(row.effect.label() for row in close)} fit nearly alike; fitting them to the end")
    found = [row.fit for row in close]
    fits = [fit(fitting, one.hypothesis, one.unknowns, tolerance=0.0, precise=True, like=one) for one in found]
    rows = [replace(row, fit=f, effect=f.hypothesis.effects[-1]) for row, f in zip(close, fits, strict=True)]
    return _but_once(reweighed(ranked, [*rows, *(row for row in ranked if row.refitted and row not in close)]))


def _are_one(row: Ranked, better: Ranked) -> bool:
    """Whether two fits are of one kind in one valley, both in a sleeve or neither."""
    in_one_sleeve = row.effect.place.sleeve == better.effect.place.sleeve
    return row.refitted and better.refitted and in_one_sleeve and is_alike(row.fit, better.fit)


def _have_met(row: Ranked, better: Ranked) -> bool:
    """Whether two fits of one kind have come to one point of one valley."""
    if not _are_one(row, better):
        return False
    here, there = row.effect.fitted_values(), better.effect.fitted_values()
    return len(here) == len(there) and bool(np.allclose(here, there, rtol=MET, atol=0.0))


MET = 0.01
"""Relative difference of all numbers of two fits that have come to one point."""


def _but_once(ranked: Sequence[Ranked], are_one: Callable[[Ranked, Ranked], bool] = _have_met) -> list[Ranked]:
    """The rows, the best first, without those that are one with a better one that stays."""
    kept: list[Ranked] = []
    for row in ranked:
        kept += [] if any(are_one(row, better) for better in kept) else [row]
    return kept


def refit(evaluator: Evaluator, base: Fit, begun: Hypothesis) -> Fit | None:
    """Everything refitted with one more effect; None where the model with it diverges.

    Args:
        evaluator: records to fit.
        base: the model without the effect, for its unknowns.
        begun: where the fit begins, the effect last; its own phases are sought.
    """
    hypothesis = in_step(evaluator, begun, begun.effects[-1:])
    try:
        unknowns = (*base.unknowns, *own_unknowns(hypothesis))
        found = calibrate(evaluator, hypothesis, unknowns, REFIT_WINDOWS, tolerance=REFIT_TOLERANCE)
        return fit_from_own_starts(evaluator, found)
    except ArithmeticError:
        return None


def refit_sketched(evaluator: Evaluator, base: Fit, sketched: Hypothesis) -> Fit | None:
    """Everything refitted from the numbers and the last effect of a model that was fitted to a beginning.

    Args:
        evaluator: records to fit.
        base: the model without the effect, whose other effects a beginning may not tell.
        sketched: the model on the beginning.
    """
    effects = (*base.hypothesis.effects, sketched.effects[-1])
    begun = replace(base.hypothesis, values=sketched.values, motions=sketched.motions, effects=effects)
    return refit(evaluator, base, begun)


REFIT_TOLERANCE = 2e-3
"""Relative decrease of the cost that ends a refit; the one that wins is polished."""
