"""From a motion at an engine's own steps to what a recorder holds of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees

import numpy as np

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.effects.protocol import Measurement
from models.fine.course import base_motion
from models.linear import ORDER_READ
from models.plant import Plant
from models.ports import Port
from models.simulators.protocol import Across, EnergyBalance, Motion, Trial


@dataclass(frozen=True, eq=False)
class Steps:
    """What an engine did, at every one of its M steps.

    Attributes:
        read: (n_sensors, M) deflection, or slope, at the sensors from rest, m or rad.
        motion: (n_ports, M) place of the ports as their laws see it, m.
        forces: (n_forces, M) of each point force on the structure, the contacts' last, N.
        energy: where it went, at the samples.
        across: (n_contacts, M) forces of the contacts across the rig's plane, N, or None where they are in it.
    """

    read: FloatArray
    motion: FloatArray
    forces: FloatArray
    energy: EnergyBalance
    across: FloatArray | None = None


def recorded(
    plant: Plant, trial: Trial, factor: int, steps: Steps, ports: Sequence[Port], choices: tuple[str, ...]
) -> Motion:
    """Band-limited channels, gaps and energy of a motion.

    Args:
        plant: with its sensors and effects.
        trial: what was done.
        factor: steps per sample.
        steps: what the engine did; the contacts' forces come last.
        ports: of ``steps.motion``.
        choices: to be told.
    """
    order = np.array([ORDER_READ[sensor.quantity] for sensor in plant.sensors])
    read = np.where(order[:, None] > 0, rate_of(steps.read, trial.fs * factor), steps.read)
    channels = record_channels(read, factor, trial.n_samples, trial.fs, np.maximum(order - 1.0, 0.0))
    base = base_motion(plant, trial.excitation, trial.fs, factor, trial.free)[:3]
    if base.shape[1]:
        seen = record_channels(base, factor, trial.n_samples, trial.fs)
        for number, sensor in enumerate(plant.sensors):
            if sensor.quantity != "angular_velocity":
                channels[number] += seen[ORDER_READ[sensor.quantity]]
    measurement = Measurement(tuple(sensor.name for sensor in plant.sensors), trial.fs, trial.free)
    for effect in plant.effects:
        channels = effect.change_channels(channels, measurement)
    place = steps.motion[[ports.index(Port(contact.position)) for contact in plant.contacts]]
    aside = np.zeros_like(place)
    if steps.across is not None:
        aside = steps.motion[[ports.index(Port(contact.position, across=True)) for contact in plant.contacts]]
    time = np.arange(place.shape[1]) / (trial.fs * factor)
    gaps = [
        contact.clearance + contact.clearance_rate * time - np.hypot(row - contact.offset, other)
        for contact, row, other in zip(plant.contacts, place, aside, strict=True)
    ]
    return Motion(
        channels=channels,
        fs=trial.fs * factor,
        contact_forces=steps.forces[len(steps.forces) - len(plant.contacts) :],
        places=place,
        gaps=np.array(gaps).reshape(place.shape),
        energy=steps.energy,
        choices=choices if steps.across is None else (IN_SPACE.format(degrees(trial.angle)), *choices),
        across=None if steps.across is None else Across(aside, steps.across),
    )


IN_SPACE = (
    "in space, in round sleeves; sensors, springs and dashpots at points in the rig's plane, the force at {:g} degrees"
)


def rate_of(place: FloatArray, fs: float) -> FloatArray:
    """(n, M) time derivative of what starts without velocity, by differences of fourth order.

    Args:
        place: (n, M) at fs; before the first step it is taken to have come as it goes.
        fs: Hz.
    """
    long = np.concatenate([place[:, 2:0:-1], place, 2.0 * place[:, -1:] - place[:, -2:-4:-1]], axis=1)
    near, far = long[:, 3:-1] - long[:, 1:-3], long[:, 4:] - long[:, :-4]
    return np.asarray((8.0 * near - far) * (fs / 12.0))
