"""What it takes for a model to have reached the noise."""

from identification.evaluate import Evaluator
from identification.fit import Fit

NOISE_REACHED = 1.15
"""Residual over noise up to which a model has nothing left to explain: the noise itself is known to about a tenth."""

ERROR_REACHED = 1.3
"""The same for the error, to which all records add alike and loud channels most: what is left in one short record, or
where the motion is large, hardly shows among all samples. Models of other makers differ from this one by up to a third
of the noise."""


def reaches_noise(evaluator: Evaluator, result: Fit) -> bool:
    """Whether a model leaves nothing to explain, neither of all samples nor of each record's motion.

    Args:
        evaluator: records of the fit.
        result: of them.
    """
    error = evaluator.nrmse_of(result.residual)
    return result.ratio <= NOISE_REACHED and error <= ERROR_REACHED * evaluator.nrmse_of_noise
