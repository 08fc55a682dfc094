"""Does a motion that nothing measured drives die away, as a free decay does?"""

from collections.abc import Sequence

import numpy as np

from models.arrays import FloatArray
from testbed.records.start import noise_rms

ABOVE_NOISE = 3.0
"""Times its noise, from which the last tenth of a channel still is motion."""

KEPT = 0.9
"""Rms of its second half over its first's from which a motion has not died away: chance parts the halves no further."""


def undying(responses: Sequence[FloatArray]) -> str | None:
    """That a motion does not die away, in words; None where it does, or where its end is lost in noise.

    Args:
        responses: (N,) of each channel.
    """
    heard = [samples for samples in responses if _is_heard(samples)]
    if not heard:
        return None
    ended = _growth(heard, 10)
    halved = _growth(heard, 2)
    if ended < 1.0 and halved < KEPT:
        return None
    part, growth = ("tenth", ended) if ended >= 1.0 else ("half", halved)
    return (
        f"the motion does not die away: in its last {part} it is {growth:.2g} times what it is in its first; a free "
        "decay falls, so something that was not measured drives it; record the excitation, or cut the record to what "
        "follows it"
    )


def _is_heard(samples: FloatArray) -> bool:
    last = np.array_split(samples, 10)[-1]
    return float(np.std(last)) > ABOVE_NOISE * noise_rms(samples)


def _growth(channels: Sequence[FloatArray], parts: int) -> float:
    """Rms of the last part over that of the first, each channel by its own rms."""
    first, last = 0.0, 0.0
    for samples in channels:
        pieces = np.array_split((samples - samples.mean()) / samples.std(), parts)
        first += float(np.mean(pieces[0] ** 2))
        last += float(np.mean(pieces[-1] ** 2))
    return float(np.sqrt(last / max(first, np.finfo(float).tiny)))
