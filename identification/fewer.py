"""Whether one effect less explains as much, where those that stay may sit elsewhere.

Found one by one, each effect makes up for what the earlier ones get wrong: two at wrong places ask for a third, and
then none of the three is needless where it stands. So one is kept, one taken out, and the third looked for at all other
places.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations

from identification.acceptance import explains_as_much
from identification.elsewhere import elsewhere
from identification.evidence import Ranked
from identification.exchange import beside_rows, fit_at
from identification.fit import Fit
from identification.hypothesis import free_place
from identification.in_its_place import without_last
from identification.session import Session
from models.effects import Effect

LEAST_EFFECTS = 3
"""Of two, ``alone`` asks."""


@dataclass(frozen=True, eq=False)
class Fewer:
    """A model with one effect less.

    Attributes:
        fit: of the model.
        rounds: effects ranked in the round of each of its effects.
        label: what was done, in words.
    """

    fit: Fit
    rounds: list[list[Ranked]]
    label: str


def with_fewer(session: Session, calibrated: Fit, found: Fit, rounds: Sequence[list[Ranked]]) -> Fewer | None:
    """Two effects that explain what three did, one of them where it was and one at another place.

    Args:
        session: with the records; told.
        calibrated: the model without effects.
        found: with all effects.
        rounds: effects ranked in the round of each.

    Returns:
        the first such model, or None where none is or there are fewer effects than ``LEAST_EFFECTS``.
    """
    effects = found.hypothesis.effects
    if len(effects) != LEAST_EFFECTS:
        return None
    pairs = permutations(range(len(effects)), 2)
    for kept, moved in ((kept, moved) for kept, moved in pairs if free_place(effects[moved])):
        (needless,) = {*range(len(effects))} - {kept, moved}
        fits = _fits_of(session, calibrated, found, [effects[index] for index in (kept, needless, moved)])
        best = min(fits, key=lambda each: each.cost, default=None)
        if best is None or not explains_as_much(session, best, found):
            continue
        effect = best.hypothesis.effects[-1]
        label = f"{effects[needless].label()} and {effects[moved].label()} replaced by {effect.label()} alone"
        session.decide(
            f"{label}: beside {effects[kept].label()} that explains the records as well; residual from "
            f"{found.ratio:.2f} to {best.ratio:.2f} times the noise; {effect.in_words()}"
        )
        return Fewer(best, [rounds[kept], beside_rows([Ranked.of(best)], rounds[moved])], label)
    return None


def _fits_of(session: Session, calibrated: Fit, found: Fit, effects: Sequence[Effect]) -> list[Fit]:
    """The first of three effects and the last one at other places, without the one between; none where none stands."""
    hypothesis = replace(found.hypothesis, effects=tuple(effects))
    names = " and ".join(effect.label() for effect in effects[1:])
    session.progress(f"looking for a place at which {effects[-1].kind} does what {names} do")
    try:
        base = fit_at(session, calibrated, without_last(hypothesis, 2))
        return elsewhere(session.fitting, base, fit_at(session, calibrated, hypothesis), session.registry, 2)
    except ArithmeticError:
        return []
