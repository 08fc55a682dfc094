"""What it takes for a model to have reached the noise."""

from dataclasses import replace

import numpy as np

from identification.evaluate import Evaluator, TimeTarget, unwhitened
from identification.fit import Fit
from identification.hypothesis import Hypothesis
from models.arrays import FloatArray

NOISE_REACHED = 1.15
"""Residual over noise up to which a model has nothing left to explain: the noise itself is known to about a tenth."""

ERROR_REACHED = 1.3
"""The same for the error, to which all records add alike and loud channels most: what is left in one short record, or
where the motion is large, hardly shows among all samples. Models of other makers differ from this one by up to a third
of the noise."""


MODELS_APART, LINEAR_APART = 0.005, 0.001
"""Share of the motion by which two ways to compute the same rig differ, with impacts and without: modes and a chain of
segments at its default are 0.3 to 1 % apart in a second with impacts, their linear FRFs at most 0.008 dB
(results/crosscheck). No structure is known better, however quiet its sensors are."""

QUIET = 0.01
"""Noise, as a share of the motion, above which what lies beyond it is not told: it is known to about a tenth."""


NOISE_DOUBTED = 1.25
"""Residual over noise up to which what nothing in the library explains may be the noise estimate's own error."""


FAINT, NEARLY_ALL = 1.04, 0.8
"""Residual over noise, reached with an effect, from which on another is looked for beside it, and the share of what is
left that it must take away: records that repeat know their noise to a hundredth or two, others to a tenth, but hardly
any effect takes away what the noise was told wrongly by, or what two ways to compute the same rig differ by."""

LEAST_SHARE = 0.25
"""An effect is added, or described in more detail, only if that takes away this share of the squared misfit beyond the
noise, or reaches it."""

STRAYS = 2.0
"""Standard deviations by which what impacts make of the force's noise in one record may lie above its mean."""

EXPLAINED_NEAR, EXPLAINED_FAR = 0.9, 0.97
"""Share of the squared misfit beyond the noise that the effects must take away where the noise is not reached: a law
outside the library finds an imitation in it that takes away most, the right one leaves what all models miss."""


LEAST_FOLLOWED, LARGE_ERROR = 0.5, 0.5
"""Share of what the noise leaves to be told of the motion, as power, that a diagnosis tells at least, and the error
below which that is not in question."""


def is_silenced(evaluator: Evaluator, result: Fit, least: float = LEAST_FOLLOWED) -> bool:
    """Whether a model tells next to nothing of the motion.

    Where the records are noise, or of another rig, one that says that nothing moves leaves less than one that moves
    otherwise: a force divided by hundreds, or a damping that stops all, takes away most of the misfit.

    Args:
        evaluator: records of the fit.
        result: of them.
        least: share of what the noise leaves to be told that it tells at least.
    """
    floor = evaluator.nrmse_of_noise
    if result.ratio * floor < LARGE_ERROR:
        return False
    told, left = 1.0 - evaluator.nrmse_of(result.residual) ** 2, 1.0 - floor**2
    return told < least * max(left, 0.0)


def is_faint(evaluator: Evaluator, result: Fit) -> bool:
    """Whether a model leaves more than the noise, by as little as tells of an effect more beside those found.

    Args:
        evaluator: records of the fit.
        result: of them.
    """
    return result.ratio > max(FAINT, 1.0 + STRAYS * evaluator.strays)


def is_as_near_as_models(evaluator: Evaluator, result: Fit) -> bool:
    """Whether a model misses no more of any time record's motion than two models of the same rig miss of each other's.

    Modes and FRFs must reach the noise: a linear model computes them far closer.

    Args:
        evaluator: records of the fit.
        result: of them.
    """
    if not evaluator.timed or max(target.nrmse_of_noise for target in evaluator.timed) > QUIET:
        return False
    share = missed(evaluator, result)
    near = share <= LINEAR_APART or (share <= MODELS_APART and _strikes(evaluator, result.hypothesis))
    parts = evaluator.parts_of(result.residual)
    at_rest = [part for target, part in parts if not isinstance(target, TimeTarget)]
    return near and all(np.mean(part**2) <= NOISE_DOUBTED**2 for part in at_rest)


def _strikes(evaluator: Evaluator, hypothesis: Hypothesis) -> bool:
    """Whether a sleeve is touched and left again in some record."""
    traces = [response.trace for response in evaluator.responses(hypothesis, replace(evaluator.settings, trace=True))]
    touching = [trace.contact_forces != 0.0 for trace in traces if trace is not None]
    return any(bool((each.any(axis=1) & ~each.all(axis=1)).any()) for each in touching)


def takes_away(base: Fit, found: Fit) -> float:
    """Share of the misfit beyond the noise."""
    return (base.cost - found.cost) / max(base.cost - base.n_data, 1.0)


def tells_much(base: Fit, found: Fit) -> bool:
    """Whether a model described in more detail is worth it: it reaches the noise, or takes away much of what was left.

    Args:
        base: the model as it was.
        found: in more detail.
    """
    return found.ratio <= NOISE_REACHED or takes_away(base, found) >= LEAST_SHARE


def missed(evaluator: Evaluator, result: Fit) -> float:
    """Rms over a time record's channels of what a model misses beyond the noise, each as a share of its own rms.

    Args:
        evaluator: records of the fit.
        result: of them.

    Returns:
        that of the record in which it is most; NaN where a channel cannot be told.
    """
    parts = evaluator.parts_of(result.residual)
    return float(np.max([_missed(target, part) for target, part in parts if isinstance(target, TimeTarget)]))


def _missed(target: TimeTarget, residual: FloatArray) -> float:
    error = np.sum(np.abs(unwhitened(residual, target)) ** 2, axis=1)
    noise = target.judged_share * np.sum(target.density, axis=1)
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
