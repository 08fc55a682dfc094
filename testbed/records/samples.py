"""What no record may contain: samples that are no numbers, channels that were clipped or are no vector."""

import numpy as np

from models.arrays import AnyArray, FloatArray
from models.errors import InputError
from models.record import is_dead

LARGEST = 1e30
"""In any unit: nothing measures more."""

CLIPPED_RUN, CLIPPED_RUNS = 3, 2
"""At least so many runs of at least so many samples exactly at the extremes."""

LEVELS = 8
"""A run that has fallen by up to so many levels of the converter half its length further on is the flat top of a smooth
signal: a parabola that stays within one level over a run falls by four there, or six beside runs of few samples."""

NEIGHBOURS = 50
"""Values next to an extreme among which the converter's level is looked for."""


def checked(data: AnyArray, where: str) -> FloatArray:
    """The samples as (N,) doubles.

    Args:
        data: as the file holds them.
        where: file and channel, for errors.

    Raises:
        InputError: not one real vector, a NaN or infinite sample, a clipped channel.
    """
    if data.ndim != 1 or data.dtype.kind not in "biuf":
        size = " x ".join(str(n) for n in data.shape) or "one value"
        kind = "complex" if data.dtype.kind == "c" else "real" if data.dtype.kind in "biuf" else "no number"
        raise InputError(
            f"{where} is {size}, {kind}", "a channel is one vector of real samples", "store each channel by itself"
        )
    samples = data.astype(float)
    bad = np.flatnonzero(~(np.abs(samples) < LARGEST))
    if bad.size:
        raise InputError(
            f"{where}, sample {bad[0]} is {samples[bad[0]]} ({bad.size} of {samples.size} samples are like it)",
            "all samples are finite numbers that something can have measured",
            "repair the channel, cut the record, or leave a sensor out with --without",
        )
    clipped_at = first_clipped(samples)
    if clipped_at is not None:
        raise InputError(
            f"{where} is clipped: it stays at exactly {samples[clipped_at]:g} again and again, first at sample "
            f"{clipped_at}",
            "a channel stays within the range of its amplifier",
            "measure again with a lower gain or level, or leave a sensor out with --without",
        )
    return samples


def first_clipped(samples: FloatArray) -> int | None:
    """The first sample of the first clipped run, or None.

    A channel at rest is no clipped one, even where rest is its extreme; nor is the flat top that a converter makes of a
    slow signal, which falls off gently while a clipped run breaks off.
    """
    if samples.size < CLIPPED_RUN or is_dead(samples):
        return None
    rest = (0.0, float(samples[0]), float(np.median(samples)))
    levels = np.unique(samples)
    starts: list[int] = []
    for extreme, neighbours in ((levels[-1], levels[-NEIGHBOURS:]), (levels[0], levels[:NEIGHBOURS])):
        if extreme in rest:
            continue
        first, last = _runs(samples == extreme)
        long = last - first + 1 >= CLIPPED_RUN
        first, last = first[long], last[long]
        if first.size and _break_off(samples, first, last) > LEVELS * np.diff(neighbours).min():
            starts.extend(first)
    return int(min(starts)) if len(starts) >= CLIPPED_RUNS else None


def _runs(mask: AnyArray) -> tuple[AnyArray, AnyArray]:
    """First and last index of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return edges[::2], edges[1::2] - 1


def _break_off(samples: FloatArray, first: AnyArray, last: AnyArray) -> float:
    """By how much, in the median, the signal is off the extreme half a run before and after each run."""
    away = np.maximum(1, (last - first + 1) // 2)
    before, after = first - away, last + away
    outside = np.concatenate([before[before >= 0], after[after < samples.size]])
    return float(np.median(np.abs(samples[outside] - samples[first[0]]))) if outside.size else 0.0
