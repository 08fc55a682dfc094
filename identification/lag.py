"""By how much a channel is later than the model's: to a delay of more than a turn no slope leads."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import fft

from models.arrays import FloatArray

LONGEST = 0.25
"""Share of the samples at hand by which a channel may be late."""

ALIKE, NEARER = 0.5, 0.1
"""Correlation with the model's channel of so much earlier, at least, and by how much it exceeds that without a lag."""

FINER = 8
"""Lags a sample: between two samples the correlation is lower than at another turn of the motion that falls on one."""


@dataclass(frozen=True, order=True)
class Lag:
    """How late a channel is; of several the greatest is that of the channel which is most like the model's.

    Attributes:
        alike: largest correlation with the model's channel of so much earlier; 0 where it hardly exceeds that of now.
        seconds: by how much it is late, s; 0 where nothing is told.
    """

    alike: float = 0.0
    seconds: float = 0.0


def lag(pairs: Sequence[tuple[FloatArray, FloatArray, float]]) -> Lag:
    """By how much a channel is late, as the record tells it in which it is most like the model's.

    Args:
        pairs: of each record (N,) measured, (N,) the same channel as predicted, and the sampling rate, Hz.
    """
    return max((_lag_in(*pair) for pair in pairs), default=Lag())


def _lag_in(measured: FloatArray, model: FloatArray, fs: float) -> Lag:
    here, there = measured - measured.mean(), model - model.mean()
    size, longest = float(np.sqrt(here @ here * (there @ there))), max(1, int(LONGEST * len(here)))
    if not size > 0.0:
        return Lag()
    padded = fft.next_fast_len(len(here) + longest, real=True)
    crossed = fft.rfft(here, padded) * np.conj(fft.rfft(there, padded))
    along = fft.irfft(crossed, FINER * padded)[: FINER * longest] * (FINER / size)
    at = int(np.argmax(along))
    told = along[at] > max(ALIKE, along[0] + NEARER)
    return Lag(float(along[at]), at / (FINER * fs)) if told else Lag()
