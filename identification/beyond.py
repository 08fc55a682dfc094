"""Whether a law more general than any of the library explains the records better in a found effect's place.

The best kind of the library is found wherever the library holds none that is right, and may come near the noise: a
spring whose force relaxes is nearly a hysteresis, or an absorber of an odd mass. So an effect of a kind that may act
anywhere along the beam is held against laws that hold many others within them, at the same place, with all other
numbers free: a force over speed, over displacement, with a memory (``models.general_laws``). Where one of them wins as
clearly as an effect has to, over every kind of the library that shows there too, the law is none of the library's.
First a linear step tells whether any of them could. Where no kind reaches the noise at first, they are looked for along
the whole beam, as kinds are. All act against the base, on a driven one too.

Source: the score test, C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50; encompassing, G. E. Mizon, J.-F. Richard,
Econometrica 54 (1986) 657: a model that stands explains what its rivals find in the same data.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np

from identification.acceptance import finite_first, fit_without, passing
from identification.evaluate import Evaluator
from identification.evidence import (
    LEAST_EVIDENCE,
    SIMPLER,
    Ranked,
    log_fit,
    misfit_of,
    ranked_together,
    with_evidence,
)
from identification.exchange import fit_at
from identification.fit import Fit
from identification.hypothesis import free_place, numbers_with_place
from identification.in_its_place import judged_beside, refit_sketched
from identification.judge import looks_from
from identification.kept_aside import KeptAside, holds_on, left_of
from identification.noise_left import NOISE_NEAR
from identification.of_a_support import MOST_LEFT, beyond_noise, is_of_a_support
from identification.outcome import distinct
from identification.reached import EXPLAINED_FAR, LEAST_SHARE, NOISE_DOUBTED, NOISE_REACHED, takes_away
from identification.rounds import SCREEN_SECONDS, view_of
from identification.scene import scenes
from identification.screen import Projection
from identification.session import Session
from models.effects.protocol import Effect, Place
from models.general_laws import GENERAL_LAWS
from models.record import AnyRecord
from models.rig import Beam

WORTH_A_FIT = 6.0
"""Logarithm of the odds that a linear step has to promise a general law beside an effect, for a fit in its place."""


LEAST_WHERE_MISSED = 3.0
"""Logarithm of the odds from which a general law stands for one of another kind where what was learnt does not hold on
a record kept aside, which speaks against every law of the library alike. Of nine true effects none let a general law
come first at all, whatever the odds."""


NEAR_BEST = 0.5
"""Share of the best promise, and of what an effect taken out had brought, from which a general law is fitted."""


@dataclass(frozen=True, eq=False)
class Beyond:
    """A general law that does better than any of the library where one stands.

    Attributes:
        replaced: the effects of the library that come nearest there.
        stood: the fit of the model with them.
        row: the general law.
        by: logarithm of the odds for it.
    """

    replaced: tuple[Effect, ...]
    stood: Fit
    row: Ranked
    by: float

    @property
    def in_words(self) -> str:
        """What it does better than what it replaces, as the reason for a verdict."""
        names, law = " with ".join(effect.label() for effect in self.replaced), self.row.effect
        one = "" if len(self.replaced) == 1 else " by itself"
        return (
            f"unexplained after all: {names} comes nearest, but {law.label()}{one} leaves "
            f"{self.row.fit.ratio:.3g} times the noise instead of {self.stood.ratio:.3g}: {law.in_words()}, and no "
            "kind of the library does that"
        )


def is_beyond_library(session: Session, found: Beyond | None) -> bool:
    """Whether what stands is there for a law that the library does not hold; told.

    Args:
        session: told.
        found: the law that ``law_beyond`` has found.
    """
    if found is None or found.by < LEAST_EVIDENCE:
        return False
    _end(session, found.in_words)
    return True


def is_beyond_where_missed(
    session: Session, last: Fit, found: Beyond | None, kept: KeptAside, records: Sequence[AnyRecord]
) -> bool:
    """Whether a law that was not clearly better stands where what was learnt does not hold, and it does better; told.

    Neither may be right: a general law that comes nearer tells that none of the library is.

    Args:
        session: with the records learnt from; told.
        last: the model that stands, fitted to all of them.
        found: the law that ``law_beyond`` has found.
        kept: what the model that stands is worth on records kept aside, with other numbers too.
        records: those kept aside.
    """
    if found is None or kept.holds or found.by < LEAST_WHERE_MISSED:
        return False
    names = " and ".join(kept.missed)
    session.progress(f"{found.row.effect.label()} is put to {names}")
    try:
        law, nearest = (session.fit_of_all(one.hypothesis, one).hypothesis for one in (found.row.fit, found.stood))
    except ArithmeticError:
        return False
    if kept.followed is None:
        missed = [record for record in records if record.name in kept.missed]
        if not holds_on(session, missed, law) or holds_on(session, missed, nearest):
            return False
        does = "as that law does"
    else:
        least = min(left_of(kept, model) for model in (last.hypothesis, nearest))
        share = 1.0 - left_of(kept, law) / least
        if share < LEAST_SHARE:
            return False
        does = f"where that law takes away {share:.0%} of what is left beyond the noise"
    _end(session, f"{found.in_words}; nor does what was learnt hold on {names}, {does}")
    return True


def _end(session: Session, words: str) -> None:
    """The library holds no law that is right: told, and nothing further is looked for."""
    session.decide(words)
    session.is_beyond = True


def with_what_meets_the_noise(session: Session, base: Fit, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking, held against laws beyond the library in its best's place, where no kind reaches the noise; told.

    A general law has more ways down than any kind of the library. It begins where the best of the round has come to, if
    that may act anywhere, and finds its own place from there. Where it reaches the noise, either a kind that had been
    lost is found from its numbers of the rig, or what is missing is one law that the library does not hold
    (``Session.is_beyond``), and no second effect is looked for beside an imitation of it.

    Args:
        session: with the records, told.
        base: the model that the round was looked for from.
        ranked: of the round.
    """
    if not _are_asked_for(session, base, ranked) or not free_place(ranked[0].effect):
        return ranked
    return _held_against(session, base, ranked, _rows_in_place(session, base, ranked[0].fit, 0, WORTH_A_FIT))


def with_what_is_seen_along(session: Session, base: Fit, ranked: list[Ranked]) -> list[Ranked]:
    """The same with laws that are looked for along a whole beam, and need not reach the noise.

    The best of the library may stand in a valley from which the place of the true law is not seen. Where a law reaches
    the noise, or explains as much as a diagnosis has to, kinds of the library are tried in its place.

    Args:
        session: with the records, told.
        base: the model that the round was looked for from.
        ranked: of the round.
    """
    if not _are_asked_for(session, base, ranked):
        return ranked
    return _held_against(session, base, ranked, _rows_anywhere(session, base, ranked[0]))


def _are_asked_for(session: Session, base: Fit, ranked: Sequence[Ranked]) -> bool:
    """Whether laws beyond the library are: nothing was found before, and no kind of it reaches the noise."""
    if session.is_beyond or base.hypothesis.effects or base.ratio <= NOISE_DOUBTED or not session.fitting.timed:
        return False
    return bool(ranked) and ranked[0].refitted and ranked[0].fit.ratio > NOISE_REACHED


def _held_against(session: Session, base: Fit, ranked: list[Ranked], rows: Sequence[Ranked]) -> list[Ranked]:
    """The ranking with kinds of the library that were tried in a law's place, unless that ends the search; told."""
    if not rows:
        return ranked
    ahead = _ahead(rows)
    if ahead is not None:
        nearest = min(beyond_noise(ahead.stood), beyond_noise(ranked[0].fit))
        clear = ahead.by >= LEAST_EVIDENCE and beyond_noise(ahead.row.fit) <= MOST_LEFT * max(nearest, 1.0)
        lasts = clear and session.holds(ahead.row.fit.hypothesis) and passing(session, base, ahead.row) is None
        if lasts and not is_of_a_support(session, base, ahead.row.fit):
            _end(session, ahead.in_words)
            return ranked
    found = distinct(ranked_together([row for row in rows if not _is_general(row)], ranked))
    return finite_first(session, found)


def _rows_anywhere(session: Session, base: Fit, best: Ranked) -> list[Ranked]:
    """By evidence, the general law that explains most from anywhere along the beam, and the library in its place.

    The best of the library may stand in a valley from which the place of the true law is not seen. Where records are
    begun again in pieces, their beginnings, in which it is looked for, were seen before.

    Args:
        session: with the records.
        base: the model without effects.
        best: of the library.

    Returns:
        the rows; empty on an oscillator, which has one place, and where no general law leaves next to nothing of what
        the best of the library does.
    """
    rig, fitting = base.hypothesis.rig, session.fitting
    if session.pieces or not isinstance(rig.structure, Beam):
        return []
    if not session.has_time_for("a look along the beam at laws beyond the library"):
        return []
    session.progress("looking along the whole beam for laws beyond the library")
    try:
        view = view_of(session.searching(base), session.limits, base, GENERAL_LAWS, SCREEN_SECONDS, 2)
        sketches = looks_from(base)[0](view, base, session.progress)
        law = refit_sketched(fitting, base, sketches[0].fit.hypothesis) if sketches else None
        if law is None or not _explains(base, law) or beyond_noise(law) > MOST_LEFT * beyond_noise(best.fit):
            return []
        label = law.hypothesis.effects[-1].label()
        session.progress(f"{label} leaves {law.ratio:.2f} times the noise; kinds of the library are tried there")
        rows = judged_beside(law, fitting, base, (), session.kinds_at_a_place(rig), session.progress)
        return with_evidence([*(row for row in rows if row.refitted), best])
    except ArithmeticError as lost:
        session.progress(f"laws beyond the library were not looked for: {lost}")
        return []


def _explains(base: Fit, law: Fit) -> bool:
    """Whether a law reaches the noise, or takes away as much as an effect far from it has to."""
    return law.ratio <= NOISE_REACHED or takes_away(base, law) >= EXPLAINED_FAR


def law_beyond(session: Session, calibrated: Fit, final: Fit) -> Beyond | None:
    """A general law that explains the records better than an effect, or clearly better than two with more numbers.

    Of those that do not clearly better than an effect, the one with the best odds; None where there is none. Far from
    the noise, as on real structures, all models miss, and a curve of several numbers is always nearer: there nothing is
    asked, and what does not reach the noise itself is no such law.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        final: the model that stands.
    """
    effects = final.hypothesis.effects
    along = [index for index, effect in enumerate(effects) if "position" in effect.places]
    if not session.fitting.timed or not along or final.ratio > NOISE_NEAR:
        return None
    nearly: Beyond | None = None
    for index in along:
        ahead = _ahead(_rows_in_place(session, calibrated, final, index, WORTH_A_FIT))
        if ahead is None:
            continue
        if ahead.by >= LEAST_EVIDENCE:
            return ahead
        nearly = max(nearly or ahead, ahead, key=lambda each: each.by)
    for other in along if len(along) > 1 else []:
        less = fit_without(session, calibrated, final, other)
        if less is None:
            continue
        for kept in (index for index in along if index != other):
            alone = _in_place_of_two(session, calibrated, final, less, kept, other)
            if alone is not None:
                return Beyond((effects[kept], effects[other]), final, *alone)
    return nearly


def _ahead(rows: Sequence[Ranked]) -> Beyond | None:
    """The general law that is first, and the best of the library behind it; None where the library is first."""
    if not rows or not _is_general(rows[0]):
        return None
    first, stood = rows[0], next(row for row in rows if not _is_general(row))
    return Beyond((stood.effect,), stood.fit, first, first.log_evidence - stood.log_evidence)


def _is_general(row: Ranked) -> bool:
    return row.effect.kind in GENERAL_LAWS


def _rows_in_place(session: Session, calibrated: Fit, model: Fit, index: int, least: float) -> list[Ranked]:
    """By evidence, a general law that reaches the noise in an effect's place, that, and the library's kinds there.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        model: with the effect.
        index: of the effect.
        least: logarithm of the odds that a linear step has to promise.

    Returns:
        the rows; empty where no general law reaches the noise.
    """
    if not session.has_time_for("a look at laws beyond the library"):
        return []
    effect, bare = model.hypothesis.effects[index], model.hypothesis.without_effect(index)
    try:
        leader = fit_at(session, calibrated, bare.with_effects(effect))
        promise = promised(session.fitting, leader, effect.place)
        best = max(promise.values())
        session.progress(f"laws beyond the library beside {effect.label()}: a step promises odds of e^{best:.1f}")
        kinds = {name: GENERAL_LAWS[name] for name, odds in promise.items() if odds >= max(least, NEAR_BEST * best)}
        if not kinds:
            return []
        base, fitting = fit_at(session, calibrated, bare), session.fitting
        first = judged_beside(leader, fitting, base, (), kinds, session.progress)[0]
        if not _is_general(first) or first.fit.ratio > NOISE_REACHED:
            return []
        library = session.kinds_at_a_place(bare.rig)
        rows = judged_beside(first.fit, fitting, base, [effect], library, session.progress)
    except ArithmeticError:  # without the effect nothing stands
        return []
    rows = with_evidence([*(row for row in rows if row.refitted), Ranked.of(leader)])
    if (ahead := _ahead(rows)) is not None:
        law, nearest = ahead.row.effect.label(), ahead.replaced[0].label()
        session.progress(f"{law} against {nearest}: odds of e^{ahead.by:.1f}")
    return rows


def _in_place_of_two(
    session: Session, calibrated: Fit, final: Fit, less: Fit, kept: int, other: int
) -> tuple[Ranked, float] | None:
    """A general law in one of two effects' place that is clearly better without the other, and the odds' logarithm.

    A law that is none of the library's may take two of them to be met.

    Args:
        session: with the records.
        calibrated: the model without effects, for its unknowns.
        final: the model that stands.
        less: the same without the other effect.
        kept: index of the effect in whose place the law is tried.
        other: index of the one that is left out.
    """
    scale = misfit_of(final)
    needed = NEAR_BEST * (log_fit(final, scale) - log_fit(less, scale)) * scale / misfit_of(less)
    ahead = _ahead(_rows_in_place(session, calibrated, less, kept - (other < kept), max(WORTH_A_FIT, needed)))
    if ahead is None:
        return None
    effects = [final.hypothesis.effects[index] for index in (kept, other)]
    fewer = sum(map(numbers_with_place, effects)) - numbers_with_place(ahead.row.effect)
    better = log_fit(ahead.row.fit, scale) - log_fit(final, scale) + log(SIMPLER) * fewer
    return (ahead.row, better) if better >= LEAST_EVIDENCE else None


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
