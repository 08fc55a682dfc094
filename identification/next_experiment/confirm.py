"""The separation of two rivals by refitting the wrong one to what the right one predicts, old records and the new one.

What a number can explain away is a matter of slopes only as long as it moves little; a law that contains another
(friction that slips slowly is a dashpot) moves far. So what is proposed is confirmed by a fit.

Source: A. C. Atkinson, V. V. Fedorov, Biometrika 62 (1975) 57: T-optimality, the wrong model at its best fit.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from identification.evaluate import Evaluator
from identification.fit import Fit, fit
from identification.hypothesis import EffectUnknown, Hypothesis, Unknown, at_coordinates, coordinates
from identification.next_experiment.forecast import Forecast, own_of_test
from identification.next_experiment.rivals import Rival
from models.arrays import FloatArray

WINDOWS = (0.3, 0.8)
"""Seconds of the new record that are fitted first: what is far off at its end has lost its way, and finds it there."""

ITERATIONS, TOLERANCE = 8, 0.01
"""Of a fit that only has to show whether a separation stands."""


class Against(Evaluator):
    """An evaluator in which a model's prediction stands for what was measured.

    Args:
        evaluator: records and noise.
        truth: the model.

    Raises:
        ArithmeticError: the model diverges.
    """

    def __init__(self, evaluator: Evaluator, truth: Hypothesis) -> None:
        super().__init__(evaluator.targets, evaluator.jobs, evaluator.settings)
        (row,) = evaluator.residuals([(truth, None)])
        if row is None:
            raise ArithmeticError("the model that stands for the truth diverges")
        self._truth = row

    def residuals(self, hypotheses: Iterable[tuple[Hypothesis, str | None]]) -> list[FloatArray | None]:
        """Residuals in units of the noise against the model's prediction.

        Args:
            hypotheses: as those of ``Evaluator``.
        """
        rows = super().residuals(hypotheses)
        return [None if row is None else row - self._truth for row in rows]


def confirmed(seen: Forecast, rivals: Sequence[Rival], old: Evaluator, scatter: FloatArray) -> FloatArray:
    """The covariance of the log odds with every separation found by a fit, where that is less.

    Args:
        seen: predictions of a test.
        rivals: the same.
        old: the records so far.
        scatter: (K, K, K) from slopes.

    Raises:
        ArithmeticError: a fit has lost its way, and nothing is confirmed.
    """
    found = scatter.copy()
    for a, b in permutations(range(len(rivals)), 2):
        size = _refitted(seen, rivals, old, a, b)
        if size < scatter[a, b, b]:
            share = np.sqrt(size / scatter[a, b, b])
            found[a, b, :] *= share
            found[a, :, b] *= share
    return found


def _refitted(seen: Forecast, rivals: Sequence[Rival], old: Evaluator, a: int, b: int) -> float:
    """What the new record takes from b if a is right: twice the loss of ``evidence.log_fit`` at b's new fit."""
    (target,) = seen.evaluator.timed
    seconds = target.record.duration
    # Two seconds stand for the whole of a steady test: their noise is that of its mean.
    new = replace(target, density=target.density * seconds / max(seen.useful, seconds))
    right, wrong = (_with_starts(rivals[i].fit.hypothesis, seen.models[i]) for i in (a, b))
    unknowns = (*rivals[b].fit.unknowns, *own_of_test(wrong, [target.record]))
    (before,) = Against(old, right).residuals([(wrong, None)])
    if before is None:
        raise ArithmeticError("a rival diverges on the records so far")
    beginnings = [new.cut(round(part * target.record.fs)) for part in WINDOWS if part < seconds]
    longer = [Against(old.with_targets([*old.targets, part]), right) for part in (*beginnings, new)]
    near, now = _beside(longer[-1], right, rivals[b], wrong), float(before @ before)
    least = np.inf
    for start in (near, wrong):
        for end in _fitted_longer(longer, start, unknowns):
            least = min(least, (end.chi2 - now) / seen.unit + end.penalty - rivals[b].fit.penalty)
        if least < NO_DIFFERENCE:
            break
    if least == np.inf:
        raise ArithmeticError("no fit of a rival finds its way through the new record")
    return max(0.0, float(least))


NO_DIFFERENCE = 1.0
"""Square of a separation, in standard deviations, below which no other start is tried."""


def _beside(both: Against, right: Hypothesis, rival: Rival, wrong: Hypothesis) -> Hypothesis:
    """The rival with the right one's numbers of the rig, its own moved to where it comes nearest to what that predicts.

    A law that holds the right one within it has that far along the way in which its own numbers are hardly known
    together: friction that slips as fast as no motion so far is a dashpot, and at a larger motion slips faster.

    Args:
        both: the old records and the new one, against the right one's prediction.
        right: what stands for the truth.
        rival: the wrong one.
        wrong: the same on these records.
    """
    begun = replace(wrong, values=right.values)
    effects, numbered = rival.fit.hypothesis.effects, list(enumerate(rival.unknowns))
    own = [i for i, u in numbered if isinstance(u, EffectUnknown) and effects[u.effect] == rival.effect]
    if not own:
        return begun
    unknowns = tuple(rival.unknowns[i] for i in own)
    variance, axes = np.linalg.eigh(rival.axes[:, own].T @ rival.axes[:, own])
    step = np.sqrt(np.clip(variance[-1], 0.0, WIDEST**2))
    widest, here = step * axes[:, -1], coordinates(begun, unknowns)
    tried = [begun, *(at_coordinates(begun, unknowns, here + way * widest) for way in WAYS)]
    costs = [np.inf if row is None else float(row @ row) for row in both.residuals([(each, None) for each in tried])]
    return tried[int(np.argmin(costs))]


WAYS = (-8.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 8.0)
"""Standard deviations along it, or steps of ``WIDEST`` where that is less."""

WIDEST = 1.0
"""In the unknowns' own coordinates: of numbers that nothing tells a standard deviation leads to the ends at once."""


def _fitted_longer(longer: Sequence[Against], start: Hypothesis, unknowns: Sequence[Unknown]) -> list[Fit]:
    """The fit to the whole from ever longer beginnings, or from the last of them that it comes from."""
    starts = [start]
    for part in longer[:-1]:
        starts += [found.hypothesis for found in _fitted(part, starts[-1], unknowns)]
    return next((ends for start in reversed(starts) if (ends := _fitted(longer[-1], start, unknowns))), [])


def _fitted(against: Against, start: Hypothesis, unknowns: Sequence[Unknown]) -> list[Fit]:
    """The fit from a start, if it does not lose its way."""
    try:
        return [fit(against, start, unknowns, max_iterations=ITERATIONS, tolerance=TOLERANCE)]
    except ArithmeticError:
        return []


def _with_starts(fitted: Hypothesis, new: Hypothesis) -> Hypothesis:
    """A rival's fit, about the rig of the new test, with the states at the start of old records and of the new one."""
    return replace(fitted, rig=new.rig, starts={**fitted.starts, **new.starts})
