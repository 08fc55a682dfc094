"""Which modes a calibrated model meets: its residual over the noise about each natural frequency."""

from dataclasses import dataclass
from math import log, sqrt

import numpy as np

from identification.at_rest import linear_model
from identification.evaluate import Evaluator, TimeTarget
from identification.fit import Fit
from identification.hypothesis import Hypothesis
from identification.rest_target import FrfTarget
from models.arrays import BoolArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.linear import natural_modes

LOW_MODES = 4
"""Modes that a cantilever is usually fitted to; those beyond are held against them."""

CLEARLY = 1.5
"""A residual over noise so many times that of another part is no matter of the noise's estimate (``NOISE_NEAR``)."""


@dataclass(frozen=True, eq=False)
class ModeBands:
    """Bands about the natural frequencies.

    Attributes:
        edges: (n_modes + 1,) Hz, the geometric means between neighbours, 0 and infinity at the ends.
        natural_freqs: (n_modes,) Hz, of small motion about rest.
    """

    edges: FloatArray
    natural_freqs: FloatArray

    @property
    def edge(self) -> float | None:
        """Hz between the last low mode and the first beyond; None where there is none beyond."""
        return float(self.edges[LOW_MODES]) if len(self.natural_freqs) > LOW_MODES else None


def mode_bands(evaluator: Evaluator, hypothesis: Hypothesis) -> ModeBands:
    """The bands of the modes of a hypothesis that lie within what the records are judged by.

    Args:
        evaluator: with the records.
        hypothesis: linearised at rest.
    """
    tops = [SCORE_EDGE * target.record.fs for target in evaluator.timed]
    tops += [float(target.frequency.max()) for target in evaluator.at_rest if isinstance(target, FrfTarget)]
    if not tops:
        return ModeBands(np.array([0.0, np.inf]), np.zeros(1))
    freqs = natural_modes(linear_model(hypothesis, max(tops)), (), max(tops)).natural_freqs
    return ModeBands(np.concatenate([[0.0], np.sqrt(freqs[:-1] * freqs[1:]), [np.inf]]), freqs)


def frequency_of(target: TimeTarget | FrfTarget) -> FloatArray:
    """(n_data,) Hz of each number of a residual.

    Args:
        target: with a spectrum.
    """
    if isinstance(target, FrfTarget):
        frequency = target.frequency
    else:
        frequency = np.arange(target.measured.shape[1]) * target.record.fs / target.record.n_samples
    return np.tile(np.repeat(frequency, 2), target.n_data // (2 * len(frequency)))


@dataclass(frozen=True, eq=False)
class Missed:
    """Modes that the model misses while it meets others, or the other way round.

    Attributes:
        low: residual over noise of the first modes.
        beyond: of those that differ from them, or of all beyond.
        modes: numbers of the modes that differ, from 1.
        sigma: significance of the difference.
    """

    low: float
    beyond: float
    modes: tuple[int, ...]
    sigma: float


def missed_modes(evaluator: Evaluator, found: Fit, bands: ModeBands) -> Missed | None:
    """The modes beyond the first four that are met clearly worse than those; None without such modes.

    Args:
        evaluator: records that were fitted.
        found: the fit.
        bands: of the modes.
    """
    if bands.edge is None:
        return None
    ends = np.cumsum([0, *(target.n_data for target in evaluator.targets)]).tolist()
    spectra = [
        (frequency_of(target), found.residual[start:end])
        for target, start, end in zip(evaluator.targets, ends[:-1], ends[1:], strict=True)
        if isinstance(target, TimeTarget | FrfTarget)
    ]
    frequency, residual = (np.concatenate(rows) for rows in zip(*spectra, strict=True))
    low = frequency <= bands.edge
    worse, inside = [], np.zeros(len(low), dtype=bool)
    for mode in range(LOW_MODES, len(bands.natural_freqs)):
        band = (frequency > bands.edges[mode]) & (frequency <= bands.edges[mode + 1])
        if band.any() and _rms(residual, band) > CLEARLY * _rms(residual, low):
            worse.append(mode + 1)
            inside |= band
    if not worse or not low.any():
        return None
    counts = int(low.sum() / found.repeats), int(inside.sum() / found.repeats)
    ratios = _rms(residual, low), _rms(residual, inside)
    return Missed(ratios[0], ratios[1], tuple(worse), clearly_larger(ratios[1], counts[1], ratios[0], counts[0]))


def clearly_larger(ratio: float, n: int, other: float, n_other: int) -> float:
    """Standard deviations by which a residual over noise stands above ``CLEARLY`` times another.

    The logarithm of a mean of n squares has the variance 2 / n.

    Args:
        ratio: of the one.
        n: its data that speak.
        other: the other.
        n_other: its data that speak.
    """
    least = 1e-3
    apart = 2.0 * log(max(ratio, least) / (CLEARLY * max(other, least)))
    return apart / sqrt(2.0 / max(n, 1) + 2.0 / max(n_other, 1))


def _rms(residual: FloatArray, mask: BoolArray) -> float:
    return float(np.sqrt(np.mean(residual[mask] ** 2))) if mask.any() else 0.0
