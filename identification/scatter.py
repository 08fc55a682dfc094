"""How far parts of the records disagree about each number: what a model misses everywhere a little shows there.

Two codes that have both converged still differ by some share of the noise, and so does any model from any rig. That is
not seen in chi-square, but it is the same in a mode in every record, or in a mode on every channel, where noise is not.
"""

from collections.abc import Callable

import numpy as np

from identification.consistency.modes import frequency_of, mode_bands
from identification.evaluate import Evaluator, TimeTarget
from identification.fit import Fit
from models.arrays import FloatArray, IntArray

Parts = Callable[[TimeTarget, IntArray], IntArray]
"""A record and the (n_data,) band of each number of its residual, to the part that the number belongs to."""


def widening(evaluator: Evaluator, found: Fit, shares: FloatArray) -> FloatArray:
    """(n_unknowns,) factor on each standard deviation, 1 where the parts scatter no more than noise lets them.

    The score of a part, J^T r over the band about one natural frequency, scatters with noise. What the model misses
    adds up in it before it adds up in all. Parts are a mode on one channel in all records, and a mode in one record on
    all channels; the larger scatter counts. What the parts have in common, no scatter shows.

    Args:
        evaluator: with time records alone.
        found: at its minimum on them, with the covariance for noise.
        shares: (n_unknowns, n_data) slope times residual there, less what noise makes of it in the mean.

    Source: K.-Y. Liang, S. L. Zeger, Biometrika 73 (1986) 13, equation 8: the variance of estimates from clusters.
    """
    names = list(dict.fromkeys(name for target in evaluator.timed for name in target.record.sensors))
    records = [target.record.name for target in evaluator.timed]

    def on_a_channel(target: TimeTarget, band: IntArray) -> IntArray:
        rows = [names.index(name) for name in target.record.sensors]
        return np.asarray((band - 1) * len(names) + np.repeat(rows, target.n_data // len(rows)))

    def in_a_record(target: TimeTarget, band: IntArray) -> IntArray:
        return np.asarray((band - 1) * len(records) + records.index(target.record.name))

    edges = mode_bands(evaluator, found.hypothesis).edges
    prior = np.diag([1.0 if unknown.prior else 0.0 for unknown in found.unknowns])
    inverse = np.linalg.pinv(found.jacobian @ found.jacobian.T + prior, hermitian=True)
    known, widest = found.std() ** 2, np.ones(len(found.unknowns))
    for parts, n_others in ((on_a_channel, len(names)), (in_a_record, len(records))):
        moves = inverse @ _scores(evaluator, shares, edges, parts, len(edges) * n_others)
        widest = np.maximum(widest, np.sqrt(np.sum(moves**2, axis=1) / known))
    return widest


def _scores(evaluator: Evaluator, shares: FloatArray, edges: FloatArray, parts: Parts, n_parts: int) -> FloatArray:
    """(n_unknowns, n_parts) slope of half the chi-square in each part."""
    scores = np.zeros((len(shares), n_parts))
    ends = np.cumsum([target.n_data for target in evaluator.timed])
    for target, end in zip(evaluator.timed, ends.tolist(), strict=True):
        part = parts(target, np.searchsorted(edges, frequency_of(target), side="right"))
        rows = shares[:, end - target.n_data : end]
        scores += np.stack([np.bincount(part, weights=row, minlength=n_parts) for row in rows])
    return scores
