"""Records that do not repeat: the noise that they tell nevertheless, and the reason why they tell no more."""

from dataclasses import dataclass

import numpy as np

from identification.noise import estimate_noise
from models.arrays import FloatArray
from models.band_limit import SCORE_EDGE
from models.record import AnyRecord, Record

SHORTEST = 512
"""Samples from which on a record's noise is estimated."""


@dataclass(frozen=True, eq=False)
class Unsplit:
    """One record that cannot be split.

    Attributes:
        name: of the record.
        sensors: names.
        mean_square: (n,) of each sensor; None where the record holds no samples.
        noise: (n,) mean square below 0.35 fs; None where nothing tells it.
        method: how the noise was found.
        reason: why the rest cannot be told.
    """

    name: str
    sensors: tuple[str, ...]
    mean_square: FloatArray | None
    noise: FloatArray | None
    method: str
    reason: str


def unsplit(record: AnyRecord) -> Unsplit:
    """What a record tells whose excitation does not repeat, or that holds no samples.

    Args:
        record: any.
    """
    if not isinstance(record, Record):
        reason = "it holds averages of one level, in which distortion and time variation are mixed with the rest"
        return Unsplit(record.name, record.sensors, None, None, "", reason)
    power = np.mean(record.responses**2, axis=1)
    reason = "no excitation was measured" if record.excitation is None else "its excitation does not repeat"
    if record.n_samples < SHORTEST or not np.all(power > 0.0):
        return Unsplit(record.name, record.sensors, power, None, "", reason)
    noise = estimate_noise(record)
    return Unsplit(record.name, record.sensors, power, noise.sensors**2 * 2.0 * SCORE_EDGE, noise.method, reason)
