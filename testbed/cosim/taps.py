"""Small hammer blows in equal times, so small that closed sleeves stay closed and open ones open."""

from dataclasses import dataclass, replace

import numpy as np

from identification.metrics import mean_by_quantity
from models.arrays import FloatArray
from models.plant import Plant
from models.ports import Port
from models.record import Record
from models.rest import is_bilateral
from models.simulate import Settings, simulate

SHARE = 0.2
"""Of the force at rest, and of a gap, that the taps may take: contacts stay as they are, curved laws nearly linear."""

REHEARSED = 12
"""Taps after which the motion has built up."""

TRIAL = 1e-3
"""Peak of the rehearsed taps, N; the rig is linear there."""

BILATERAL_PEAK = 1.0
"""Peak, N, where no sleeve can open or close."""


@dataclass(frozen=True)
class Taps:
    """Half-sine blows.

    Attributes:
        period: from one to the next, s.
        width: of a blow, s.
        peak: N.
    """

    period: float
    width: float
    peak: float

    def force(self, fs: float, first: int, n: int) -> FloatArray:
        """(n,) samples from number ``first`` on, N; the first tap comes after half a period.

        Args:
            fs: sampling rate, Hz.
            first: number of the first sample; before 0 nothing acts.
            n: samples.
        """
        since = (first + np.arange(n)) / fs - 0.5 * self.period
        phase = np.where(since >= 0.0, np.mod(since, self.period), np.inf) / self.width
        return np.where(phase < 1.0, self.peak * np.sin(np.pi * np.minimum(phase, 1.0)), 0.0)


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """What the taps do to the rig once the motion has built up.

    Attributes:
        peak: of the taps, N, by which no contact changes.
        rms: (n_sensors,) of the channels under such taps, each over all sensors of its quantity, in its unit.
    """

    peak: float
    rms: FloatArray


def rehearse(plant: Plant, taps: Taps, fs: float) -> Rehearsal:
    """Choose the taps' peak so that they take no more than ``SHARE`` of what holds a contact as it is at rest.

    Args:
        plant: the rig, lightly damped: the motion builds up more than in the run.
        taps: of any peak.
        fs: sampling rate, Hz.
    """
    n = round(REHEARSED * taps.period * fs)
    sensors = plant.sensors
    record = Record(
        "rehearsal",
        fs,
        replace(taps, peak=TRIAL).force(fs, 0, n),
        tuple(s.name for s in sensors),
        np.zeros((len(sensors), n)),
    )
    done = simulate(plant, record, Settings(trace=True))
    trace, rest = done.trace, done.model.rest
    assert trace is not None
    rooms = [np.inf]
    for number, contact in enumerate(plant.contacts):
        if is_bilateral(contact):
            continue
        hold = abs(float(rest.contact_forces[number]))
        if hold > 0.0:
            moved, room = trace.contact_forces[number] - rest.contact_forces[number], hold
        else:
            port = trace.ports.index(Port(contact.position))
            moved, room = trace.q[port] - rest.position[port], -float(rest.penetration[number])
        rooms.append(SHARE * room / max(float(np.abs(moved).max()), np.finfo(float).tiny))
    peak = TRIAL * min(rooms) if np.isfinite(min(rooms)) else BILATERAL_PEAK
    power = np.mean(done.channels**2, axis=1)
    rms = np.sqrt(mean_by_quantity(power, [sensor.quantity for sensor in sensors]))
    return Rehearsal(peak, rms * peak / TRIAL)
