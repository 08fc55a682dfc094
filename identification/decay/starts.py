"""How far a mode's pole moves when the decay's first samples are left out, or from blow to blow.

Two estimates of which one uses a part of the other's samples differ with the difference of their variances (Hausman).
Where they differ by more, the modes fitted do not describe the beginning, be it impacts, modes that are missing or
damping that changes, and an interval that only noise makes is too narrow by that. docs/theory.md, section 9.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2, norm

from identification.decay.poles import Poles, fit_poles
from models.arrays import FloatArray
from models.errors import InputError

FALLEN = (0.5, 1.0, 2.0)
"""Np that a mode falls by before the later starts."""

LEAST_LEFT = 0.5
"""Share of a decay that a later start leaves."""

DROWNED = 8.0
"""Np by which another mode falls until it is left out of a later fit."""

BEYOND = 3.0
"""Standard deviations from which a difference is not chance."""


def widened_by_starts(signals: FloatArray, fs: float, poles: Poles) -> Poles:
    """The poles with a covariance that holds what later starts change beyond chance.

    Args:
        signals: (n_channels, N).
        fs: Hz.
        poles: fitted from the first sample on.

    Source: Hausman, Econometrica 46 (1978) 1251.
    """
    own = np.diag(poles.covariance)
    moved = np.zeros_like(own)
    for m, pole in enumerate(poles.values):
        both = [m, m + len(poles.values)]
        for fallen in FALLEN if pole.real < 0.0 else ():
            skipped = int(np.ceil(-fallen / pole.real * fs))
            if skipped > (1.0 - LEAST_LEFT) * signals.shape[1]:
                break
            late = _begun_later(signals[:, skipped:], fs, poles, skipped)
            if late is None:
                break
            there = int(np.argmin(np.abs(late.values - pole)))
            change = late.values[there] - pole
            variances = np.diag(late.covariance)[[there, there + len(late.values)]]
            chance = np.sqrt(np.maximum(variances - own[both], own[both]))
            change = np.abs([change.real, change.imag])
            moved[both] = np.maximum(moved[both], np.where(change > BEYOND * chance, change, 0.0))
    return _with_errors(poles, moved)


def widened_by_decays(decays: Sequence[Poles]) -> list[Poles]:
    """The poles of several decays, with covariances that hold their scatter where it is more than theirs tell.

    Args:
        decays: the same modes in each.
    """
    if len(decays) < 2:
        return list(decays)
    values = np.array([np.concatenate([poles.values.real, poles.values.imag]) for poles in decays])
    own = np.mean([np.diag(poles.covariance) for poles in decays], axis=0)
    spread = np.var(values, axis=0, ddof=1)
    chance = chi2.isf(2.0 * norm.sf(BEYOND), len(decays) - 1) / (len(decays) - 1)
    scatter = np.sqrt(np.where(spread > chance * own, spread - own, 0.0))
    return [_with_errors(poles, scatter) for poles in decays]


def _begun_later(signals: FloatArray, fs: float, poles: Poles, skipped: int) -> Poles | None:
    """The poles that still ring after so many samples, fitted to the rest; None where they cannot be."""
    heard = poles.values[-poles.values.real * skipped / fs < DROWNED]
    try:
        return fit_poles(signals, fs, heard)
    except InputError:
        return None


def _with_errors(poles: Poles, errors: FloatArray) -> Poles:
    """With further standard deviations, (2 n_modes,) of real, then imaginary parts, 1/s; correlations stay."""
    own = np.diag(poles.covariance)
    factor = np.sqrt(1.0 + errors**2 / np.maximum(own, np.finfo(float).tiny))
    return replace(poles, covariance=poles.covariance * np.outer(factor, factor))
