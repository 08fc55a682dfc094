"""How well a hypothesis predicts records: errors beside the noise floor."""

from collections.abc import Sequence

import numpy as np

from identification.calibrate import calibrate, unknowns_of
from identification.evaluate import Evaluator, nrmse
from identification.fit import Fit, fit_to_its_end
from identification.hypothesis import Hypothesis, OwnNumber, effect_unknowns
from identification.in_step import in_step
from identification.intervals import corrected
from identification.prepare import prepare, start_unknowns
from identification.result import RecordScore, Score
from identification.unstrained import unstrained
from models.record import AnyRecord


def assess(hypothesis: Hypothesis, records: Sequence[AnyRecord], *, jobs: int = 2, seed: int = 0) -> Score:
    """Predict every record from its measured excitation and compare.

    The state at the start of records that do not start at rest is estimated first, nothing else is.

    Args:
        hypothesis: the model.
        records: of any kind.
        jobs: cores.
        seed: of the noise that is carried through the model.
    """
    evaluator = prepare(hypothesis, records, jobs, np.random.default_rng(seed))
    return score(evaluator, with_starts(evaluator, hypothesis))


def with_starts(evaluator: Evaluator, hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis with the starting states, and other numbers of the records' own, that fit its records best."""
    unknowns = start_unknowns(hypothesis, [target.record for target in evaluator.timed])
    hypothesis = in_step(evaluator, hypothesis, hypothesis.plant().effects)
    unknowns = (*unknowns, *(u for u in effect_unknowns(hypothesis) if isinstance(u, OwnNumber)))
    return calibrate(evaluator, hypothesis, unknowns).hypothesis if unknowns else hypothesis


def score(evaluator: Evaluator, hypothesis: Hypothesis) -> Score:
    """Errors of a hypothesis on the evaluator's records, starts as they are."""
    rows: list[RecordScore] = []
    for target, response in zip(evaluator.timed, evaluator.responses(hypothesis), strict=True):
        residual = target.spectrum(response.channels) - target.measured
        power = np.maximum(np.sum(np.abs(target.measured) ** 2, axis=1), np.finfo(float).tiny)
        rows.append(
            RecordScore(
                record=target.record,
                predicted=target.at_its_zero(response.channels),
                noise=target.noise,
                nrmse=nrmse(residual, target.measured, target.quantities),
                noise_nrmse=target.nrmse_of_noise,
                channel_nrmse=np.sqrt(np.sum(np.abs(residual) ** 2, axis=1) / power),
                channel_noise_nrmse=np.sqrt(target.noise_power / power),
            )
        )
    return Score(tuple(rows), tuple(target.score(hypothesis) for target in evaluator.at_rest))


def fit_effects(hypothesis: Hypothesis, records: Sequence[AnyRecord], *, jobs: int = 2, seed: int = 0) -> Fit:
    """Refit the hypothesis's effects together with the rig's toleranced numbers.

    Args:
        hypothesis: with effects at trial values.
        records: of any kind.
        jobs: cores.
        seed: of the noise that is carried through the model.
    """
    rng = np.random.default_rng(seed)
    evaluator = prepare(hypothesis, records, jobs, rng)
    found = unstrained(evaluator, calibrate_effects(evaluator, hypothesis))
    ended = fit_to_its_end(evaluator, found.hypothesis, found.unknowns, like=found)
    return corrected(evaluator, ended, rng)


def calibrate_effects(evaluator: Evaluator, hypothesis: Hypothesis) -> Fit:
    """The numbers of the hypothesis's effects calibrated together with the rig's, at the places where they are.

    Args:
        evaluator: with the records.
        hypothesis: with effects at trial values.
    """
    unknowns = (*unknowns_of(hypothesis, evaluator), *effect_unknowns(hypothesis, places=False))
    return calibrate(evaluator, hypothesis, unknowns)
