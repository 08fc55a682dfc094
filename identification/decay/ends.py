"""What a transform takes the signal for beyond the ends of its record."""

from collections.abc import Callable

import numpy as np

from identification.signals.extend import extend
from models.arrays import FloatArray
from models.errors import InputError

TAPERED_OVER = 16
"""Reaches over which a predicted signal fades out: within the reach itself the fading is hardly felt."""


def continued(signals: FloatArray, reach: int, ends: str) -> tuple[FloatArray, FloatArray]:
    """What precedes signals, and what follows them.

    Args:
        signals: (..., N) channels of one record.
        reach: samples asked for on each side.
        ends: a name in ``ENDS``.

    Raises:
        InputError: a name that is not in ``ENDS``.

    Returns:
        (..., reach) before and (..., reach) after.
    """
    if ends not in ENDS:
        raise InputError(f"ends = {ends!r}", f"a signal is continued by {', '.join(ENDS)}", "choose one of them")
    return ENDS[ends](signals, reach)


def silent(signals: FloatArray, reach: int) -> tuple[FloatArray, FloatArray]:
    """Zeros."""
    nothing = np.zeros((*signals.shape[:-1], reach))
    return nothing, nothing


def mirrored(signals: FloatArray, reach: int) -> tuple[FloatArray, FloatArray]:
    """The signal backwards, the samples at the ends not repeated."""
    return _sides(np.pad(signals, [(0, 0)] * (signals.ndim - 1) + [(reach, reach)], mode="reflect"), reach)


def predicted(signals: FloatArray, reach: int) -> tuple[FloatArray, FloatArray]:
    """The exponentials found near each end, carried on."""
    length = TAPERED_OVER * reach
    before, after = _sides(extend(signals, length).signals, length)
    return before[..., length - reach :], after[..., :reach]


def _sides(whole: FloatArray, length: int) -> tuple[FloatArray, FloatArray]:
    return whole[..., :length], whole[..., whole.shape[-1] - length :]


ENDS: dict[str, Callable[[FloatArray, int], tuple[FloatArray, FloatArray]]] = {
    "zero": silent,
    "mirror": mirrored,
    "predicted": predicted,
}
"""The ways to continue signals (..., N) by a number of samples: what precedes them, and what follows."""
