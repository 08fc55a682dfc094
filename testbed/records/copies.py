"""Whether two records are one and the same test, whatever files they came from."""

import numpy as np

from models.arrays import AnyArray
from models.record import AnyRecord, FrfRecord, ModeShapeRecord, Record

SAME = 1e-4
"""Difference as a share of a channel's rms, below which two tests are one: five digits print samples that well, and no
sensor repeats a test so closely (80 dB)."""

SAME_RATE = 1e-3
"""Share by which the rates of two copies differ, at most, after one was printed with few digits."""


def is_same_test(one: AnyRecord, other: AnyRecord) -> bool:
    """Whether all sensors that both records hold read the same, as far as the shorter one goes.

    Args:
        one: a record.
        other: another one.
    """
    shared = [name for name in one.sensors if name in other.sensors]
    if type(one) is not type(other) or not shared or not _on_one_base(one, other):
        return False
    return all(_is_same(_samples(one, name), _samples(other, name)) for name in shared)


def _on_one_base(one: AnyRecord, other: AnyRecord) -> bool:
    if isinstance(one, Record) and isinstance(other, Record):
        return abs(one.fs - other.fs) <= SAME_RATE * one.fs
    if isinstance(one, FrfRecord) and isinstance(other, FrfRecord):
        return _is_same(one.frequency, other.frequency)
    if isinstance(one, ModeShapeRecord) and isinstance(other, ModeShapeRecord):
        return len(one.natural_freqs) == len(other.natural_freqs) and _is_same(one.natural_freqs, other.natural_freqs)
    return False


def _samples(record: AnyRecord, name: str) -> AnyArray:
    """(N,) samples, values of the FRF, or the shapes at one sensor."""
    row = record.sensors.index(name)
    if isinstance(record, Record):
        return np.asarray(record.responses[row])
    return np.asarray(record.values[row] if isinstance(record, FrfRecord) else record.shapes[:, row])


def _is_same(one: AnyArray, other: AnyArray) -> bool:
    n = min(len(one), len(other))
    off, whole = np.linalg.norm(one[:n] - other[:n]), np.linalg.norm(one[:n])
    return bool(off <= SAME * whole)
