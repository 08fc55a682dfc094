"""What noise of a record's excitation does to its residual, by realisations that the model carries.

Each core draws its own: of a record disturbed here, megabytes would be sent, and megabytes of motion sent back.
"""

from functools import partial

import numpy as np

from identification.evaluate import Evaluator, TimeTarget, shaken, whitened
from identification.hypothesis import Hypothesis
from identification.parallel import in_parallel
from models.arrays import FloatArray
from models.errors import DivergenceError
from models.simulate import Settings


def changes_by_noise(
    evaluator: Evaluator, target: TimeTarget, hypothesis: Hypothesis, rng: np.random.Generator, realisations: int
) -> list[FloatArray]:
    """(n_data,) change of the residual by each realisation; none where the motion left the finite numbers in one.

    Args:
        evaluator: whose cores and resolution are used.
        target: one of its records, whose measured excitation is noisy.
        hypothesis: the model that carries the noise.
        rng: of the realisations.
        realisations: how many.
    """
    try:
        (clean,) = evaluator.with_targets([target]).responses(hypothesis)
        work = partial(_change, target, hypothesis, evaluator.settings, clean.channels)
        return in_parallel(evaluator.jobs, work, rng.spawn(realisations), alike=True)
    except DivergenceError:
        return []


def _change(
    target: TimeTarget, hypothesis: Hypothesis, settings: Settings, clean: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """(n_data,) of one realisation."""
    noisy = target.driven_by(shaken(target.driven, target.noise.excitation, rng))
    return whitened(target.spectrum(noisy.response(hypothesis, settings).channels - clean), target)
