"""The last word on the numbers: free of the steps of the fit, and with intervals for the noise as it is.

A fit on tens of thousands of samples knows its numbers to parts in ten thousand, which is finer than a model stepped
just finely enough for the eye. And what the excitation's noise does to one channel it does to all of them, which a sum
over channels as if they were independent does not know; nor does it know of what the model misses a little everywhere.
"""

from dataclasses import replace

import numpy as np
from scipy import fft

from identification.evaluate import Evaluator, Target, TimeTarget
from identification.fit import Fit, fit, newton_step, prior_of
from identification.hypothesis import Hypothesis, at_coordinates, coordinates
from identification.noise_changes import changes_by_noise
from identification.scatter import widening
from models.arrays import FloatArray
from models.simulate import Settings

FINER = 4
"""How much shorter the steps of the correction are, and how many times as many modes it has."""

CORRECTIONS = 2
"""Newton's iterations with the finer residual and the fit's own Jacobian."""

REALISATIONS = 32
"""Of the excitation's noise."""

LARGEST_CORRECTION = 0.5
"""Of an unknown, in its own coordinate; a larger one is no correction."""

CONTRACTION = 0.5
"""Length of the second step over the first, in standard deviations, from which on the corrections lead nowhere: in a
curved valley that a fit has not followed to its end, the slopes are not those of where the first step leads."""

BIASES, DISAGREEING = 3, 0.4
"""Realisations by which a bias is told, and the share of it by which they may scatter."""

LARGEST_BIAS = 4.0
"""The same of what the excitation's noise does to a number, which it may pull as far as its tolerance lets it."""


def corrected(evaluator: Evaluator, found: Fit, rng: np.random.Generator) -> Fit:
    """The fit moved to the minimum of a finely resolved model, with a covariance for correlated noise.

    Args:
        evaluator: records that were fitted.
        found: the fit at its minimum.
        rng: for the realisations of the excitation's noise.

    Intervals are widened by how far the numbers move as a mode, a channel or a record is left out (``scatter``).
    Source: defect correction, K. Boehmer, P. W. Hemker, H. J. Stetter, Computing Suppl. 5 (1984) 1; the covariance is
    that of a misspecified likelihood, H. White, Econometrica 50 (1982) 1, theorem 3.2; the bias is that of errors in
    variables, T. Soderstrom, Automatica 43 (2007) 939, section 5, in its nonlinear form.
    """
    if not found.unknowns:
        return found
    moved = _finely(evaluator, found) if evaluator.timed else found
    quick = evaluator.with_settings(Settings(evaluator.settings.n_modes))  # what noise changes needs no short steps
    known = replace(moved, covariance=_covariance(quick, moved, rng))
    free, bias = _unbiased(quick, known, moved.covariance, rng)
    judge = finer(evaluator, free.hypothesis) if evaluator.timed else evaluator
    residual = judge.residuals([(free.hypothesis, None)])[0]
    if residual is None:
        return free
    factor = widening(evaluator, free, free.jacobian * residual - bias)
    return replace(free, covariance=free.covariance * np.outer(factor, factor), widened=factor)


def finer(evaluator: Evaluator, hypothesis: Hypothesis) -> Evaluator:
    """The same records at a resolution whose steps cannot be seen.

    Args:
        evaluator: with a time record at least.
        hypothesis: whose resolution is refined.
    """
    modes = max(response.model.n for response in evaluator.responses(hypothesis))
    settings = evaluator.settings
    return evaluator.with_settings(replace(settings, n_modes=FINER * modes, times=FINER * settings.times))


def _finely(evaluator: Evaluator, found: Fit) -> Fit:
    """The fit moved by what a finer model leaves, as far as that leads somewhere."""
    fine = finer(evaluator, found.hypothesis)
    hypothesis, kept, longest, least = found.hypothesis, found.hypothesis, np.inf, np.inf
    prior = prior_of(found.unknowns)
    for _ in range(CORRECTIONS):
        residual = fine.residuals([(hypothesis, None)])[0]
        x = coordinates(hypothesis, found.unknowns)
        cost = np.inf if residual is None else float(residual @ residual + prior @ x**2)
        if residual is None or cost > least:
            break
        kept, least = hypothesis, cost
        step, promise = newton_step(hypothesis, found.unknowns, found.jacobian, residual)
        if np.abs(step).max(initial=0.0) > LARGEST_CORRECTION or np.sqrt(promise) > longest:
            break
        longest = max(CONTRACTION * np.sqrt(promise), CONVERGED)
        hypothesis = at_coordinates(hypothesis, found.unknowns, x + step)
    else:
        kept = hypothesis
    residual = None if kept is found.hypothesis else evaluator.residuals([(kept, None)])[0]
    if residual is None:
        return found
    x = coordinates(kept, found.unknowns)
    return replace(
        found, hypothesis=kept, residual=residual, chi2=float(residual @ residual), penalty=float(prior @ x**2)
    )


CONVERGED = 0.1
"""Standard deviations within which a second step need not be shorter than the first."""


def _unbiased(
    evaluator: Evaluator, found: Fit, inverse: FloatArray, rng: np.random.Generator
) -> tuple[Fit, FloatArray]:
    """The fit moved by what the noise of the measured excitation does to least squares, where that is told.

    Besides, (n_unknowns, n_data) what it adds to each slope times its residual in the mean; 0 where nothing is moved.

    The model answers that noise too, most where a resonance meets no excitation, and least squares takes the numbers
    that answer least. At the truth E[J^T r] is E[dJ^T dr], dr and dJ being what the noise does to residual and slopes,
    line by line in proportion to it: so a few realisations of random phases tell it whose lines are all as high as the
    noise is in the mean. Their scatter is also that of the record's own noise. Where they disagree, the ends of the
    records speak and not the lines, and nothing is moved.
    """
    model, unknowns, none = found.hypothesis, found.unknowns, np.zeros_like(found.jacobian)
    if not any(target.noise.excitation > 0.0 and target.record.excitation is not None for target in evaluator.timed):
        return found, none
    shares = []
    try:
        clean = fit(evaluator, model, unknowns, max_iterations=0, like=found)
        for _ in range(BIASES):
            noisy = fit(_with_even_noise(evaluator, rng), model, unknowns, max_iterations=0, like=found)
            shares.append((noisy.jacobian - clean.jacobian) * (noisy.residual - clean.residual))
    except ArithmeticError:
        return found, none
    steps = [inverse @ share.sum(axis=1) for share in shares]
    step, scatter = np.mean(steps, axis=0), np.cov(np.transpose(steps)).reshape(len(unknowns), len(unknowns))
    most = int(np.argmax(np.abs(step) / np.sqrt(np.diag(found.covariance))))
    if scatter[most, most] > (DISAGREEING * step[most]) ** 2 or np.abs(step).max() > LARGEST_BIAS:
        return found, none
    moved = at_coordinates(model, unknowns, coordinates(model, unknowns) + step)
    free = replace(found, hypothesis=moved, covariance=found.covariance + (1.0 + 1.0 / BIASES) * scatter)
    return free, np.mean(shares, axis=0)


def _with_even_noise(evaluator: Evaluator, rng: np.random.Generator) -> Evaluator:
    """The records with noise in their excitations whose spectrum is the same on every line, at random phases."""

    def one(target: Target) -> Target:
        if not isinstance(target, TimeTarget) or target.driven.excitation is None:
            return target
        n = target.driven.n_samples
        turns = np.exp(2j * np.pi * rng.random(n // 2 + 1))
        noise = fft.irfft(target.noise.excitation * turns, n, norm="ortho")
        return target.driven_by(replace(target.driven, excitation=target.driven.excitation + noise))

    return evaluator.with_targets([one(target) for target in evaluator.targets])


def _covariance(evaluator: Evaluator, found: Fit, rng: np.random.Generator) -> FloatArray:
    """(n_unknowns, n_unknowns) of the estimate under the sensors' noise and that of each record's excitation."""
    shares, realisations = [], []
    ends = np.cumsum([0, *(target.n_data for target in evaluator.targets)])
    for target, start in zip(evaluator.targets, ends[:-1].tolist(), strict=True):
        part = found.jacobian[:, start : start + target.n_data]
        if not isinstance(target, TimeTarget) or target.noise.excitation == 0.0 or target.record.excitation is None:
            shares.append(np.ones(target.n_data))
            continue
        own = target.with_noise(target.noise).density / target.density
        shares.append(np.repeat(np.minimum(own, 1.0).ravel(), 2))
        changes = changes_by_noise(evaluator, target, found.hypothesis, rng, REALISATIONS)
        realisations += [part @ change for change in changes]
    if not realisations:
        return found.covariance
    prior = np.diag(prior_of(found.unknowns))
    score = (found.jacobian * np.concatenate(shares)) @ found.jacobian.T + prior
    score += sum(np.outer(r, r) for r in realisations) / REALISATIONS
    return np.asarray(found.covariance @ score @ found.covariance)
