"""The longest beginning of the records that a model explains, and how much of them it predicts.

Where sleeves are struck hard the misfit has many valleys, and half a second is too long for a first fit. On a tenth of
a second there is one, and from its bottom the beginning is lengthened for as long as the noise is reached. The given
numbers may also leave a sleeve alone that the true ones strike: then the given motion is calm, the true one is not, and
whole records are explained by nothing. By what explains the beginning it is judged how far neighbouring motions stay
together.
"""

from collections.abc import Sequence
from dataclasses import replace

from identification.calibrate import Windows, beginning, set_in_motion
from identification.evaluate import Evaluator
from identification.evidence import Ranked, reweighed
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, Unknown
from identification.reached import NOISE_REACHED
from identification.session import Session
from identification.sketch import is_alike

BEGINNINGS: Windows = tuple((0.001 * 2.0**k, 0.1 * 2.0**k) for k in range(7))
"""Share of the response's energy, and seconds at least, of one beginning after the other."""


def explained_beginning(evaluator: Evaluator, start: Hypothesis, unknowns: Sequence[Unknown]) -> Fit | None:
    """The fit on the longest beginning of time records that reaches the noise, each begun where the one before ended.

    Args:
        evaluator: records and noise.
        start: of the first fit.
        unknowns: what may move.

    Returns:
        None where the shortest does not reach the noise.
    """
    reached = None
    for window in BEGINNINGS if evaluator.timed else ():
        short = beginning(evaluator, *window)
        hypothesis = start if reached is None else reached.hypothesis
        try:
            hypothesis = set_in_motion(short, hypothesis, unknowns)
            now = fit(short, hypothesis, unknowns, tolerance=1e-2, max_iterations=MOST_ITERATIONS)
        except ArithmeticError:
            break
        if now.ratio > NOISE_REACHED:
            break
        reached = now
    return reached


MOST_ITERATIONS = 15


def beginnings_of(session: Session, ranked: Sequence[Ranked]) -> list[Fit]:
    """What explains the beginning of the records among suspects of which none explains all that is fitted.

    Args:
        session: with the records.
        ranked: sorted.
    """
    if not ranked or ranked[0].fit.ratio <= NOISE_REACHED:
        return []
    found = (_beginning_of(session, row) for row in ranked)
    return [each for each in found if each is not None]


def _beginning_of(session: Session, row: Ranked) -> Fit | None:
    """From the sketch's numbers, and from the given ones where these have been bent."""
    if row.sketch is None:
        return None
    model, unknowns = row.sketch.hypothesis, row.fit.unknowns
    first = explained_beginning(session.fitting, model, unknowns)
    if first is not None and _is_long(session, first):
        return first
    second = explained_beginning(session.fitting, replace(model, values={}, starts={}), unknowns)
    return max((each for each in (first, second) if each is not None), key=lambda each: each.n_data, default=None)


def shorten(session: Session, beginnings: Sequence[Fit]) -> bool:
    """Shorten what is fitted to what the model predicts that explains the longest beginning; whether it is less.

    Args:
        session: with the records; told.
        beginnings: models that explain one, and no more.
    """
    longest = max(beginnings, key=lambda each: each.n_data, default=None)
    return longest is not None and _is_long(session, longest) and session.shorten_to(longest.hypothesis)


def _is_long(session: Session, first: Fit) -> bool:
    """Whether an explained beginning tells which numbers are right."""
    return first.n_data >= LONG_ENOUGH * session.fitting.n_data


LONG_ENOUGH = 0.03
"""Share of the data."""


def refitted_from(session: Session, beginnings: Sequence[Fit], ranked: list[Ranked]) -> list[Ranked]:
    """The ranking with the suspects that explain the longest beginnings refitted from there, where that is better.

    Args:
        session: with the records.
        beginnings: models with one effect more, each explaining one.
        ranked: sorted.
    """
    told = [each for each in beginnings if _is_long(session, each)]
    chosen: list[Fit] = []
    for each in sorted(told, key=lambda found: -found.n_data):
        if len(chosen) < MOST_REFITTED and not any(is_alike(each, other) for other in chosen):
            chosen.append(each)
    rows = [row for row in ranked if row.refitted]
    for each in chosen:
        try:
            again = fit(session.fitting, each.hypothesis, each.unknowns, precise=True, like=each)
        except ArithmeticError:
            continue
        alike = [row for row in rows if is_alike(row.fit, again)]
        if all(again.cost < row.fit.cost for row in alike):
            session.progress(f"{again.hypothesis.effects[-1].label()} explains the beginning; refitted from there")
            rows = [*(row for row in rows if row not in alike), Ranked.of(again)]
    return reweighed(ranked, rows) if chosen else ranked


MOST_REFITTED = 3
