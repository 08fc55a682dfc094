"""Other places along the beam that the records leave open for an effect.

One mode tells an effect by its size times the square of the shape where it sits: elsewhere it may be smaller or larger.
And where two kinds explain the records alike, each may do so from another valley along the beam as well.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import log

from scipy.stats import truncnorm

from identification.elsewhere import elsewhere
from identification.evidence import Ranked, reweighed
from identification.fit import Fit, fit
from identification.hypothesis import PlaceUnknown, free_place
from identification.outcome import members_of, undecided
from identification.scene import is_same_place
from identification.session import Session

WIDE_PLACE = 0.05
"""Standard deviation of a place, as a share of the length, from which on other places are told."""

PARTS = 3
"""Equally probable parts of the beam that a wide place falls into: a group of more tells nobody where to look."""

MOST_IN_DOUBT = 3
"""Effects of a round that are sought in other valleys, the most probable first."""


def with_other_valleys(session: Session, base: Fit, ranked: list[Ranked]) -> list[Ranked]:
    """The round with what cannot be told from its best effect in other valleys as well, where they explain as much.

    Args:
        session: with the records.
        base: the model without an effect more.
        ranked: the best first.
    """
    doubted = members_of(ranked)[:MOST_IN_DOUBT]
    if len(doubted) < 2:
        return ranked
    rows = [
        Ranked.of(found)
        for row in doubted
        if row.refitted
        for found in elsewhere(session.fitting, base, row.fit, session.registry)
    ]
    return reweighed(ranked, [*(row for row in ranked if row.refitted), *rows]) if rows else ranked


def in_parts(session: Session, ranked: Sequence[Ranked], standing: Fit, index: int) -> list[Ranked]:
    """The round of an effect whose place is hardly told, with the same elsewhere, all as probable as one another.

    Its place is normally distributed about the one that was fitted, on the beam. Each part of the beam that is as
    probable as the others has a member in the middle of its probability; the one that was fitted stands for the part it
    is nearest to. What the records exclude is no member. Beside another effect that they do not exclude the place is
    left as it is: a group is to tell that first.

    Args:
        session: with the records.
        ranked: the round, the effect's row first.
        standing: the model that stands with honest intervals.
        index: of the effect.
    """
    first = ranked[0]
    if not (first.refitted and free_place(first.effect)) or len(members_of(ranked)) > 1:
        return list(ranked)
    members = [row for where in _other_parts(standing, index) if (row := _held(session, first, where)) is not None]
    near = {id(row) for row, _ in undecided([first, *members], [1.0, *(0.0 for _ in members)])}
    members = [row for row in members if id(row) in near]
    if not members:
        return list(ranked)
    share = first.log_evidence - log(1.0 + len(members))
    return [replace(row, log_evidence=share) for row in (first, *members)] + list(ranked[1:])


def _other_parts(standing: Fit, index: int) -> Iterator[float]:
    """The middles, m, of the equally probable parts of the beam in which the effect does not sit."""
    for unknown, std in zip(standing.unknowns, standing.std(), strict=True):
        if not (isinstance(unknown, PlaceUnknown) and unknown.effect == index):
            continue
        place = standing.hypothesis.effects[index].place
        where, spread, rig = place.position or 0.0, float(std) * unknown.unit, standing.hypothesis.rig
        if spread <= WIDE_PLACE * unknown.length:
            return
        ends = (-where / spread, (unknown.length - where) / spread)
        parts = truncnorm(*ends, loc=where, scale=spread)
        middles = [float(parts.ppf((part + 0.5) / PARTS)) for part in range(PARTS)]
        nearest = min(middles, key=lambda middle: abs(middle - where))
        for middle in middles:
            if middle != nearest and not is_same_place(replace(place, position=middle), place, rig):
                yield middle


def _held(session: Session, row: Ranked, where: float) -> Ranked | None:
    """The row's fit with its effect held at another place; None where the model leaves the finite numbers there."""
    found, index = row.fit, row.fit.hypothesis.effects.index(row.effect)
    (place,) = (u for u in found.unknowns if isinstance(u, PlaceUnknown) and u.effect == index)
    moved = place.set(found.hypothesis, where / place.unit)
    unknowns = [unknown for unknown in found.unknowns if unknown is not place]
    try:
        return Ranked.of(fit(session.fitting, moved, unknowns, precise=True, like=found), index)
    except ArithmeticError:
        return None
