"""A resonance of a best linear approximation: its natural frequency and damping, to compare between levels."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from identification.budget.realisations import Level, comparable
from models.arrays import ComplexArray, FloatArray

PROMINENCE_DB = 6.0
"""Height of a peak over its feet, below which it is not looked at."""

HALF_WIDTH = 6
"""Excited lines to each side of a peak to which a mode is fitted."""

ROUNDS = 6
"""Of reweighting the equation error to that of the response."""

UNTOLD = 1.0 / 3.0
"""Relative deviation of a resonance's damping from which that is not told: impacts leave spikes in a best linear
approximation that are no modes."""

MOST_MODES = 6

FURTHEST = 0.15
"""Relative change of frequency within which a resonance is looked for at another level."""


@dataclass(frozen=True)
class Resonance:
    """A mode as one level shows it, with standard deviations."""

    natural_freq: float
    natural_freq_std: float
    damping_ratio: float
    damping_ratio_std: float


def resonances(level: Level) -> tuple[Resonance, ...]:
    """The strongest resonances, by frequency.

    Args:
        level: its best linear approximation.
    """
    power = np.abs(level.bla) ** 2
    together = 10.0 * np.log10(np.sum(power / power.mean(axis=1, keepdims=True), axis=0))
    peaks, about = find_peaks(together, prominence=PROMINENCE_DB)
    strongest = np.sort(peaks[np.argsort(-about["prominences"])[:MOST_MODES]])
    found = [_fitted(level, int(peak)) for peak in strongest]
    return tuple(mode for mode in found if mode is not None)


def _fitted(level: Level, peak: int) -> Resonance | None:
    """One pole, common to the sensors, beside a line of its own for each: (jw - pole) G = a + b jw."""
    lines = slice(max(0, peak - HALF_WIDTH), peak + HALF_WIDTH + 1)
    s, values, variance = 2j * np.pi * level.frequency[lines], level.bla[:, lines], level.variance[:, lines]
    if len(s) < HALF_WIDTH:
        return None
    centre = 2j * np.pi * level.frequency[peak]
    spread = float(np.ptp(level.frequency[lines])) * 2.0 * np.pi
    pole: complex = centre - 0.01 * abs(centre)
    variance = np.maximum(variance, 1e-20 * np.mean(np.abs(values) ** 2))
    base = np.stack([np.ones_like(s), (s - centre) / spread], axis=1)
    square = residual = 0.0
    for _ in range(ROUNDS):
        products = 0.0j
        square = residual = 0.0
        for row, spoilt in zip(values, variance, strict=True):
            weight = 1.0 / (np.sqrt(spoilt) * np.abs(s - pole))
            q, _ = np.linalg.qr(weight[:, None] * base)
            left, right = weight * row, weight * row * (s - centre)
            left, right = left - q @ (q.conj().T @ left), right - q @ (q.conj().T @ right)
            products += np.vdot(left, right)
            square += float(np.sum(np.abs(left) ** 2))
            residual += float(np.sum(np.abs(right) ** 2))
        shift = products / max(square, np.finfo(float).tiny)
        pole = centre + shift
        residual -= float(abs(products) ** 2) / max(square, np.finfo(float).tiny)
    if pole.real >= 0.0 or abs(pole.imag - centre.imag) > 0.5 * spread:
        return None
    freedom = max(1.0, values.size - 2.0 * len(values) - 1.0)
    # Of a complex number with this variance half lies in its real part; what one mode misses counts as noise.
    std = float(np.sqrt(0.5 * max(1.0, residual / freedom) / max(square, np.finfo(float).tiny)))
    if std > UNTOLD * -pole.real:
        return None
    size = abs(pole)
    return Resonance(size / (2.0 * np.pi), std / (2.0 * np.pi), -pole.real / size, std / size)


@dataclass(frozen=True, eq=False)
class LevelChange:
    """How the best linear approximation differs between two levels.

    Attributes:
        low, high: rms of their excitations.
        frequency: (L,) Hz, lines that both excite.
        change: (n, L) high minus low.
        variance: (n, L) of it, as far as it is known.
        scatter_known: whether that holds the stochastic distortion; if not, a change may be that alone.
        modes: resonances found at both.
    """

    low: Level
    high: Level
    frequency: FloatArray
    change: ComplexArray
    variance: FloatArray
    scatter_known: bool
    modes: tuple[tuple[Resonance, Resonance], ...]


def level_changes(levels: Sequence[Level]) -> tuple[LevelChange, ...]:
    """The lowest level beside each higher one that drives the same rig at the same place.

    Args:
        levels: from the lowest up.
    """
    changes = []
    for number, high in enumerate(levels):
        low = next((one for one in levels[:number] if comparable(one.splits[0], high.splits[0])), None)
        if low is not None:
            change = _change(low, high)
            if len(change.frequency) > 0:
                changes.append(change)
    return tuple(changes)


def _change(low: Level, high: Level) -> LevelChange:
    after = np.searchsorted(high.frequency, low.frequency * (1.0 - SAME_LINE))
    near = np.append(high.frequency, np.inf)[after]
    first = np.flatnonzero(np.isclose(low.frequency, near, rtol=SAME_LINE, atol=0.0))
    second = after[first]
    return LevelChange(
        low,
        high,
        low.frequency[first],
        high.bla[:, second] - low.bla[:, first],
        high.variance[:, second] + low.variance[:, first],
        low.scatter_known and high.scatter_known,
        _paired(resonances(low), resonances(high)),
    )


SAME_LINE = 1e-9
"""Share of a frequency within which two records' lines are one."""


def _paired(low: Sequence[Resonance], high: Sequence[Resonance]) -> tuple[tuple[Resonance, Resonance], ...]:
    pairs = []
    for mode in low:
        near = sorted(high, key=lambda other: abs(other.natural_freq - mode.natural_freq))
        if near and abs(near[0].natural_freq / mode.natural_freq - 1.0) < FURTHEST:
            pairs.append((mode, near[0]))
    return tuple(pairs)
