"""Bring the rig's toleranced numbers, and the state at the start of moving records, to the measurements.

A wrong frequency turns into a wrong phase that grows with time, so the fit begins on short windows, where the phase is
still right, and goes on with longer ones. In FRFs it puts a resonance beside the measured one, and the fit begins with
their soft difference.
"""

from collections.abc import Sequence
from contextlib import suppress
from math import ceil

import numpy as np

from identification.evaluate import Evaluator, Target, TimeTarget
from identification.fit import Fit, fit
from identification.hypothesis import (
    LARGEST_SIGMA,
    Hypothesis,
    RigUnknown,
    StartUnknown,
    Unknown,
    effect_unknowns,
    rig_unknowns,
)
from identification.prepare import MIN_SAMPLES, start_unknowns

Windows = tuple[tuple[float, float], ...]

WINDOWS: Windows = ((0.1, 0.5), (0.35, 2.0))
"""First fits: the share of each record's response energy that they see, and the seconds at least."""


def unknowns_of(hypothesis: Hypothesis, evaluator: Evaluator) -> tuple[Unknown, ...]:
    """What is unknown before any effect is added."""
    records = [target.record for target in evaluator.timed]
    return (*rig_unknowns(hypothesis.rig), *start_unknowns(hypothesis, records))


def all_unknowns(hypothesis: Hypothesis, evaluator: Evaluator) -> tuple[Unknown, ...]:
    """The same, and all numbers and places of the effects."""
    return (*unknowns_of(hypothesis, evaluator), *effect_unknowns(hypothesis))


def calibrate(
    evaluator: Evaluator,
    hypothesis: Hypothesis,
    unknowns: Sequence[Unknown],
    windows: Windows = WINDOWS,
    tolerance: float = 2e-4,
) -> Fit:
    """The fit of the unknowns on ever longer windows, ending with all that the evaluator holds.

    Args:
        evaluator: records and noise.
        hypothesis: where to start.
        unknowns: what may move.
        windows: of the first fits.
        tolerance: relative decrease of the cost that ends the last fit.
    """
    hypothesis, short_fit = set_in_motion(evaluator, hypothesis, unknowns), None
    for share, seconds in windows if unknowns else ():
        short = beginning(evaluator, share, seconds)
        if evaluator.at_rest or short.n_data < LONGEST_FIRST * evaluator.n_data:
            short_fit = fit(short, hypothesis, unknowns, tolerance=1e-2, max_iterations=15, like=short_fit)
            hypothesis = short_fit.hypothesis
    return fit(evaluator, hypothesis, unknowns, tolerance=tolerance, precise=True, like=short_fit)


def set_in_motion(evaluator: Evaluator, hypothesis: Hypothesis, unknowns: Sequence[Unknown]) -> Hypothesis:
    """The hypothesis with a state for each record that moves at its first sample and has none yet.

    Where a beam strikes its sleeves, a state that is a little wrong is lost within milliseconds, and a fit of all that
    follows finds none. So it is sought on the first samples alone, and followed from there.

    Args:
        evaluator: records and noise.
        hypothesis: where to start.
        unknowns: what may move; the states among them are sought.
    """
    sought = [u for u in unknowns if isinstance(u, StartUnknown) and u.record not in hypothesis.starts]
    for target in evaluator.timed:
        own = tuple(unknown for unknown in sought if unknown.record == target.record.name)
        if own:
            hypothesis = _begun(evaluator, target, hypothesis, own)
    return hypothesis


def _begun(evaluator: Evaluator, target: TimeTarget, hypothesis: Hypothesis, unknowns: Sequence[Unknown]) -> Hypothesis:
    """The hypothesis with a record's state, or as it was where none of the first samples leads to one."""
    tries: list[Fit] = []
    for n in FIRST_SAMPLES:
        with suppress(ArithmeticError):
            tries.append(_followed(evaluator, target, hypothesis, unknowns, n, CHOSEN, SLOWLY))
    if not tries:
        return hypothesis
    best = min(tries, key=lambda each: each.ratio).hypothesis
    until = min(max(CHOSEN, round(FOLLOWED * target.record.fs)), target.record.n_samples)
    try:
        return _followed(evaluator, target, best, unknowns, CHOSEN, until, FASTER).hypothesis
    except ArithmeticError:
        return best


def _followed(
    evaluator: Evaluator,
    target: TimeTarget,
    hypothesis: Hypothesis,
    unknowns: Sequence[Unknown],
    n: int,
    until: int,
    factor: float,
) -> Fit:
    """The fit of a record's state on ever more of its first samples, from n on."""
    while True:
        short = evaluator.with_targets([target.cut(n, min(target.unjudged, n // 2))])
        found = fit(short, hypothesis, unknowns, tolerance=1e-2, max_iterations=15)
        if n >= until:
            return found
        hypothesis, n = found.hypothesis, min(ceil(factor * n), until)


FIRST_SAMPLES, CHOSEN = (24, 32, 40, 48), 120
"""On which a state is first sought, of which half are judged at least, and samples on which the best of these states is
chosen: with one first window in three, the state of a beam that had been held against a sleeve was lost."""

SLOWLY, FASTER, FOLLOWED = 1.25, 1.5, 0.5
"""Times what was followed before, until the choice and after it, and s up to where a state is followed by itself."""

LONGEST_FIRST = 0.6
"""A first window longer than this share of all is left out: the fit of all is as quick."""


def beginning(evaluator: Evaluator, share: float, seconds: float) -> Evaluator:
    """The time records up to where a share of the response's energy has passed, and so many seconds at least.

    FRFs know no beginning; theirs is the soft difference.

    Args:
        evaluator: with the records.
        share: of the energy, so that a sweep or a late hammer blow is seen at all.
        seconds: at least.
    """
    short: list[Target] = [target.soft() for target in evaluator.at_rest]
    from_start = [target for target in evaluator.timed if not target.begins_later]
    for target in from_start or evaluator.timed:
        record = target.record
        motion = record.responses - np.where(target.without_zero, record.responses.mean(axis=1), 0.0)[:, None]
        power = np.sum((motion / (motion.std(axis=1, keepdims=True) + TINY)) ** 2, axis=0)
        reached = int(np.searchsorted(np.cumsum(power), share * power.sum()))
        least = max(MIN_SAMPLES, reached, round(seconds * record.fs)) + target.waits
        short.append(target.cut_quickly(least, at_least=True))
    return evaluator.with_targets(short)


TINY = 1e-300


def concerning(base: Fit, evaluator: Evaluator) -> tuple[Unknown, ...]:
    """The unknowns of a fit that concern the evaluator's records."""
    names = {target.record.name for target in evaluator.targets}
    return tuple(unknown for unknown in base.unknowns if unknown.record is None or unknown.record in names)


def strained(result: Fit) -> list[RigUnknown]:
    """The rig's numbers that the fit pushed to the end of their tolerance."""
    return _beyond(result, STRAINED_SHARE * LARGEST_SIGMA)


STRAINED_SHARE = 0.95
"""Share of the largest move at which a number counts as pushed to its end."""


def pulled(result: Fit) -> bool:
    """Whether the fit moved a number of the rig so far that something else must have pulled it."""
    return bool(_beyond(result, PULLED_SIGMA))


def put_back(result: Fit) -> Hypothesis:
    """The model of a fit with the numbers that were pulled away where they were given."""
    hypothesis = result.hypothesis
    for unknown in _beyond(result, PULLED_SIGMA):
        hypothesis = unknown.set(hypothesis, 0.0)
    return hypothesis


PULLED_SIGMA = 3.0
"""One true number in some 400 lies this many standard deviations from its given value."""


def _beyond(result: Fit, sigmas: float) -> list[RigUnknown]:
    """The rig's numbers that the fit moved by more than so many standard deviations."""
    rig = (unknown for unknown in result.unknowns if isinstance(unknown, RigUnknown))
    return [unknown for unknown in rig if abs(unknown.get(result.hypothesis)) > sigmas]
