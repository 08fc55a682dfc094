"""Channels that a compare must not use: missing, dead, a copy of another, or far outside what the beam allows."""

from dataclasses import dataclass

import numpy as np

from identification.evaluate import WITHOUT_ZERO
from models.arrays import FloatArray
from models.beam.clamped_free import clamped_free_modes
from models.record import is_dead
from models.rig import Beam, Rig
from testbed.records.units import SI_UNITS

FAR_OUTSIDE = 30.0
"""An rms so many times the median of its quantity is no motion of this beam; nor is one so small that is mere noise."""

FAR_BELOW = 300.0
"""An rms so many times smaller, beyond what the clamp explains: further than a sensor on a mode's node falls."""

FEWEST_TO_COMPARE = 3
"""Sensors of one quantity, below which nobody knows which one is wrong."""

STOPPED_FROM = 0.45
"""Fraction of fs above which a recorded signal holds nothing but noise added after the recorder's low-pass."""

WHITE_SHARE = 0.5
"""A channel whose variance is by this share white noise holds no motion."""


@dataclass(frozen=True)
class Fault:
    """Channels that cannot be used, and why."""

    sensors: tuple[str, ...]
    reason: str


def find_faults(responses: dict[str, FloatArray], rig: Rig, expected: tuple[str, ...]) -> list[Fault]:
    """The faults of a record's channels.

    Args:
        responses: sensor -> (N,) samples, SI.
        rig: where the sensors are.
        expected: the sensors that should be there.
    """
    missing = tuple(name for name in expected if name not in responses)
    faults = [Fault(missing, f"no channel for {', '.join(missing)}")] if missing else []
    dead = [name for name, samples in responses.items() if is_dead(samples)]
    faults += [Fault((name,), f"channel {name} is dead: {responses[name][0]:g} throughout") for name in dead]
    alive = {name: samples for name, samples in responses.items() if name not in dead}
    faults += _copies(alive)
    for quantity in sorted({sensor.quantity for sensor in rig.sensors}):
        group = {sensor.name for sensor in rig.sensors if sensor.quantity == quantity}
        faults += _outside({name: samples for name, samples in alive.items() if name in group}, rig)
    return faults


def own_zeros(responses: dict[str, FloatArray], rig: Rig) -> list[str]:
    """A sentence where channels whose mean tells nothing have a large one.

    Args:
        responses: sensor -> (N,) samples, SI.
        rig: what the sensors measure.
    """
    told = []
    for name, samples in responses.items():
        mean, motion = abs(float(samples.mean())), float(samples.std())
        least = max(LARGE_ZERO, CHANCE / np.sqrt(len(samples)))
        if rig.sensor(name).quantity in WITHOUT_ZERO and mean > least * motion:
            told.append(f"{name} ({mean:.3g} {SI_UNITS[rig.sensor(name).quantity]})")
    if not told:
        return []
    return [f"the mean of {', '.join(told)} is taken for the sensor's own zero, or gravity's share, and not judged"]


LARGE_ZERO, CHANCE = 0.3, 5.0
"""Mean, as a share of a channel's standard deviation, that is told; and in standard deviations of white noise's."""


def white_rms(samples: FloatArray) -> float:
    """Standard deviation of the white noise in a channel, from the band that the recorder stops.

    Args:
        samples: (N,).
    """
    window = np.hanning(samples.size)
    spectrum = np.abs(np.fft.rfft((samples - samples.mean()) * window)) ** 2
    stopped = spectrum[int(np.ceil(STOPPED_FROM * samples.size)) : -1]
    return float(np.sqrt(stopped.mean() / np.sum(window**2))) if stopped.size else 0.0


def _copies(alive: dict[str, FloatArray]) -> list[Fault]:
    seen: dict[bytes, list[str]] = {}
    for name, samples in alive.items():
        seen.setdefault(samples.tobytes(), []).append(name)
    return [
        Fault(tuple(names), f"channels {', '.join(names)} are exact copies, and at most one of them is right")
        for names in seen.values()
        if len(names) > 1
    ]


def _outside(group: dict[str, FloatArray], rig: Rig) -> list[Fault]:
    if len(group) < FEWEST_TO_COMPARE:
        return []
    rms = {name: float(np.sqrt(np.mean((samples - samples.mean()) ** 2))) for name, samples in group.items()}
    median = float(np.median(list(rms.values())))
    share = least_motion(tuple(group), rig)
    faults = []
    for name, samples in group.items():
        ratio = rms[name] / median
        floor = min(1.0, share[name])
        if ratio > FAR_OUTSIDE * max(1.0, share[name]):
            faults.append(Fault((name,), f"channel {name} is implausible: its rms is {ratio:.3g} times the others'"))
        elif ratio * FAR_BELOW < floor or (ratio * FAR_OUTSIDE < floor and _is_noise(samples, rms[name])):
            faults.append(
                Fault((name,), f"channel {name} is implausible: its rms is {1 / ratio:.3g} times below the others'")
            )
    return faults


def least_motion(names: tuple[str, ...], rig: Rig) -> dict[str, float]:
    """Each sensor's motion in the first mode, by the median one: no mode moves the beam less near the clamp.

    Args:
        names: of sensors of one quantity.
        rig: where they are.
    """
    if not isinstance(rig.structure, Beam):
        return dict.fromkeys(names, 1.0)
    sensors = [rig.sensor(name) for name in names]
    x = np.array([sensor.position for sensor in sensors], float) / rig.structure.length
    derivative = 1 if sensors[0].quantity == "angular_velocity" else 0
    motion = np.abs(clamped_free_modes(x, 1, derivative)[:, 0])
    return dict(zip(names, (motion / max(float(np.median(motion)), 1e-12)).tolist(), strict=True))


def _is_noise(samples: FloatArray, rms: float) -> bool:
    return white_rms(samples) ** 2 > WHITE_SHARE * rms**2
