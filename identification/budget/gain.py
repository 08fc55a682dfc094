"""A model's error, split: what a perfect model could still remove, and where no linear model could."""

from dataclasses import dataclass

import numpy as np

from identification.budget.periods import spectra_of
from identification.budget.pooled import members
from identification.budget.split import Split
from models.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Gain:
    """What a model misses of one record, mean squares in the sensor's unit squared.

    Attributes:
        error: (n, n_bands) of measured minus predicted, over the periods used.
        noise: (n, n_bands) of it that a perfect model leaves too, the excitation's noise carried through it included.
        possible: (n, n_bands) of it that a perfect model would remove: what of it repeats, at least 0.
        nonlinear: (n, n_bands) of that on lines that were not excited, where no linear model can answer.
    """

    error: FloatArray
    noise: FloatArray
    possible: FloatArray
    nonlinear: FloatArray


def gain_of(split: Split, predicted: FloatArray) -> Gain:
    """Split what a model misses.

    Args:
        split: of the record.
        predicted: (n, N) responses to its measured excitation, SI.
    """
    missed = spectra_of(split.record.responses - predicted, split.periods)
    # Periods that were averaged in blocks hide what differs between them: that is noise, and is known.
    block, repeats = split.periods.block, missed.mean(axis=0)
    # Beyond the excited range only the model knows what it makes of the excitation's noise; it differs by the period.
    differs = np.sum(np.abs(missed - repeats) ** 2, axis=0) / (len(missed) - 1) * block
    noise = np.maximum(split.lines.noise, differs)
    steady = np.abs(repeats) ** 2 - noise / split.n_periods
    error, alone = np.abs(repeats) ** 2 + differs * (1.0 - 1.0 / split.n_periods), split.told * steady
    bands = list(members(split.periods.frequency, split.bands))
    parts = [np.stack([part[:, band].sum(axis=1) for band in bands], axis=1) for part in (error, noise, steady, alone)]
    total, floor, possible, nonlinear = parts
    possible = np.maximum(possible, 0.0)
    return Gain(total, floor, possible, np.clip(nonlinear, 0.0, possible))
