"""Whether a law more general than any of the library explains the records better in a found effect's place.

The best kind of the library is found wherever the library holds none that is right, and may come near the noise: a
spring whose force relaxes is nearly a hysteresis, or an absorber of an odd mass. So an effect that acts at a place is
held against laws that hold many others within them, at the same place, with all other numbers free: a force over speed,
over displacement, with a memory (``models.general_laws``). Where one of them wins as clearly as an effect has to, the
law is none of the library's. First a linear step tells whether any of them could.

Source: the score test, C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50; encompassing, G. E. Mizon, J.-F. Richard,
Econometrica 54 (1986) 657: a model that stands explains what its rivals find in the same data.
"""

from dataclasses import dataclass, replace
from itertools import permutations, takewhile

import numpy as np

from identification.acceptance import comes_as_near, fit_without
from identification.evaluate import Evaluator
from identification.evidence import LEAST_EVIDENCE, Ranked, log_fit, misfit_of, with_evidence
from identification.exchange import fit_at
from identification.fit import Fit
from identification.hypothesis import Hypothesis, free_place
from identification.in_its_place import begun_at_leader, judged_beside, without_last
from identification.noise_left import NOISE_NEAR
from identification.reached import NOISE_REACHED
from identification.scene import scenes
from identification.screen import Projection
from identification.session import Session
from models.effects.protocol import Effect, Place
from models.general_laws import GENERAL_LAWS

WORTH_A_FIT = 6.0
"""Logarithm of the odds that a linear step has to promise a general law beside an effect, for a fit in its place."""


NEAR_BEST = 0.5
"""Share of the best promise from which another general law is fitted too."""


@dataclass(frozen=True, eq=False)
class Beyond:
    """A general law that does better than what stands.

    Attributes:
        names: effects in whose place it does, in words.
        stood: the fit of the model with them.
        row: the general law.
    """

    names: str
    stood: Fit
    row: Ranked


def is_beyond_library(session: Session, calibrated: Fit, final: Fit) -> bool:
    """Whether effects of a model stand for a law that the library does not hold; told.

    Args:
        session: with the records, told.
        calibrated: the model without effects.
        final: the model that stands, fitted to a part of the records.
    """
    found = law_beyond(session, calibrated, final)
    if found is None:
        return False
    law, fitted = found.row.effect, found.row.fit
    session.decide(
        f"unexplained after all: {found.names} comes nearest, but {law.label()} alone takes the residual from "
        f"{found.stood.ratio:.3g} to {fitted.ratio:.3g} times the noise in its place: {law.in_words()}, and no kind of "
        "the library does that"
    )
    return True


def law_beyond(session: Session, calibrated: Fit, final: Fit) -> Beyond | None:
    """A general law that explains the records better than an effect, fitted as far, or as well as two; or None.

    Far from the noise, as on real structures, all models miss, and a curve of several numbers is always nearer: there
    nothing is asked, and what does not reach the noise itself is no such law.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        final: the model that stands.
    """
    effects = final.hypothesis.effects
    along = [index for index, effect in enumerate(effects) if "position" in effect.places]
    if not session.fitting.timed or not along or final.ratio > NOISE_NEAR:
        return None
    if not session.has_time_for("a look at laws beyond the library"):
        return None
    for index in along:
        if (found := _in_place_of(session, calibrated, final.hypothesis, index)) is not None:
            return found
    for kept, other in permutations(along, 2):
        if (found := _in_place_of_two(session, calibrated, final, kept, other)) is not None:
            return found
    return None


def _in_place_of(session: Session, calibrated: Fit, model: Hypothesis, index: int) -> Beyond | None:
    """A general law that wins clearly in an effect's place."""
    effect, bare = model.effects[index], model.without_effect(index)
    try:
        leader = fit_at(session, calibrated, replace(model, effects=(*bare.effects, effect)))
        rows = _weighed(session, calibrated, leader, WORTH_A_FIT)
        if not rows:
            return None
        base = fit_at(session, calibrated, bare)
        rows = with_evidence([*rows, *begun_at_leader(session.fitting, base, rows, [effect])])
    except ArithmeticError:  # without the effect nothing stands
        return None
    stood = next(row for row in rows if row.effect.kind == effect.kind)
    by = rows[0].log_evidence - stood.log_evidence
    session.progress(f"{rows[0].effect.label()} against {stood.effect.label()}: odds of e^{by:.1f}")
    return Beyond(effect.label(), stood.fit, rows[0]) if by >= LEAST_EVIDENCE and _explains_all(rows[0]) else None


def _in_place_of_two(session: Session, calibrated: Fit, final: Fit, kept: int, other: int) -> Beyond | None:
    """A general law that explains as much with fewer numbers, in the place of an effect and without another one.

    A law that is none of the library's may take two of them to be met.
    """
    effects = final.hypothesis.effects
    less = fit_without(session, calibrated, final, other)
    if less is None:
        return None
    scale, place = misfit_of(final), kept - (other < kept)
    bare, effect = less.hypothesis.without_effect(place), less.hypothesis.effects[place]
    try:
        leader = fit_at(session, calibrated, replace(bare, effects=(*bare.effects, effect)))
        needed = NEAR_BEST * (log_fit(final, scale) - log_fit(less, scale))
        rows = _weighed(session, calibrated, leader, max(WORTH_A_FIT, needed))
    except ArithmeticError:  # without either nothing stands
        return None
    numbers = _n_numbers(effects[kept]) + _n_numbers(effects[other])
    general = takewhile(lambda row: row.effect.kind in GENERAL_LAWS, rows)
    fewer = (row for row in general if _n_numbers(row.effect) < numbers and _explains_all(row))
    row = next((row for row in fewer if comes_as_near(row.fit, final)), None)
    return None if row is None else Beyond(f"{effects[kept].label()} with {effects[other].label()}", final, row)


def _weighed(session: Session, calibrated: Fit, leader: Fit, least: float) -> list[Ranked]:
    """A fit's last effect and general laws in its place by evidence, one of these first; none where it is not.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        leader: with the effect last.
        least: logarithm of the odds that a linear step has to promise.
    """
    effect = _along(leader.hypothesis.effects[-1], leader.hypothesis)
    promise = promised(session.fitting, leader, effect.place)
    best = max(promise.values())
    session.progress(f"laws beyond the library beside {effect.label()}: a linear step promises odds of e^{best:.1f}")
    kinds = {name: GENERAL_LAWS[name] for name, odds in promise.items() if odds >= max(least, NEAR_BEST * best)}
    if not kinds:
        return []
    base = fit_at(session, calibrated, without_last(leader.hypothesis))
    leader = replace(leader, hypothesis=without_last(leader.hypothesis).with_effects(effect))
    rows = judged_beside(leader, session.fitting, base, (), kinds, session.progress)
    return rows if rows[0].effect.kind in kinds else []


def _explains_all(row: Ranked) -> bool:
    """Whether a general law leaves the noise alone, as the right one does; nearer to what all models miss is no law."""
    return row.fit.ratio <= NOISE_REACHED


def _n_numbers(effect: Effect) -> int:
    """Numbers that a fit determines, those of a curve and the place among them."""
    return len(effect.fitted_values()) + free_place(effect)


def promised(evaluator: Evaluator, found: Fit, place: Place) -> dict[str, float]:
    """Logarithm of the odds that each general law brings beside all of a model's own unknowns, were it linear.

    Args:
        evaluator: records of the fit.
        found: the model, with its slopes.
        place: where the law would act.
    """
    scene = scenes(evaluator, found.hypothesis, [place])[place]
    projection = Projection(found)
    odds: dict[str, float] = {}
    for name, kind in GENERAL_LAWS.items():
        pieces = [found.hypothesis.with_effects(piece) for piece in kind.pieces(scene)]
        rows = evaluator.residuals([(piece, None) for piece in pieces])
        changes = [row - found.residual for row in rows if row is not None]
        gain = projection.gain_of_all(np.stack(changes)) if changes else 0.0
        odds[name] = 0.5 * gain / misfit_of(found)
    return odds


def _along(effect: Effect, model: Hypothesis) -> Effect:
    """The effect with its position, where it sits in a sleeve."""
    if effect.place.sleeve is None or effect.place.position is not None:
        return effect
    return replace(effect, place=replace(effect.place, position=model.rig.sleeve(effect.place.sleeve).position))
