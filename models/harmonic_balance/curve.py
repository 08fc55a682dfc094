"""Curves of periodic motion and what the sensors read along them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.harmonic_balance.drive import SineDrive
from models.harmonic_balance.poles import StateSpace
from models.harmonic_balance.stability import Loss
from models.linear import ORDER_READ, sensor_rows
from models.modal import ModalModel

SAMPLES = 512
"""Of a period in which the largest reading is sought."""


@dataclass(frozen=True, eq=False)
class PeriodicCurve:
    """Periodic motions in the order in which the curve was followed.

    Attributes:
        model: that moves.
        freqs: (n,) of the excitation, Hz.
        amplitudes: (n,) of the excitation, in its own quantity.
        motion: (n, n_ports, H + 1) two-sided Fourier coefficients of the ports about rest, m.
        forces: (n, n_ports, H + 1) those of the laws and contacts, less what they push at rest, N.
        left_out: (n,) motion of the ports in harmonics left out, over that in those kept.
        largest_multiplier: (n,) modulus; nan where stability was not asked for.
        losses: (n,) how stability is lost.
        ended: why the curve ends where it does, in words; empty if it reached what was asked for.
    """

    model: ModalModel
    freqs: FloatArray
    amplitudes: FloatArray
    motion: ComplexArray
    forces: ComplexArray
    left_out: FloatArray
    largest_multiplier: FloatArray
    losses: tuple[Loss, ...]
    ended: str

    @property
    def is_stable(self) -> np.ndarray:
        """(n,) of bool."""
        return np.array([loss == "" for loss in self.losses])

    def read(self, sensors: Sequence[str]) -> ComplexArray:
        """(n, n_sensors, H + 1) one-sided harmonics: reading = Re sum of them times exp(i k omega t), SI.

        As ideal sensors read: gains, delays and hum are not in it. The mean is about rest.

        Args:
            sensors: names of the rig's sensors.
        """
        named = {sensor.name: sensor for sensor in self.model.plant.sensors}
        chosen = [named[name] for name in sensors]
        drive, read = SineDrive.of(self.model), self._moved(sensor_rows(self.model, chosen))
        omega = 2.0 * np.pi * self.freqs
        sees_base = np.array([sensor.quantity != "angular_velocity" for sensor in chosen], float)
        base = np.array([drive.base_at(float(one)) for one in omega])
        read[:, :, 1] += sees_base * (self.amplitudes * base)[:, None]
        order = np.array([ORDER_READ[sensor.quantity] for sensor in chosen])
        turn = 1j * omega[:, None] * np.arange(read.shape[2])
        return np.asarray(read * turn[:, None, :] ** order[:, None])

    def peaks(self, sensors: Sequence[str]) -> FloatArray:
        """(n, n_sensors) half of what each reading swings within a period, SI."""
        read = self.read(sensors)
        read[:, :, 1:] *= 0.5
        course = np.fft.irfft(read, SAMPLES, axis=2, norm="forward")
        return np.asarray(0.5 * np.ptp(course, axis=2))

    def states(self) -> FloatArray:
        """(n, 2 n_modes) modal displacements, then velocities, about rest when the excitation is at its crest."""
        moved = self._moved(np.eye(self.model.n))
        turn = 2j * np.pi * self.freqs[:, None, None] * np.arange(moved.shape[2])
        return np.hstack([moved.real.sum(axis=2), (turn * moved).real.sum(axis=2)])

    def _moved(self, rows: FloatArray) -> ComplexArray:
        """(n, n_out, H + 1) one-sided harmonics of displacements by modal coordinate, relative to the base."""
        drive = SineDrive.of(self.model)
        load = np.column_stack([self.model.port_rows.T, drive.load])
        response, k = StateSpace.of(self.model).between(rows, load), np.arange(self.motion.shape[2])
        moved = np.empty((len(self.freqs), len(rows), len(k)), complex)
        for point, omega in enumerate(2.0 * np.pi * self.freqs):
            given = np.zeros((1, len(k)), complex)
            given[0, 1] = 0.5 * self.amplitudes[point] * drive.input_at(float(omega))
            pushed = np.vstack([self.forces[point], given])
            moved[point] = (response.at(1j * omega * k) @ pushed.T[:, :, None])[:, :, 0].T
        moved[:, :, 1:] *= 2.0
        return moved
