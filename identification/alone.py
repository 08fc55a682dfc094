"""Whether one effect explains what two did.

The first of two was looked for from numbers that were pulled to where they imitate what is missing, and the second had
to make up for the first. Together they leave the numbers near the truth, wrong as both may be. So each is tried by
itself, begun anew, and then every kind is looked for once more from the numbers found.
"""

from dataclasses import replace
from math import inf

from identification.acceptance import comes_as_near, explains_as_much, look_without, tell_tangent, worth_fitting
from identification.anew import WORTH_REFITTING, judged_anew
from identification.evidence import Ranked, reweighed, with_evidence
from identification.exchange import fit_at
from identification.fewer import Fewer
from identification.fit import Fit
from identification.in_its_place import settled_apart
from identification.judge import restarted
from identification.pieces import fit_from_own_starts
from identification.rounds import told_apart
from identification.session import Session
from identification.sketch import is_alike


def one_alone(session: Session, calibrated: Fit, found: Fit) -> Fewer | None:
    """One effect that explains what two did: one of them, or another.

    One of the two has to explain as much as any effect that is kept while another is taken out. Of all other kinds at
    all places some imitate the two down to near the noise, so another has to come as near to it as the two, and with
    no more numbers.

    Args:
        session: with the records; told.
        calibrated: the model without effects.
        found: with all effects.

    Returns:
        the model with its round, or None where none is or there are not two effects.
    """
    effects = found.hypothesis.effects
    if len(effects) != 2:
        return None
    names = " and ".join(effect.label() for effect in effects)
    session.progress(f"looking for one effect that does what {names} do")
    alone = _each_of_them(session, calibrated, found)
    rows = told_apart(session, _judged(session, calibrated, found, alone))
    rows = rows[next((k for k, row in enumerate(rows) if _stands(row, found, alone)), len(rows)) :]
    if not rows:
        return None
    effect, best = rows[0].effect, rows[0].fit
    session.decide(
        f"{names} replaced by {effect.label()} alone: that explains the records as well; residual from "
        f"{found.ratio:.2f} to {best.ratio:.2f} times the noise; {effect.in_words()}"
    )
    tell_tangent(session, rows[0])
    return Fewer(best, [rows], f"{names} replaced by {effect.label()} alone")


def _stands(row: Ranked, found: Fit, alone: list[Fit]) -> bool:
    """Whether a suspect, fitted to all that the two are, explains as much: one of them, or no more numbers as near."""
    if not row.refitted or any(is_alike(row.fit, fit) for fit in alone):
        return row.refitted
    numbers = sum(effect.n_numbers for effect in found.hypothesis.effects)
    return row.effect.n_numbers <= numbers and comes_as_near(row.fit, found)


def _each_of_them(session: Session, calibrated: Fit, found: Fit) -> list[Fit]:
    """The fits of the two by themselves, begun anew, that explain as much."""
    fits = []
    for index in range(len(found.hypothesis.effects)):
        look = look_without(session, calibrated, found, index)
        if look is None:
            continue
        less = restarted(session.fitting, calibrated, look)
        if less.ratio <= worth_fitting(found):
            less = fit_from_own_starts(session.fitting, fit_at(session, calibrated, less.hypothesis, polished=True))
            fits += [less] if explains_as_much(session, less, found) else []
    return fits


def _judged(session: Session, calibrated: Fit, found: Fit, alone: list[Fit]) -> list[Ranked]:
    """Every kind without other effects, from the best numbers there are, ranked with those that stand by themselves."""
    near = inf if alone else WORTH_REFITTING * max(1.0, found.ratio)
    try:
        best = min(alone, key=lambda each: each.cost, default=found)
        rows = judged_anew(session, calibrated, replace(best.hypothesis, effects=()), near)
    except ArithmeticError:  # without the two nothing stands
        rows = []
    if not alone:
        return rows
    kept: list[Ranked] = []
    for row in sorted((*map(Ranked.of, alone), *(r for r in rows if r.refitted)), key=lambda row: row.fit.cost):
        kept += [] if any(is_alike(row.fit, other.fit) for other in kept) else [row]
    ranked = reweighed(rows, kept) if rows else with_evidence(kept)
    return settled_apart(session.fitting, ranked, session.progress)
