"""Where the error falls that the named effects take away: frequencies, channels, time and level."""

import numpy as np

from identification.result import Diagnosis, ErrorMap
from models.arrays import FloatArray
from testbed.quantities import unit_of
from testbed.report.words import number, percent

MOST = 0.7
"""Share of the fall that a range of frequencies is told for: the narrowest that holds so much."""

NARROW = 0.5
"""Share of the bands up to which such a range is worth telling."""

ONE_CHANNEL = 0.5
"""Share of the fall from which it is one channel's."""

UNEVEN = 1.5
"""Ratio of the falls of a record's halves, and of the errors at two levels, from which they are told apart."""


def where_it_falls(diagnosis: Diagnosis) -> str:
    """Where the calibrated model's error falls with the effects that were named; empty where it falls nowhere.

    Args:
        diagnosis: finished.
    """
    pairs = list(zip(diagnosis.where, diagnosis.updated_maps, strict=False))
    falls = [float(_fall(before.by_frequency, after.by_frequency).sum()) for before, after in pairs]
    if not falls or max(falls) <= 0.0:
        return ""
    before, after = pairs[int(np.argmax(falls))]
    sensors = next(row.record.sensors for row in diagnosis.final.score.records if row.record.name == before.record)
    where = f"{_frequencies(before, after)}, {_channels(before, after, sensors)}{_times(before, after)}"
    return f"In {before.record} most of the error that goes lies {where}. {_levels(diagnosis, pairs)}".rstrip()


def _fall(before: FloatArray, after: FloatArray) -> FloatArray:
    """(n_sensors, n) fall of the squared error, where it falls."""
    return np.maximum(before**2 - after**2, 0.0)


def _frequencies(before: ErrorMap, after: ErrorMap) -> str:
    fall = _fall(before.by_frequency, after.by_frequency).sum(axis=0)
    first, last = narrowest(fall, MOST)
    if last - first > NARROW * len(fall):
        return "over the whole band"
    middles = np.sqrt(before.frequency[1:] * before.frequency[:-1])
    low = middles[first - 1] if first > 0 else before.frequency[0]
    high = middles[last - 1] if last < len(fall) else before.frequency[-1]
    return f"between {low:.3g} and {high:.3g} Hz"


def narrowest(parts: FloatArray, share: float) -> tuple[int, int]:
    """First and one past the last of the fewest neighbouring parts that hold so much of their sum.

    Args:
        parts: (n,) not negative.
        share: of the sum.
    """
    sums = np.concatenate([[0.0], np.cumsum(parts)])
    ends = np.searchsorted(sums, sums[:-1] + share * sums[-1])
    fits = [(int(end) - first, first, int(end)) for first, end in enumerate(ends) if end < len(sums)]
    _, first, end = min(fits)
    return first, end


def _channels(before: ErrorMap, after: ErrorMap, sensors: tuple[str, ...]) -> str:
    fall = _fall(before.by_frequency, after.by_frequency).sum(axis=1)
    most = int(np.argmax(fall))
    share = float(fall[most] / fall.sum())
    if share >= ONE_CHANNEL and len(sensors) > 1:
        return f"{percent(share)} of it in {sensors[most]}"
    return f"spread over the channels, {sensors[most]} first"


def _times(before: ErrorMap, after: ErrorMap) -> str:
    fall = _fall(before.by_time, after.by_time).sum(axis=0)
    half = len(fall) // 2
    early, late = float(fall[:half].sum()), float(fall[len(fall) - half :].sum())
    if late > UNEVEN * early:
        return ", and more of it late than early"
    if early > UNEVEN * late:
        return ", and more of it early than late"
    return ""


def _levels(diagnosis: Diagnosis, pairs: list[tuple[ErrorMap, ErrorMap]]) -> str:
    """How the calibrated model's error, as a share of the motion, goes with the level of the excitation."""
    excitation = diagnosis.final.hypothesis.rig.excitation
    driven = sorted((each for each, _ in pairs if each.level > 0.0), key=lambda each: each.level)
    if excitation is None or len(driven) < 2 or driven[-1].level < UNEVEN * driven[0].level:
        return ""
    low, high = driven[0], driven[-1]
    errors = [float(np.sqrt(np.mean(np.sum(each.by_frequency**2, axis=1)))) for each in (low, high)]
    goes = "hardly changes"
    if errors[1] > UNEVEN * errors[0]:
        goes = "grows"
    elif errors[0] > UNEVEN * errors[1]:
        goes = "falls"
    unit = unit_of(excitation.quantity)
    return (
        f"As a share of the motion it {goes} with the level: {percent(errors[0])} at {number(low.level)} {unit} rms, "
        f"{percent(errors[1])} at {number(high.level)}."
    )
