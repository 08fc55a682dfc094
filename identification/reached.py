"""What it takes for a model to have reached the noise."""

import numpy as np

from identification.evaluate import Evaluator, TimeTarget, unwhitened
from identification.fit import Fit
from models.arrays import FloatArray

NOISE_REACHED = 1.15
"""Residual over noise up to which a model has nothing left to explain: the noise itself is known to about a tenth."""

ERROR_REACHED = 1.3
"""The same for the error, to which all records add alike and loud channels most: what is left in one short record, or
where the motion is large, hardly shows among all samples. Models of other makers differ from this one by up to a third
of the noise."""


MODELS_APART = 0.004
"""Share of a record's rms by which two ways to compute the same rig differ: a second of impacts by the modal model and
by a chain of segments (results/crosscheck). No structure is known better, however quiet its sensors are."""


NOISE_KNOWN = 0.9
"""Share of the noise that is surely there: it is known to about a tenth."""


def is_as_near_as_models(evaluator: Evaluator, result: Fit) -> bool:
    """Whether a model misses no more of any record's motion than two models of the same rig miss of each other's.

    Modes and FRFs are not asked: a linear model computes them far closer.

    Args:
        evaluator: records of the fit.
        result: of them.
    """
    return len(evaluator.timed) == len(evaluator.targets) and missed(evaluator, result) <= MODELS_APART


def missed(evaluator: Evaluator, result: Fit) -> float:
    """Rms of what a model misses beyond the noise, as a share of each channel's, over a time record's channels.

    Args:
        evaluator: records of the fit.
        result: of them.

    Returns:
        that of the record in which it is most; NaN where a channel cannot be told.
    """
    parts = np.split(result.residual, np.cumsum([target.n_data for target in evaluator.targets])[:-1])
    pairs = zip(evaluator.targets, parts, strict=True)
    return float(np.max([_missed(target, part) for target, part in pairs if isinstance(target, TimeTarget)]))


def _missed(target: TimeTarget, residual: FloatArray) -> float:
    error = np.sum(np.abs(unwhitened(residual, target)) ** 2, axis=1)
    noise = NOISE_KNOWN**2 * np.sum(target.density, axis=1)
    power = np.sum(np.abs(target.measured) ** 2, axis=1) / target.record.n_samples
    with np.errstate(invalid="ignore", divide="ignore"):
        return float(np.sqrt(np.mean(np.maximum(error - noise, 0.0) / power)))


def reaches_noise(evaluator: Evaluator, result: Fit) -> bool:
    """Whether a model leaves nothing to explain, neither of all samples nor of each record's motion.

    Args:
        evaluator: records of the fit.
        result: of them.
    """
    error = evaluator.nrmse_of(result.residual)
    return result.ratio <= NOISE_REACHED and error <= ERROR_REACHED * evaluator.nrmse_of_noise
