"""The numbers that every record has for itself, such as the phase of a hum, brought to where they fit best.

A wrong phase makes a right effect look worse than none, so whoever tries an effect asks for its phases first.
"""

from math import pi

import numpy as np

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis, with_own_number
from models.arrays import FloatArray
from models.effects import Effect

TRIALS = (0.0, 2.0 * pi / 3.0, 4.0 * pi / 3.0)
"""Phases at which the residual is formed: it is a constant, a cosine and a sine of the phase."""

FINE = np.linspace(-pi, pi, 721)


def tried_with(evaluator: Evaluator, model: Hypothesis, effect: Effect) -> Hypothesis:
    """The model with one effect more, whose phases fit each record best.

    Args:
        evaluator: with the records.
        model: without the effect.
        effect: at trial values.
    """
    return in_step(evaluator, model.with_effects(effect), (effect,))


def in_step(evaluator: Evaluator, hypothesis: Hypothesis, effects: tuple[Effect, ...]) -> Hypothesis:
    """The hypothesis with the records' own numbers of some of its effects where they fit each time record best.

    Each is a phase, on which the residual depends as a cosine and a sine do while the effect is small; they are found
    one after the other.

    Args:
        evaluator: with the records.
        hypothesis: with the effects.
        effects: whose phases are sought.
    """
    names = [name for effect in effects for name in effect.record_parameters]
    for name in names if evaluator.timed else ():
        trials = [_everywhere(evaluator, hypothesis, name, phase) for phase in TRIALS]
        rows = evaluator.residuals([(trial, None) for trial in trials])
        if any(row is None for row in rows):
            return hypothesis
        known = [row for row in rows if row is not None]
        ends = np.cumsum([0, *(target.n_data for target in evaluator.targets)])
        for target, start, end in zip(evaluator.targets, ends[:-1], ends[1:], strict=True):
            if target in evaluator.timed:
                best = _best([row[start:end] for row in known])
                hypothesis = with_own_number(hypothesis, target.record.name, name, best)
    return hypothesis


def _everywhere(evaluator: Evaluator, hypothesis: Hypothesis, name: str, value: float) -> Hypothesis:
    for target in evaluator.timed:
        hypothesis = with_own_number(hypothesis, target.record.name, name, value)
    return hypothesis


def _best(rows: list[FloatArray]) -> float:
    """The phase of least chi-square, from the residuals at ``TRIALS``."""
    phase = np.array(TRIALS)
    parts = np.stack([np.ones(3), 2.0 * np.cos(phase), 2.0 * np.sin(phase)]) @ np.stack(rows) / 3.0
    dots = parts @ parts.T
    basis = np.stack([np.ones_like(FINE), np.cos(FINE), np.sin(FINE)])
    return float(FINE[np.argmin(np.einsum("ip,ij,jp->p", basis, dots, basis))])
