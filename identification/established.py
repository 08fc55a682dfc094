"""Whether the size of a found effect is known, with intervals that know what each mode, channel and record says.

An effect whose size changes beyond all bounds when one mode or one record is left out is no finding: that mode or
record has something of its own, and the effect was bent to it.
"""

from math import exp, inf, log

import numpy as np

from identification.fit import Fit
from identification.hypothesis import EffectUnknown

LEAST_DEVIATIONS = 0.5
"""Between an effect's size and none, its other numbers and its place held: a size not known to a factor of three. Two
records that tell a friction differently leave 1.2, a mass that stood on one blow alone left 0.1."""

NOT_ESTABLISHED = "its size hangs on one mode, channel or record, and the others do not tell it from nothing"
"""Why such an effect is not named."""


def unestablished(found: Fit) -> int | None:
    """Number of the first effect whose size cannot be told from none; None where all can.

    Effects without a value at which they are not there (another law in a contact) have no size.

    Args:
        found: the last fit, with its widened covariance.
    """
    by_misfit = found.std() / np.sqrt(np.diag(found.covariance))
    for index in range(len(found.hypothesis.effects)):
        own = [i for i, unknown in enumerate(found.unknowns) if getattr(unknown, "effect", None) == index]
        if not own:
            continue
        # Numbers of one law trade off against each other and against the place: together they may be known well.
        std = by_misfit[own] / np.sqrt(np.diag(np.linalg.inv(found.covariance[np.ix_(own, own)])))
        sizes = [
            _deviations(found, unknown, float(one))
            for i, one in zip(own, std, strict=True)
            if isinstance(unknown := found.unknowns[i], EffectUnknown) and unknown.about.neutral is not None
        ]
        if sizes and max(sizes) < LEAST_DEVIATIONS:
            return index
    return None


def _deviations(found: Fit, unknown: EffectUnknown, std: float) -> float:
    """Standard deviations between a number and the value at which the effect is not there.

    Args:
        found: with the number.
        unknown: the number.
        std: in its own coordinate.
    """
    about, value = unknown.about, float(found.hypothesis.effects[unknown.effect].fitted_values()[unknown.entry])
    neutral = inf if about.neutral is None else about.neutral
    if about.scale == "linear":
        return abs(value - neutral) / (unknown.unit * std)
    spread = about.spread * std
    if 0.0 < neutral < inf:
        return abs(log(value / neutral)) / spread
    # From nothing or from infinity: half of a size that is known to a factor e^spread, on either side.
    return 1.0 / (exp(min(spread, LARGEST_SPREAD)) - 1.0)


LARGEST_SPREAD = 50.0
"""e-folds beyond which nothing changes."""
