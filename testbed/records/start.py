"""Does a record start at rest? A velocity tells it by its first sample, an acceleration by its integral."""

import numpy as np

from identification.noise import quiet_floor, silent_floor
from models.arrays import FloatArray
from models.rig import Rig
from testbed.records.plausibility import white_rms

AT_REST = 0.05
"""A displacement or velocity at rest begins below this share of its rms."""

MOVING = 0.18
"""A velocity integrated from accelerations moves from this share of its rms; how often that is mistaken is counted in
tests/testbed/records/test_records_start.py."""

PERIODS = 4
"""Periods of the first mode over which accelerations are integrated: longer, and noise drifts; shorter, and the mean of
a velocity is not 0."""

FEWEST = 16
"""Samples to integrate, whatever the rate."""

NOISE = 4.0
"""A first sample within so many standard deviations of the noise says nothing."""

WALK = 0.37
"""Standard deviation, at its start, of a random walk of unit length from which its line has been taken: sqrt(2/15)."""


def starts_moving(
    excitation: FloatArray | None, responses: dict[str, FloatArray], rig: Rig, fs: float, first_freq: float
) -> bool:
    """Whether the state at the first sample is other than rest.

    A force may act at once, and accelerations then jump with it; velocities cannot. They are integrated from
    accelerations, and since they have no mean over some periods, the integral knows where it began.

    Args:
        excitation: (N,) SI, or None for a free decay, which always moves.
        responses: sensor -> (N,) SI.
        rig: what the sensors measure.
        fs: sampling rate, Hz.
        first_freq: of the first mode, Hz; 0 where there is none.
    """
    if excitation is None or rig.excitation is None:
        return True
    if rig.excitation.quantity in ("base_velocity", "base_displacement") and _is_off_rest(excitation):
        return True
    accelerations = [samples for name, samples in responses.items() if rig.sensor(name).quantity == "acceleration"]
    others = [samples for name, samples in responses.items() if rig.sensor(name).quantity != "acceleration"]
    if any(_is_off_rest(samples) for samples in others):
        return True
    if not accelerations:
        return False
    length = len(excitation)
    if first_freq > 0:
        length = min(length, max(FEWEST, int(PERIODS * fs / first_freq)))
    shares = np.array([_initial_velocity(samples, length) for samples in accelerations])
    return bool(np.sqrt(np.mean(shares**2)) > MOVING)


def _is_off_rest(samples: FloatArray) -> bool:
    rms = float(np.sqrt(np.mean(samples**2)))
    return bool(abs(samples[0]) > max(AT_REST * rms, NOISE * white_rms(samples)))


def noise_rms(samples: FloatArray) -> float:
    """Standard deviation of the noise; a recorder that filters the noise too leaves none in its stopped band.

    Args:
        samples: (N,).
    """
    floors = (quiet_floor(samples).density, silent_floor(samples).density) if samples.size >= FEWEST_TO_HEAR else (0.0,)
    quiet = float(np.sqrt(min(floors)))
    return max(white_rms(samples), quiet if quiet < MOST_NOISE * float(np.std(samples)) else 0.0)


FEWEST_TO_HEAR = 256
"""Samples in whose quietest bands and moments noise can be heard."""

MOST_NOISE = 0.02
"""Share of a channel's rms above which its quietest bands and moments are taken for signal."""


def _initial_velocity(acceleration: FloatArray, length: int) -> float:
    """Velocity at the first sample as a share of its rms over the window, or of what noise would make of it."""
    window = acceleration[:length]
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * (window[1:] + window[:-1]))])
    span = np.linspace(-1.0, 1.0, length)
    velocity = velocity - velocity.mean() - span * np.mean(velocity * span) / np.mean(span**2)
    rms = float(np.sqrt(np.mean(velocity**2)))
    noise = NOISE * WALK * noise_rms(acceleration) * np.sqrt(length)
    return float(abs(velocity[0]) / max(rms, noise / MOVING, np.finfo(float).tiny))
