"""By how much a channel is later than the model's: to a delay of more than a turn no slope leads."""

from collections.abc import Sequence

import numpy as np
from scipy import fft

from models.arrays import FloatArray

LONGEST = 0.25
"""Share of the samples at hand by which a channel may be late."""

ALIKE, NEARER = 0.5, 0.1
"""Correlation with the model's channel of so much earlier, at least, and by how much it exceeds that without a lag."""

FINER = 8
"""Lags a sample: between two samples the correlation is lower than at another turn of the motion that falls on one."""


def lag(pairs: Sequence[tuple[FloatArray, FloatArray, float]]) -> float:
    """By how much a channel is late, s: of the records that tell it, by the one that is most like the model's; else 0.

    Args:
        pairs: of each record (N,) measured, (N,) the same channel as predicted, and the sampling rate, Hz.
    """
    return max((_lag_in(*pair) for pair in pairs), default=(0.0, 0.0))[1]


def _lag_in(measured: FloatArray, model: FloatArray, fs: float) -> tuple[float, float]:
    """The largest correlation at any lag, and that lag, s; both 0 where it hardly exceeds that at none."""
    here, there = measured - measured.mean(), model - model.mean()
    size, longest = float(np.sqrt(here @ here * (there @ there))), max(1, int(LONGEST * len(here)))
    if not size > 0.0:
        return 0.0, 0.0
    padded = fft.next_fast_len(len(here) + longest, real=True)
    crossed = fft.rfft(here, padded) * np.conj(fft.rfft(there, padded))
    along = fft.irfft(crossed, FINER * padded)[: FINER * longest] * (FINER / size)
    at = int(np.argmax(along))
    told = along[at] > max(ALIKE, along[0] + NEARER)
    return (float(along[at]), at / (FINER * fs)) if told else (0.0, 0.0)
