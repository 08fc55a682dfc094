"""Another effect first, where beside the one that explains most by itself nothing reaches the noise.

What explains most of two effects alone may be neither: an absorber hangs its weight on the beam as a sleeve off its
axis does, and brakes as drag does. Beside it neither of the two is seen, while beside either of them the other stands
out. So the runners-up of its round are asked what is seen beside them: selection that looks ahead (S. Chatterjee et
al., IEEE Trans. Signal Process. 60 (2012) 634).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from identification.acceptance import passing
from identification.anew import WORTH_REFITTING, ranked_beside
from identification.evidence import LEAST_EVIDENCE, Ranked, log_fit, log_standing, misfit_in_common, misfit_of
from identification.exchange import fit_at
from identification.fit import Fit
from identification.in_its_place import EXPLAINED
from identification.judge import LARGE
from identification.look import afar, beside
from identification.reached import LEAST_SHARE, reaches_noise, takes_away
from identification.rounds import told_apart
from identification.scene import in_one_valley, valley
from identification.session import Session
from identification.told_by_all import behind_by
from models.effects import Effect
from models.rig import Rig

MOST_RUNNERS_UP = 2

MOST_BEHIND = 2.0
"""Times the residual that the first effect leaves, up to which a runner-up is asked what is seen beside it."""


@dataclass(frozen=True, eq=False)
class AnotherFirst:
    """A runner-up beside which another effect reaches the noise.

    Attributes:
        fit: of the model with it alone.
        round: of its candidates, with it in front.
        ranked: what was seen beside it.
        label: what is done, in words.
        why: what speaks for that.
    """

    fit: Fit
    round: list[Ranked]
    ranked: list[Ranked]
    label: str
    why: str


def another_first(
    session: Session, calibrated: Fit, found: Fit, first_round: Sequence[Ranked], ranked: Sequence[Ranked]
) -> AnotherFirst | None:
    """The runner-up of the first round beside which another effect reaches the noise, or None.

    None is asked where something explains the records beside the first effect already.

    Args:
        session: with the records.
        calibrated: the model without effects.
        found: with the first effect.
        first_round: its round.
        ranked: what was seen beside it.
    """
    nearest = min((found, *(row.fit for row in ranked if row.refitted)), key=lambda each: each.ratio)
    if nearest.ratio <= EXPLAINED:
        return None
    first = found.hypothesis.effects[0].label()
    for row in _runners_up(calibrated, found, first_round):
        name = row.effect.label()
        if not session.has_time_for(f"a search beside {name}"):
            return None
        session.progress(f"nothing seen beside {first} reaches the noise; looking beside {name}, which came after it")
        try:
            base = fit_at(session, calibrated, row.fit.hypothesis)
            seen = ranked_beside(session, base, afar if base.ratio > LARGE else beside, WORTH_REFITTING)
        except ArithmeticError:
            continue
        seen = told_apart(session, seen)
        if _is_explained(session, base, seen):
            why = (
                f"beside that {seen[0].effect.label()} leaves {seen[0].fit.ratio:.2f} times the noise, beside {first} "
                f"nothing less than {nearest.ratio:.2f}"
            )
            in_front = _in_front(row, base, first_round, nearest, seen[0].fit)
            return AnotherFirst(base, in_front, seen, f"{first} exchanged for {name}", why)
    return None


def _is_explained(session: Session, base: Fit, ranked: Sequence[Ranked]) -> bool:
    """Whether the best of what is seen beside a runner-up reaches the noise, and would be added to it."""
    if not (ranked and ranked[0].refitted):
        return False
    best = ranked[0]
    odds = best.log_evidence - log_standing(base, misfit_in_common(ranked))
    speaks = odds >= LEAST_EVIDENCE and takes_away(base, best.fit) >= LEAST_SHARE
    reached = speaks and reaches_noise(session.fitting, best.fit)
    return reached and session.holds(best.fit.hypothesis) and passing(session, base, best) is None


def _runners_up(calibrated: Fit, found: Fit, first_round: Sequence[Ranked]) -> list[Ranked]:
    """What explains nearly as much as the first effect by itself elsewhere, the most probable first."""
    rig, seen = found.hypothesis.rig, [found.hypothesis.effects[0]]
    rows: list[Ranked] = []
    for row in (row for row in first_round if row.refitted and len(row.effect.parts()) == 1):
        near = row.fit.ratio <= MOST_BEHIND * found.ratio and takes_away(calibrated, row.fit) >= LEAST_SHARE
        if near and not any(_are_one(row.effect, other, rig) for other in seen):
            rows.append(row)
            seen.append(row.effect)
    return rows[:MOST_RUNNERS_UP]


def _are_one(one: Effect, other: Effect, rig: Rig) -> bool:
    """Whether two effects act in one sleeve or one valley along the beam, or are of one kind where they have none."""
    if one.place.position is None:
        return one.kind == other.kind and one.place == other.place
    return in_one_valley(one.place, other.place, valley(rig))


def _in_front(row: Ranked, base: Fit, first_round: Sequence[Ranked], before: Fit, now: Fit) -> list[Ranked]:
    """The round with a row first, and what was ahead of it as far behind as the best that was seen beside either.

    What was ahead is not weighed by its own fit any more, which knows nothing of the second effect.
    """
    unit, scale = misfit_in_common(first_round), misfit_of(now)
    apart = 2.0 * (log_fit(now, scale) - log_fit(before, scale))
    first = replace(row, fit=base, effect=base.hypothesis.effects[-1])
    others = [
        replace(behind_by(each, first, apart, unit), refitted=False) if each.log_evidence > row.log_evidence else each
        for each in first_round
        if each is not row
    ]
    return [first, *sorted(others, key=lambda each: -each.log_evidence)]
