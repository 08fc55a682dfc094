"""A channel whose label says another unit than its neighbours' and whose level says that it has theirs."""

from collections import Counter
from collections.abc import Mapping
from math import log

import numpy as np

from models.arrays import FloatArray
from models.rig import Rig
from testbed.records.plausibility import FEWEST_TO_COMPARE, least_motion
from testbed.records.recording import Tag
from testbed.records.units import label_factor


def odd_units(responses: Mapping[str, FloatArray], tags: Mapping[str, Tag], rig: Rig) -> list[str]:
    """A sentence for each channel whose level is nearer to that of its quantity's others in their unit than in its own.

    Args:
        responses: sensor -> (N,) samples, SI, none of them dead.
        tags: sensor -> the file's words for its channel.
        rig: where the sensors are, and what they measure.
    """
    told: list[str] = []
    for quantity in sorted({rig.sensor(name).quantity for name in responses}):
        names = [name for name in responses if rig.sensor(name).quantity == quantity]
        factors = {name: factor for name in names if (factor := label_factor(tags[name], quantity)) is not None}
        if len(factors) < FEWEST_TO_COMPARE:
            continue
        common, count = Counter(factors.values()).most_common(1)[0]
        if 2 * count > len(factors):
            told += _odd_ones(responses, tags, rig, factors, common)
    return told


def _odd_ones(
    responses: Mapping[str, FloatArray], tags: Mapping[str, Tag], rig: Rig, factors: Mapping[str, float], common: float
) -> list[str]:
    """Of one quantity; ``common`` is the factor that most of its channels have."""
    alike = [name for name, factor in factors.items() if factor == common]
    level = float(np.median([responses[name].std() for name in alike]))
    motion = least_motion(tuple(factors), rig)
    usual = float(np.median([motion[name] for name in alike]))
    told = []
    for name, factor in factors.items():
        ratio = float(responses[name].std()) / level
        at_least = motion[name] / usual
        if factor != common and _beyond(ratio, at_least) > _beyond(ratio * common / factor, at_least):
            own, others = tags[name].unit, tags[alike[0]].unit
            told.append(
                f'channel {name} is in "{own}", most others of its quantity in "{others}", and its rms is {ratio:.3g} '
                "times theirs; channels of one quantity mostly have one unit and one size; correct the label of "
                f'{name} if it is in "{others}" too'
            )
    return told


def _beyond(ratio: float, at_least: float) -> float:
    """How far a ratio of levels is, in logarithms, outside what lies between equal motion and the first mode's."""
    low, high = sorted((0.0, log(max(at_least, SMALLEST_SHARE))))
    return max(low - log(ratio), log(ratio) - high, 0.0)


SMALLEST_SHARE = 1e-6
"""Of the others' motion, in which a sensor at the clamp itself is taken to move."""
