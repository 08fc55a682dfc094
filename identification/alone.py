"""Whether one effect explains what two did.

The first of two was looked for from numbers that were pulled to where they imitate what is missing, and the second had
to make up for the first. Together they leave the numbers near the truth, wrong as both may be. So each is tried by
itself, begun anew, and then every kind is looked for once more from the numbers found.
"""

from dataclasses import replace

from identification.acceptance import explains_as_much, fit_without
from identification.calibrate import concerning
from identification.evidence import Ranked, reweighed
from identification.exchange import fit_at
from identification.fewer import Fewer
from identification.fit import Fit, fit
from identification.judge import finals, restarted
from identification.look import View, beside
from identification.prepare import cut_to
from identification.rounds import SCREEN_SECONDS, told_apart
from identification.session import Session
from identification.sketch import is_alike


def one_alone(session: Session, calibrated: Fit, found: Fit) -> Fewer | None:
    """One effect that explains what two did: one of them, or another.

    Args:
        session: with the records; told.
        calibrated: the model without effects.
        found: with all effects.

    Returns:
        the model with its round, or None where none is or there are not two effects.
    """
    effects = found.hypothesis.effects
    if len(effects) != len(PAIR):
        return None
    names = " and ".join(effect.label() for effect in effects)
    session.progress(f"looking for one effect that does what {names} do")
    alone = _one_of_them(session, calibrated, found)
    try:
        rows = _from_there(session, calibrated, alone or found)
    except ArithmeticError:  # without the two nothing stands
        rows = []
    if alone is not None:
        others = [row for row in rows if row.refitted and not is_alike(row.fit, alone)]
        rows = reweighed(rows or [Ranked.of(alone)], [Ranked.of(alone), *others])
    if not rows or not explains_as_much(session, rows[0].fit, found):
        return None
    effect, best = rows[0].effect, rows[0].fit
    session.decide(
        f"{names} replaced by {effect.label()} alone: that explains the records as well; residual from "
        f"{found.ratio:.2f} to {best.ratio:.2f} times the noise; {effect.in_words()}"
    )
    return Fewer(best, [told_apart(session, rows)], f"{names} replaced by {effect.label()} alone")


PAIR = (1, 0)
"""Of the two the later one first: nothing but the earlier one made up for it."""


def _one_of_them(session: Session, calibrated: Fit, found: Fit) -> Fit | None:
    """The fit of one of two effects by itself, begun anew, that explains as much."""
    for kept in PAIR:
        less = fit_without(session, calibrated, found, 1 - kept)
        if less is None:
            continue
        less = restarted(session.fitting, calibrated, less)
        if explains_as_much(session, less, found):
            return less
    return None


def _from_there(session: Session, calibrated: Fit, found: Fit) -> list[Ranked]:
    """Every kind judged without other effects, from the numbers found.

    Kinds that act over the length of a record are left out: no two others do what they do.
    """
    bare = fit_at(session, calibrated, replace(found.hypothesis, effects=()))
    evaluator = cut_to(session.searching(bare), SCREEN_SECONDS, session.limits, 2)
    there = fit(evaluator, bare.hypothesis, concerning(bare, evaluator), max_iterations=0)
    structure = bare.hypothesis.rig.structure.kind
    kinds = {name: k for name, k in session.registry.items() if structure in k.structures and k.family != "time"}
    sketches = beside(View(evaluator, there, kinds), bare, session.progress)
    return finals(sketches, session.fitting, bare, kinds, session.progress)
