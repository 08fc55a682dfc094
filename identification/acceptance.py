"""What is added, what is taken out again, and what the end is called."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from identification.detail import in_more_detail
from identification.established import NO_LAW_OF_ALL, NO_SIZE, of_one_law, unestablished
from identification.evidence import (
    LEAST_EVIDENCE,
    Ranked,
    log_fit,
    log_standing,
    misfit_in_common,
    misfit_of,
)
from identification.fit import LOOK, LOOK_TOLERANCE, Fit, fit
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.kept_aside import KeptAside
from identification.noise_left import NOISE_NEAR
from identification.outcome import AT_REST_ONLY, members_of
from identification.pieces import fit_from_own_starts
from identification.reached import (
    ERROR_REACHED,
    EXPLAINED_FAR,
    EXPLAINED_NEAR,
    LEAST_SHARE,
    NEARLY_ALL,
    NOISE_DOUBTED,
    NOISE_REACHED,
    is_as_near_as_models,
    is_faint,
    is_silenced,
    missed,
    reaches_noise,
    takes_away,
)
from identification.result import Verdict
from identification.scatter import is_needed_throughout
from identification.session import Session
from identification.tangent_ties import is_linear
from identification.unseen import Unseen, left_unseen

LATER_SHARE = 0.6
"""The same for further effects, unless they reach the noise: what is left may be a shape that no simple law has."""

FAR_FROM_NOISE, FAR_FROM_MOTION = 10.0, 0.1
"""Residual over noise, and error as a share of the motion, above both of which nothing is a diagnosis, however large
the misfit was before: where all sensors read in another unit, a force a tenth as large takes away 99 % of it."""

PREDICTS, LARGE_UNSEEN = 0.98, 2.0
"""Share of the residual not fitted that an effect may leave at most, and from which residual over noise on nothing is
predicted any more, neither with it nor without."""

DIFFERS = 0.3
"""Difference of two models over the noise from which on the one that is right leaves less: the other leaves
sqrt(1 + 0.3^2) = 1.04 times as much, twice what ``PREDICTS`` asks for."""


def is_enough(session: Session, result: Fit) -> bool:
    """The noise is reached; without an effect, with every number within its tolerance."""
    reached = reaches_noise(session.fitting, result)
    return reached and (bool(result.hypothesis.effects) or not session.left_tolerance(result))


def is_explained(session: Session, result: Fit) -> bool:
    """It is enough, and beside its effects so little more than the noise is left that no other is looked for."""
    return is_enough(session, result) and not (result.hypothesis.effects and is_faint(session.fitting, result))


def accepted(session: Session, base: Fit, ranked: Sequence[Ranked]) -> Fit | None:
    """The fit with the best effect, refined, if it explains enough."""
    if not ranked:
        session.decide("no effect of the library improves the model")
        return None
    best = ranked[0]
    odds = best.log_evidence - log_standing(base, misfit_in_common(ranked))
    share = takes_away(base, best.fit)
    name = best.effect.label()
    least = LATER_SHARE if base.hypothesis.effects and best.fit.ratio > NOISE_NEAR else LEAST_SHARE
    if base.hypothesis.effects and is_enough(session, base):
        least = NEARLY_ALL
    little = share < least and (bool(base.hypothesis.effects) or not reaches_noise(session.fitting, base))
    if odds < LEAST_EVIDENCE or little:
        why = f"takes away only {share:.0%} of the misfit" if little else "the records hardly speak for it"
        session.decide(f"{name} is the best of the library, but {why}: not added")
        return None
    if not session.holds(best.fit.hypothesis):
        session.decide(
            f"{name} explains what was fitted, but with it the motion leaves the finite numbers in the rest of the "
            "same records: not added"
        )
        return None
    unseen = passing(session, base, best)
    if unseen is not None:
        session.is_passing = not base.hypothesis.effects and unseen.before <= NOISE_DOUBTED
        session.decide(
            f"{name} takes the residual from {base.ratio:.2f} to {best.fit.ratio:.2f} times the noise where it was "
            f"fitted, but from {unseen.before:.2f} to {unseen.after:.2f} times in the rest of the same records: not "
            "added, since what is missing in a rig is there for as long as a test lasts"
        )
        return None
    session.decide(
        f"{name} added: residual from {base.ratio:.2f} to {best.fit.ratio:.2f} times the noise, "
        f"{min(share, 1.0):.0%} of the misfit beyond the noise; {best.effect.in_words()}"
    )
    tell_tangent(session, best)
    refined = in_more_detail(session.fitting, best.fit, session.decide)
    return refined if refined is best.fit or session.holds(refined.hypothesis) else best.fit


def finite_first(session: Session, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking without those first whose motion leaves the finite numbers beyond what was fitted.

    Left as it is where none that stays finite is about as probable.

    Args:
        session: told.
        ranked: sorted.
    """
    rivals = [row for row in ranked if row.refitted and ranked[0].log_evidence - row.log_evidence < LEAST_EVIDENCE]
    for row in rivals if len(rivals) > 1 else []:
        if session.holds(row.fit.hypothesis):
            return ranked[ranked.index(row) :]
        session.decide(f"{row.effect.label()}: the motion leaves the finite numbers in the rest of the same records")
    return ranked


def tell_tangent(session: Session, added: Ranked) -> None:
    """Say that a law was seen by its tangent alone, where that is so.

    Args:
        session: told.
        added: the effect.
    """
    if not session.everything.timed and not is_linear(added.fit.hypothesis):
        session.decide(f"{added.effect.label()} is seen by its tangent at rest alone: {AT_REST_ONLY}")


def passing(session: Session, base: Fit, best: Ranked) -> Unseen | None:
    """What an effect leaves beyond the part fitted, where it explains no more than an event there.

    Args:
        session: with the records.
        base: the model without the effect.
        best: the effect, fitted to that part.

    Returns:
        None where it takes something away there too, or where the rest of the records cannot tell.
    """
    unseen = left_unseen(session, base, best.fit)
    if unseen is None or unseen.before > LARGE_UNSEEN or unseen.between < DIFFERS:
        return None
    return None if unseen.after < PREDICTS * unseen.before else unseen


def pruned(session: Session, calibrated: Fit, found: Fit, *, newest: int) -> list[tuple[int, Fit]]:
    """Effects that a new one has made needless, each with the fit without it, taken out one after the other.

    Needless is what none would be added for: the noise is reached without it, or it explains nothing.

    Args:
        session: told.
        calibrated: the model without effects.
        found: the fit.
        newest: index of the new effect, which is not asked.
    """
    taken: list[tuple[int, Fit]] = []
    new = found.hypothesis.effects[newest].label()
    index = 0
    while index < len(found.hypothesis.effects):
        less = None if index == newest else _needless(session, calibrated, found, index)
        if less is not None:
            gone = found.hypothesis.effects[index].label()
            why = "the noise is reached without it" if is_enough(session, less) else "it explains nothing more"
            session.decide(f"{gone} taken out again: beside {new} {why}")
            taken.append((index, less))
            found, newest = less, newest - (index < newest)
        else:
            index += 1
    return taken


def _needless(session: Session, calibrated: Fit, found: Fit, index: int) -> Fit | None:
    """The fit without an effect where that explains as much, or None."""
    look = look_without(session, calibrated, found, index)
    if look is None or look.ratio > worth_fitting(found):
        return None
    less = fit_without(session, calibrated, found, index)
    return less if less is not None and explains_as_much(session, less, found) else None


def explains_as_much(session: Session, less: Fit, found: Fit) -> bool:
    """Whether a model comes as near to the noise as another with an effect more, or reaches it and the other no better.

    Args:
        session: with the records.
        less: the fit of the model with fewer effects.
        found: of the one with more.
    """
    enough = is_explained(session, less) or (is_enough(session, less) and takes_away(less, found) < NEARLY_ALL)
    return enough or comes_as_near(less, found)


def comes_as_near(less: Fit, found: Fit) -> bool:
    """Whether what a model with more effects does beyond another hardly speaks for it.

    Args:
        less: the fit of the model with fewer effects.
        found: of the one with more.
    """
    scale = misfit_of(found)
    return log_fit(found, scale) - log_fit(less, scale) < LEAST_EVIDENCE


def worth_fitting(found: Fit) -> float:
    """Residual over noise above which a model with an effect less is not fitted to its end.

    Begun at the numbers of the other one, an effect that is needless leaves no more than that after a few steps.

    Args:
        found: the model with all effects.
    """
    return WORTH_FITTING * max(1.0, found.ratio)


WORTH_FITTING = 3.0
"""Times what the model with all effects leaves, or the noise."""


def look_without(session: Session, calibrated: Fit, found: Fit, index: int) -> Fit | None:
    """The first steps of the fit without one of its effects, or None where the model needs it to stay finite.

    Args:
        session: with the records.
        calibrated: the model without effects.
        found: the fit.
        index: of the effect.
    """
    return _best_without(session, calibrated, found, index, max_iterations=LOOK, tolerance=LOOK_TOLERANCE)


def fit_without(session: Session, calibrated: Fit, found: Fit, index: int) -> Fit | None:
    """The fit again without one of its effects, or None where the model needs it to stay finite.

    Args:
        session: with the records.
        calibrated: the model without effects.
        found: the fit.
        index: of the effect.
    """
    return _best_without(session, calibrated, found, index, precise=True)


def _best_without(session: Session, calibrated: Fit, found: Fit, index: int, **how: Any) -> Fit | None:
    less, handed = found.hypothesis.without_effect(index), found.hypothesis.handed_back(index)
    fits = []
    for start in [less] if handed.values == less.values else [handed, less]:
        try:
            unknowns = (*calibrated.unknowns, *effect_unknowns(start))
            fits.append(fit_from_own_starts(session.fitting, fit(session.fitting, start, unknowns, **how)))
        except ArithmeticError:
            continue
    return min(fits, key=lambda each: each.cost, default=None)


def in_doubt(
    session: Session, calibrated: Fit, final: Fit, last: Fit, predicts: Callable[[Hypothesis], bool] = lambda _: False
) -> tuple[int, str] | None:
    """Number of the first effect that is not established, and why; what no part of the data can do without is kept.

    Args:
        session: with the records, told.
        calibrated: the model without effects.
        final: the model that stands, fitted to a part of the records.
        last: the same on all of them, with honest intervals.
        predicts: whether a model predicts records that were kept aside.
    """
    needed, predicted = set[int](), False
    while True:
        doubted = unestablished(last, in_motion=bool(session.everything.timed), needed=needed, predicted=predicted)
        if doubted is None:
            return None
        index, why = doubted
        if why == NO_LAW_OF_ALL and predicts(last.hypothesis):
            session.decide(
                f"{final.hypothesis.effects[index].label()}: modes, channels and records do not agree about its "
                "numbers, but with them what was kept aside is predicted to its noise: kept"
            )
            predicted = True
            continue
        if why != NO_SIZE:
            return doubted
        less = fit_without(session, calibrated, final, index)
        if less is not None and not is_needed_throughout(session.fitting, less, final):
            return doubted
        session.decide(
            f"{final.hypothesis.effects[index].label()}: its size moves far as one mode, channel or record is left "
            "out, but whichever that is, the others need it: kept"
        )
        needed.add(index)


def is_of_one_law(session: Session, last: Fit) -> bool:
    """Whether two effects of a model may stand for one law which the library does not hold; told.

    Args:
        session: with the records, told.
        last: the model that stands, fitted to all records, with honest intervals.
    """
    pair = of_one_law(last, in_motion=bool(session.everything.timed))
    if pair is None:
        return False
    names = " and ".join(last.hypothesis.effects[index].label() for index in pair)
    session.decide(
        f"unexplained after all: {names} act at one place, as far as the records tell: together they may stand for one "
        "law that the library does not hold"
    )
    return True


def verdict_of(
    session: Session, calibrated: Fit, final: Fit, *, taken_out: bool = False, looked: bool = True
) -> Verdict:
    """What the end is called, decided and told; where a law beyond the library was found, that is told already.

    Args:
        session: told.
        calibrated: the model without effects.
        final: with all that were added.
        taken_out: whether an effect that explained something was taken out again, because its numbers are not told.
        looked: whether any effect was asked for.
    """
    if session.is_beyond:
        return "unexplained"
    has_effects = bool(final.hypothesis.effects)
    share = takes_away(calibrated, final) if has_effects else 0.0
    enough = EXPLAINED_NEAR if final.ratio <= NOISE_NEAR else EXPLAINED_FAR
    far = final.ratio > FAR_FROM_NOISE and session.fitting.nrmse_of(final.residual) > FAR_FROM_MOTION
    silenced = has_effects and is_silenced(session.fitting, final)
    if has_effects and not silenced and (final.ratio <= NOISE_REACHED or (share >= enough and not far)):
        session.decide(
            f"missing effect found; residual {final.ratio:.2f} times the noise{_over_samples(session, final)}"
        )
        return "missing_effect"
    complete = None
    if not has_effects:
        complete = _complete(session, calibrated)
    if complete is None and share < IMITATED and not taken_out:
        complete = _models_own(session, calibrated)
    if complete is not None:
        session.decide(f"complete: {complete}")
        return "complete"
    if silenced:
        why = (
            f"with {' and '.join(effect.label() for effect in final.hypothesis.effects)} the model says that next to "
            f"nothing moves, and {session.fitting.nrmse_of(final.residual):.0%} of the motion is left: the channels do "
            "not follow the excitation; see that the record is of this rig, and that its excitation is what drove it"
        )
    elif has_effects:
        short = (
            f"more than {FAR_FROM_MOTION:.0%} of the motion is left" if far else f"{enough:.0%} would be a diagnosis"
        )
        why = (
            f"the best of the library leaves {final.ratio:.2f} times the noise and takes away {share:.1%} of the "
            f"misfit beyond it; {short}"
        )
    elif taken_out:
        why = "what would explain it is not established"
    elif looked:
        why = "nothing in the library explains what is left"
    else:
        why = f"the calibrated model leaves {final.ratio:.2f} times the noise, and no effect was asked for"
    session.decide(f"unexplained: {why}")
    return "unexplained"


def refuted(
    session: Session, calibrated: Fit, final: Fit, last: Fit, kept: KeptAside, rounds: Sequence[Sequence[Ranked]]
) -> bool:
    """Whether a model that comes near the noise or reaches it is no diagnosis by what was kept aside.

    One that reaches the noise where it was fitted is refuted if no numbers of it explain the records kept aside as
    well, and nothing else in its place is left in question. One that only comes near is by predicting them badly. Far
    from the noise, as on real structures, all models miss, and the best predicts badly too. So may the right one where
    next to nothing is left of a large misfit: what two ways to compute the same rig differ by is above the noise of a
    quiet sensor.

    Args:
        session: told.
        calibrated: the model without effects.
        final: the model that stands.
        last: the same fitted to all records.
        kept: what it is worth on records kept aside, with other numbers too (``other_numbers``).
        rounds: effects ranked in each round, those of the model first.
    """
    if kept.holds or last.ratio > NOISE_NEAR:
        return False
    nearest = f"{' and '.join(effect.label() for effect in last.hypothesis.effects)} comes nearest"
    names = " and ".join(kept.missed)
    if last.ratio > NOISE_REACHED:
        if takes_away(calibrated, final) >= BEYOND_DOUBT:
            return False
        why = f"but leaves {last.ratio:.2f} times the noise where fitted, and what was learnt does not hold on {names}"
    elif kept.explained is not False:
        return False
    elif any(len(members_of(ranked)) > 1 for ranked in rounds[: len(last.hypothesis.effects)]):
        session.decide(f"another in its place may explain {names}: what cannot be told from it stays in question")
        return False
    else:
        why = f"but no numbers of it were found that explain {names} as well as what was learnt from"
    session.decide(f"unexplained after all: {nearest}, {why}")
    return True


def is_incomplete(session: Session, kept: KeptAside) -> bool:
    """Whether records kept aside show that something is missing in a model that meets what it was fitted to; told.

    Args:
        session: told.
        kept: what the calibrated model is worth there, with other numbers too (``other_numbers``).
    """
    if kept.explained is not False:
        return False
    names = " and ".join(kept.missed)
    session.decide(
        f"unexplained after all: no numbers of the calibrated model were found that explain {names} as well as what "
        "was learnt from; what is missing shows there, so learn from it, too"
    )
    return True


BEYOND_DOUBT = 0.99
"""Share of the squared misfit beyond the noise that is taken away, from which a record kept aside does not refute: a
late sensor took 99.9 % of one of another maker's model; friction of another law, taken for ours, 98.3 %."""


def _over_samples(session: Session, final: Fit) -> str:
    """What is left of all samples, where that is not what is left of all lines; empty where they agree."""
    times = session.fitting.nrmse_of(final.residual) / max(session.fitting.nrmse_of_noise, np.finfo(float).tiny)
    if times <= ERROR_REACHED * max(1.0, final.ratio):
        return ""
    return f" line by line, and {times:.1f} times in the error, to which the loudest lines add most"


IMITATED = 0.5
"""Share of the misfit from which on what an effect takes away may be one, even if the model itself errs by as much."""


def _complete(session: Session, calibrated: Fit) -> str | None:
    """Why nothing is missing in the calibrated model, or None."""
    if calibrated.ratio <= NOISE_DOUBTED:
        but = "" if session.everything.timed else " for small motion about rest"
    elif session.is_passing:
        but = " but for an event that passes"
    else:
        return None
    if session.left_tolerance(calibrated):
        return None
    session.to_the_end(calibrated)  # which foresees how far
    return f"the calibrated model reaches the noise{but}{session.not_followed}"


def _models_own(session: Session, calibrated: Fit) -> str | None:
    """That what is left, fitted or not, may be the error of the model's own computation; or None."""
    if session.left_tolerance(calibrated) or not is_as_near_as_models(session.fitting, calibrated):
        return None
    ended = session.to_the_end(calibrated)
    whole = session.all_predicted  # as that fit foresees it
    if not is_as_near_as_models(whole, ended):
        return None
    return (
        f"beyond the noise the calibrated model misses {missed(whole, ended):.2%} of the motion, no more than two ways "
        f"to compute the same rig differ by, and nothing in the library explains it{session.not_followed}"
    )
