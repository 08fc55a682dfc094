"""How far each number moves when a mode, a channel or a record is left out: what a model misses a little shows there.

Two codes that have both converged still differ by some share of the noise, and so does any model from any rig. That is
not seen in chi-square, but with a hundred thousand data it is many standard deviations of a number; and what takes the
place of a missing effect in one mode does not in another.
"""

from collections.abc import Iterator

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student_t

from identification.consistency.modes import frequency_of, mode_bands
from identification.evaluate import Evaluator, Target, TimeTarget
from identification.evidence import LEAST_EVIDENCE, misfit_of
from identification.fit import Fit, inverse_of, prior_of
from identification.hypothesis import coordinates
from identification.rest_target import FrfTarget, ModesTarget
from models.arrays import FloatArray, IntArray

CLEARLY = 2.0
"""Standard deviations by noise beyond which a move is none of noise."""

MOST_LEVERAGE = 25.0
"""Variance without a part over that with it, beyond which it alone tells the number and nothing contradicts it."""


def widening(evaluator: Evaluator, found: Fit, shares: FloatArray) -> FloatArray:
    """(n_unknowns,) factor on each standard deviation, 1 where no part of the data moves the number beyond noise.

    Parts are the modes, the channels or the records; that division counts whose moves scatter most. Left out is a part
    of the linearised problem, so nothing is simulated. A variance from few parts is itself uncertain: each is as large
    as a normal distribution needs to hold 95 % where Student's does.

    Args:
        evaluator: records that were fitted.
        found: at its minimum on them, with the covariance for noise.
        shares: (n_unknowns, n_data) slope times residual there, less what noise makes of it in the mean.

    Source: the jackknife of groups, which for clusters of least squares is CR3 of R. M. Bell, D. F. McCaffrey, Survey
    Methodology 28 (2002) 169, less what noise moves.
    """
    prior = prior_of(found.unknowns)
    known, excess = found.std() ** 2, np.zeros(len(found.unknowns))
    for parts in _divisions(evaluator, found):
        moved = beyond_noise(found.jacobian, shares, parts, prior, known)
        excess = np.maximum(excess, moved * _of_few(len(np.unique(parts))))
    return np.asarray(np.sqrt(1.0 + excess / known))


def _of_few(n_parts: int) -> float:
    """Factor on a variance from so many parts."""
    freedom = max(n_parts - 1, LEAST_FREEDOM)
    return float((student_t.ppf(INSIDE, freedom) / norm.ppf(INSIDE)) ** 2)


LEAST_FREEDOM, INSIDE = 2, 0.975
"""Two records would make it six times as wide, which says no more than that there are but two; 95 % lie between the
second and its mirror image."""


def beyond_noise(
    jacobian: FloatArray, shares: FloatArray, parts: IntArray, prior: FloatArray, known: FloatArray
) -> FloatArray:
    """(n_unknowns,) variance of the numbers by how they move as each part is left out, beyond that by noise.

    A move counts that noise makes less often than ``CLEARLY`` says, and of a number that the other parts tell as well.

    Args:
        jacobian: (n_unknowns, n_data).
        shares: (n_unknowns, n_data) slope times residual, less what noise makes of it in the mean.
        parts: (n_data,) number of the part.
        prior: (n_unknowns,) information known beforehand.
        known: (n_unknowns,) variance for noise.
    """
    information = jacobian @ jacobian.T + np.diag(prior)
    inverse = np.diag(inverse_of(information))
    numbers = np.unique(parts)
    excess = np.zeros(len(known))
    for number in numbers.tolist():
        part = parts == number
        others = jacobian[:, ~part]
        without = inverse_of(others @ others.T + np.diag(prior))
        squares = (without @ shares[:, part].sum(axis=1)) ** 2
        by_noise = known * np.maximum(np.diag(without) / inverse - 1.0, 0.0)
        counts = (squares > CLEARLY**2 * by_noise) & (np.diag(without) < MOST_LEVERAGE * inverse)
        excess += np.where(counts, squares - by_noise, 0.0)
    return np.asarray((1.0 - 1.0 / len(numbers)) * excess)


def is_needed_throughout(evaluator: Evaluator, less: Fit, found: Fit) -> bool:
    """Whether the data need an effect, whichever mode, channel or record is left out.

    A number may move far as a part is left out (a valley, a motion that is hard to predict) without hanging on it. What
    does hang on a part is not missed by the others: left to themselves, they are explained without the effect as well,
    the numbers free to take the one linear step that the part kept them from. What there is but one of is not left out.

    Args:
        evaluator: records that were fitted.
        less: the fit without the effect.
        found: the one with it, on the same data.
    """
    prior = prior_of(less.unknowns)
    pulled = prior * coordinates(less.hypothesis, less.unknowns)
    scale = misfit_of(found)
    divisions = (parts for parts in _divisions(evaluator, found) if len(np.unique(parts)) > 1)
    for parts in divisions:
        for number in np.unique(parts).tolist():
            others = parts != number
            jacobian, residual = less.jacobian[:, others], less.residual[others]
            slope = jacobian @ residual + pulled
            free = slope @ inverse_of(jacobian @ jacobian.T + np.diag(prior)) @ slope
            without = residual @ residual + less.penalty - free
            gain = without - found.residual[others] @ found.residual[others] - found.penalty
            if 0.5 * gain / scale < LEAST_EVIDENCE:
                return False
    return True


def _divisions(evaluator: Evaluator, found: Fit) -> Iterator[IntArray]:
    """(n_data,) number of the part that each number of the residual belongs to: its mode, its channel, its record."""
    edges = mode_bands(evaluator, found.hypothesis).edges
    names = list(dict.fromkeys(name for target in evaluator.targets for name in target.record.sensors))
    frequency, channel = zip(*(_frequency_and_channel(target, names) for target in evaluator.targets), strict=True)
    yield np.searchsorted(edges, np.concatenate(frequency), side="right")
    yield np.concatenate(channel)
    yield np.repeat(np.arange(len(evaluator.targets)), [target.n_data for target in evaluator.targets])


def _frequency_and_channel(target: Target, names: list[str]) -> tuple[FloatArray, IntArray]:
    """(n_data,) Hz and channel of each number; mode shapes are of all channels at once, so a part of their own."""
    if isinstance(target, ModesTarget):
        return target.mode_freqs, np.full(target.n_data, len(names))
    assert isinstance(target, TimeTarget | FrfTarget)
    rows = [names.index(name) for name in target.record.sensors]
    return frequency_of(target), np.repeat(rows, target.n_data // len(rows))
