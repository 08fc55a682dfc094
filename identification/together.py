"""One factor between all measured channels and the model's: a unit or a force sensor, since no structure does that."""

import numpy as np

from identification.result import Score
from models.arrays import FloatArray

PLAINLY = 2.5
"""Factor from which on all channels together are told: sleeves that open or close change motion by less."""

ALIKE = 1.6
"""Largest factor of a channel over the median of all, either way, with which they still are one factor."""

TURNED = -0.5
"""Correlation of the channels with the model's in the mean, below which all are told to be upside down if none is
above 0."""

LEAST_CHANNELS = 2

NAMED_WITHIN = 1.35
"""Factor within which a unit is named: motion between walls is not quite in proportion to its force."""

UNITS = {
    9.80665: "g, or kilograms-force",
    1e3: "thousands, as kN for N or mm for m",
    4.44822: "pounds-force",
    39.3701: "inches",
    180.0 / np.pi: "degrees",
}


def loudness(measured: FloatArray, model: FloatArray) -> FloatArray:
    """(n,) rms of each channel over the model's, without the channels of which either does not move.

    Args:
        measured: (n, N) SI.
        model: (n, N) the same channels as predicted.
    """
    here, there = measured.std(axis=1), model.std(axis=1)
    moves = (here > 0.0) & (there > 0.0)
    return np.asarray(here[moves] / there[moves])


def wholly_off(score: Score) -> tuple[str, ...]:
    """A sentence for each time record all of whose channels differ from the model's by one factor, or by their sign.

    Where no excitation was measured, the model only decays from the state that it begins in, which is fitted.

    Args:
        score: of the model as its owner gave it.
    """
    driven = [row for row in score.records if row.record.excitation is not None]
    seen = [(row.record.name, off_by(row.record.responses, row.predicted)) for row in driven]
    return tuple(
        f"{name}: {words}; a structure hardly does that to all alike: check the units and the sign of the force and of "
        "the sensors, and whether the record is of this rig"
        for name, words in seen
        if words
    )


def off_by(measured: FloatArray, model: FloatArray) -> str:
    """What all channels of a record have in common beside the model's, in words; nothing where they are not off alike.

    Args:
        measured: (n, N) SI.
        model: (n, N) the same channels as predicted.
    """
    ratios = loudness(measured, model)
    if len(ratios) < LEAST_CHANNELS:
        return ""
    factor, lowest, highest = float(np.median(ratios)), float(ratios.min()), float(ratios.max())
    told = []
    if max(factor, 1.0 / factor) > PLAINLY and highest < ALIKE * factor and lowest > factor / ALIKE:
        told.append(f"{lowest:.3g} to {highest:.3g} times the model's{_unit(factor)}")
    alike = _correlation(measured, model)
    if alike.mean() < TURNED and alike.max() < 0.0:
        told.append("upside down, as if the force sensor were reversed")
    return f"all {len(ratios)} channels are {' and '.join(told)}" if told else ""


def _unit(factor: float) -> str:
    """The unit that the factor, or its inverse, is near."""
    size = max(factor, 1.0 / factor)
    name, value = min(((name, value) for value, name in UNITS.items()), key=lambda unit: abs(np.log(size / unit[1])))
    return f", near {value:.4g} or its inverse ({name})" if abs(np.log(size / value)) < np.log(NAMED_WITHIN) else ""


def _correlation(measured: FloatArray, model: FloatArray) -> FloatArray:
    """(n,) of each channel with the model's; 0 where either does not move."""
    here, there = (each - each.mean(axis=1, keepdims=True) for each in (measured, model))
    size = np.sqrt(np.sum(here**2, axis=1) * np.sum(there**2, axis=1))
    return np.asarray(np.divide(np.sum(here * there, axis=1), size, out=np.zeros(len(size)), where=size > 0.0))
