"""Channels that read one value throughout: left out of records at hand, as a reader leaves them out of files."""

from dataclasses import replace

import numpy as np

from models.errors import InputError
from models.record import AnyRecord, Record, is_dead


def without_silent(record: AnyRecord) -> AnyRecord:
    """A time record without its silent channels, each told among its findings; others as they are.

    Args:
        record: of any kind.

    Raises:
        InputError: no channel is left.
    """
    if not isinstance(record, Record):
        return record
    heard = np.array([not is_dead(samples) for samples in record.responses])
    if heard.all():
        return record
    if not heard.any():
        raise InputError(
            f"{record.name}: every channel reads one value throughout",
            "at least one sensor that moves, or shows its noise",
            "look at the sensors' cables and at the columns that were read",
        )
    names = [name for name, hears in zip(record.sensors, heard, strict=True) if not hears]
    return replace(
        record,
        sensors=tuple(name for name in record.sensors if name not in names),
        responses=record.responses[heard],
        findings=(*record.findings, *(f"{record.name}: channel {name} is dead; left out" for name in names)),
    )
