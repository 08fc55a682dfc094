"""What a recorder heard of the motion before a record's first sample, of which a model that begins there knows nothing.

The model continues displacements and velocities by their odd reflection, so a motion that was under way bends the other
way before the first sample; an acceleration, the derivative of such a velocity, gets a kink there. What a recorder's
filter makes of bend and kink beyond its pass band is not what it made of the truth, and its answer to an impulse tells
how much of that reaches later samples. Bend and kink are taken where they are largest early in the record.
"""

from math import pi

import numpy as np

from identification.evaluate import AHEAD, LEAST_NOISE
from identification.noise import Noise
from models.arrays import FloatArray
from models.band_limit import PAD, PASS_EDGE, record_channels
from models.drive import ORDER
from models.linear import ORDER_READ
from models.plant import Plant
from models.record import Record


def unjudged_of(record: Record, noise: Noise, plant: Plant) -> int:
    """Samples at the start of a record that begins in motion for which the recorder heard too much of what was before.

    Args:
        record: measured; one that begins at rest has none.
        noise: of its channels.
        plant: with the sensors and the excitation.
    """
    if not record.moving_start:
        return 0
    read = {sensor.name: ORDER_READ[sensor.quantity] for sensor in plant.sensors}
    orders = np.array([read[name] for name in record.sensors])
    longest = min(PAD, record.n_samples // 4)
    early = record.responses[:, : longest + 2]
    kink = 2.0 * np.abs(np.diff(early, 1)).max(axis=1) / EDGE
    bend = 2.0 * np.abs(np.diff(early, 2)).max(axis=1) / EDGE**2
    quiet = np.maximum(noise.sensors, LEAST_NOISE * record.responses.std(axis=1))
    heard = np.where(orders == ACCELERATION, kink, bend) / np.maximum(quiet, np.finfo(float).tiny)
    added = np.cumsum((TAIL[:longest] * float(heard.max()))[::-1] ** 2)[::-1]
    n = int(np.count_nonzero(added > HEARD * min(record.n_samples, LONGEST)))
    driven = None if plant.excitation is None else ORDER.get(plant.excitation.quantity)
    raised = record.excitation is not None and driven is not None and bool(np.any(orders > driven))
    return max(n, AHEAD) if raised else n  # a base read as its own derivative has the edge of that besides


ACCELERATION = ORDER_READ["acceleration"]

HEARD, LONGEST = 0.03, 2048
"""Share of a channel's chi-square that what was before may add, of a record of so many samples at most."""

EDGE = 2.0 * pi * PASS_EDGE
"""Change of a motion of size one from sample to sample at the edge of the pass band."""


def _tail() -> FloatArray:
    """(PAD,) root of the sum of squares of the recorder's answer to an impulse, from so many samples after it on."""
    impulse = np.zeros((1, 4 * PAD))
    impulse[0, 2 * PAD] = 1.0
    after = record_channels(impulse, 1, 4 * PAD, 1.0)[0, 2 * PAD :]
    return np.asarray(np.sqrt(np.cumsum(after[::-1] ** 2)[::-1])[:PAD])


TAIL = _tail()
