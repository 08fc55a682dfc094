"""The noise corrected by what a fitted model leaves.

Where the signal fills every band, the noise cannot be told from the records alone and is estimated too high. A model's
residual is noise and misfit, so its floor is never below the noise: where it lies clearly below the estimate, the
estimate is lowered to it. It is never raised, because what a model leaves may be what it lacks; and it is left alone
where the model is far from it, because then no decision hangs on it.

An excitation that fills the whole band hides its own noise, which then stands in the residual where the rig resonates.
Lowering the sensors' noise lays it bare, and it must not be taken for a missing effect: once the effects had their say,
it is told by its shape, the rig's gain, up to ``MOST_HIDDEN`` of the excitation.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from identification.evaluate import Evaluator, Target, TimeTarget, carry_noise, unwhitened
from identification.evidence import LEAST_EVIDENCE
from identification.floor import scatter_of_medians, spectral_floor
from identification.hypothesis import Hypothesis
from identification.noise import BANDS, LINES_PER_FREE_ONE_OF_HANN, Noise
from identification.prepare import level
from models.arrays import ComplexArray, FloatArray

NOISE_NEAR = 1.5
"""Residual over noise up to which what is left may be the noise estimate's own error."""

CLEARLY = 2.0
"""Standard deviations by which the residual's floor must lie below the noise to be believed."""

LEAST_LINES = 100.0
"""Free lines that a floor must rest on: its standard deviation is then known to 7 %."""

MODEL_ERROR = 2e-4
"""Share of a channel's rms to which the reduced model is right (results/modal_convergence): no floor counts below."""

MOST_HIDDEN = 0.02
"""Noise of a force sensor, as a share of its signal's rms, below which a hidden one must lie to be believed."""


def noise_left(evaluator: Evaluator, residual: FloatArray) -> list[Noise]:
    """The noise of each time record, lowered to what a model leaves; the same object where nothing is clearly lower.

    Args:
        evaluator: with the records and the noise so far.
        residual: (n_data,) that the model leaves, in units of the noise so far.
    """
    if float(np.mean(residual**2)) > NOISE_NEAR**2:
        return [target.noise for target in evaluator.timed]
    return [_lowered(target, spectrum) for target, spectrum in _spectra(evaluator, residual)]


def noise_uncovered(
    evaluator: Evaluator, hypothesis: Hypothesis, residual: FloatArray, rng: np.random.Generator
) -> list[Noise]:
    """The same, with the likeliest noise of excitations that hide theirs.

    Args:
        evaluator: with the records and the noise so far.
        hypothesis: the best model there is: what it lacks may look like this noise.
        residual: (n_data,) that it leaves, in units of the noise so far.
        rng: for the realisations of the noise that is carried through the model.
    """
    lowered = noise_left(evaluator, residual)
    if not any(noise.hidden for noise in lowered):
        return lowered
    gains = _gains(evaluator, hypothesis, rng)
    return [
        _uncovered(replace(target, noise=noise), spectrum, gains[target.record.name]) if noise.hidden else noise
        for (target, spectrum), noise in zip(_spectra(evaluator, residual), lowered, strict=True)
    ]


def with_noise(
    evaluator: Evaluator,
    noises: Sequence[Noise],
    hypothesis: Hypothesis,
    rng: np.random.Generator,
    realisations: int = 4,
) -> Evaluator:
    """The evaluator with other noise, that of the excitation carried through the model.

    Args:
        evaluator: with the records, whole or in part.
        noises: of its time records.
        hypothesis: the model that carries it.
        rng: for the realisations of the noise.
        realisations: simulations averaged.
    """
    left = iter(noises)
    evaluator = evaluator.with_targets(
        [each.with_noise(next(left)) if isinstance(each, TimeTarget) else each for each in evaluator.targets]
    )
    return evaluator.with_targets(carry_noise(evaluator, hypothesis, rng, realisations))


def _spectra(evaluator: Evaluator, residual: FloatArray) -> list[tuple[TimeTarget, ComplexArray]]:
    """(n, lines) of what is left in each time record."""
    return [
        (target, unwhitened(part, target))
        for target, part in evaluator.parts_of(residual)
        if isinstance(target, TimeTarget)
    ]


def _lowered(target: TimeTarget, spectrum: ComplexArray) -> Noise:
    """Under a Hann window, so that what rings beyond the end of the record does not fill the quiet bands.

    What is begun in motion is left alone: its start has been fitted to its noise.
    """
    if target.begins_later:
        return target.noise
    hann = (0.5 * spectrum[:, 1:-1] - 0.25 * (spectrum[:, 2:] + spectrum[:, :-2])) / np.sqrt(3.0 / 8.0)
    sensors = target.noise.sensors.copy()
    for k, channel in enumerate(np.abs(hann[:, FIRST_LINE:]) ** 2):
        floor = spectral_floor(channel, max(LEAST_WIDTH, len(channel) // BANDS), LINES_PER_FREE_ONE_OF_HANN)
        left = max(np.sqrt(floor.density), MODEL_ERROR * target.record.responses[k].std())
        sure = 1.0 + 0.5 * CLEARLY * scatter_of_medians(floor.lines)
        if floor.lines >= LEAST_LINES and left * sure < sensors[k]:
            sensors[k] = left
    if np.array_equal(sensors, target.noise.sensors):
        return target.noise
    return replace(target.noise, sensors=sensors, method="what the fitted model leaves")


FIRST_LINE = 2

LEAST_WIDTH = 16
"""Lines of a band at least."""


def _gains(evaluator: Evaluator, hypothesis: Hypothesis, rng: np.random.Generator) -> dict[str, FloatArray]:
    """(n, lines) density at the sensors that the excitation's noise carries, relative to its own, by record."""
    trial = {t.record.name: MOST_HIDDEN * level(t.record) for t in evaluator.timed if t.noise.hidden}
    shaken: list[Target] = [
        replace(target, noise=replace(target.noise, excitation=trial[target.record.name]))
        for target in evaluator.timed
        if target.noise.hidden
    ]
    carried = evaluator.with_targets(carry_noise(evaluator.with_targets(shaken), hypothesis, rng)).timed
    return {t.record.name: (t.density - t.with_noise(t.noise).density) / trial[t.record.name] ** 2 for t in carried}


def _uncovered(target: TimeTarget, spectrum: ComplexArray, gain: FloatArray) -> Noise:
    """The noise with the hidden one of the excitation at its likeliest, if that explains what is left."""
    noise = target.noise
    rms = level(target.record)
    most = noise.excitation or MOST_HIDDEN * rms
    trials = np.array([noise.excitation, *(most * np.geomspace(LEAST_HIDDEN, 1.0, HIDDEN_TRIALS))])
    sensors, power = target.with_noise(noise).density, np.abs(spectrum) ** 2
    densities = (sensors + trial**2 * gain for trial in trials)
    costs = [float(np.sum(np.log(density) + power / density)) for density in densities]
    best = int(np.argmin(costs))
    left = float(np.mean(power / (sensors + trials[best] ** 2 * gain)))
    at_the_end = noise.excitation == 0 and best == len(trials) - 1
    if costs[0] - costs[best] < LEAST_EVIDENCE or left > NOISE_NEAR**2 or at_the_end:
        return noise
    words = f"hidden by the excitation: {trials[best] / rms:.2%} of it, by the shape of what the fitted model leaves"
    return replace(noise, excitation=float(trials[best]), excitation_method=words)


LEAST_HIDDEN = 0.03
"""The smallest share of the largest noise that is tried."""

HIDDEN_TRIALS = 25
