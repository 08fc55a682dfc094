"""The linear structure without its sleeves, from rest: frequency responses, free decays, and forced motion of a record.

A record starts from rest and ends in motion, so its discrete spectra do not obey y = H f. They do up to free decays:
the response from rest is that to the force repeated forever, less the free decay of the state which the repetition has
at the first sample. Both are exact, in the eigenvectors of x' = A x + B f, x = (modal displacement, modal velocity).
Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), chapter 6.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import fft

from models.arrays import AnyArray, ComplexArray, FloatArray, IntArray
from models.band_limit import STOP_EDGE
from models.linear import ORDER_READ
from models.modal import ModalModel
from models.rig import Sensor


@dataclass(frozen=True, eq=False)
class FreeBeam:
    """Eigenvectors of the structure with forces at some places.

    Attributes:
        poles: (2n,) eigenvalues, 1/s.
        vectors: (n, 2n) modal displacements of each eigenvector.
        inputs: (2n, n_places) eigencoordinates' rates per unit force.
        shapes: (n_places, n) displacement of the places by modal coordinate.
        n_samples: of the record.
        fs: Hz.
    """

    poles: ComplexArray
    vectors: ComplexArray
    inputs: ComplexArray
    shapes: FloatArray
    n_samples: int
    fs: float

    @classmethod
    def of(
        cls, model: ModalModel, positions: Sequence[float | None], springs: FloatArray, n_samples: int, fs: float
    ) -> "FreeBeam":
        """The structure of a modal model, with springs at the places besides.

        Args:
            model: whose contacts and laws are left out.
            positions: of the places, m from the clamp; None on an oscillator.
            springs: (n_places,) N/m.
            n_samples: of the record.
            fs: of the record, Hz.
        """
        n = model.n
        shapes = np.stack([model.rows(position) for position in positions])
        stiffness = np.diag(model.omega**2) + shapes.T @ (springs[:, None] * shapes)
        system = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -model.damping]])
        poles, basis = np.linalg.eig(system)
        force = np.vstack([np.zeros_like(shapes.T), shapes.T])
        return cls(poles, basis[:n], np.linalg.solve(basis, force.astype(complex)), shapes, n_samples, fs)

    @property
    def omega(self) -> FloatArray:
        """(lines,) circular frequencies of the record's spectrum, rad/s."""
        return 2.0 * np.pi * np.asarray(fft.rfftfreq(self.n_samples, 1.0 / self.fs))

    def frf(self, rows: FloatArray, order: FloatArray, lines: int) -> ComplexArray:
        """(lines, n_rows, n_places) response of some rows to a unit force at each place.

        Args:
            rows: (n_rows, n) displacement (or slope) by modal coordinate.
            order: (n_rows,) how often each is differentiated in time.
            lines: how many, from 0 Hz.
        """
        s = 1j * self.omega[:lines]
        seen = rows @ self.vectors
        response = np.einsum("rk,lk,kp->lrp", seen, 1.0 / (s[:, None] - self.poles), self.inputs, optimize=True)
        return np.asarray(response * s[:, None, None] ** order[:, None])

    def decays(self, rows: FloatArray, order: FloatArray) -> FloatArray:
        """(n_decays, n_rows, N) free decays that span what an unknown state at the first sample adds.

        Args:
            rows: (n_rows, n) as in ``frf``.
            order: (n_rows,) as in ``frf``.
        """
        kept = np.flatnonzero(self._recorded & (self.poles.imag >= 0))
        wave = self._readings(rows, order)[:, kept].T[:, :, None] * self._decay(kept)[:, None, :]
        turning = self.poles[kept].imag > 0
        return np.concatenate([wave.real, wave[turning].imag])

    def response(self, rows: FloatArray, order: FloatArray, force: FloatArray) -> FloatArray:
        """(n_rows, N) response of some rows from rest.

        Args:
            rows: (n_rows, n) as in ``frf``.
            order: (n_rows,) as in ``frf``.
            force: (n_places, N) N, below the recorder's stopped band.
        """
        spectrum = np.asarray(fft.rfft(force, axis=1)).T
        forced = np.einsum("lrp,lp->rl", self.frf(rows, order, len(spectrum)), spectrum)
        kept = np.flatnonzero(self._recorded)
        free = (self._readings(rows, order)[:, kept] * self._start(spectrum)[kept]) @ self._decay(kept)
        return np.asarray(fft.irfft(forced, self.n_samples) - free.real)

    @property
    def _recorded(self) -> AnyArray:
        return np.asarray(np.abs(self.poles) <= 2.0 * np.pi * STOP_EDGE * self.fs)

    def _readings(self, rows: FloatArray, order: FloatArray) -> ComplexArray:
        return np.asarray(rows @ self.vectors * self.poles ** order[:, None])

    def _decay(self, kept: IntArray) -> ComplexArray:
        return np.asarray(np.exp(np.outer(self.poles[kept], np.arange(self.n_samples) / self.fs)))

    def _start(self, spectrum: ComplexArray) -> ComplexArray:
        """(2n,) eigencoordinates that the force repeated forever has at the first sample."""
        weight = np.full(len(spectrum), 1.0 / self.n_samples)
        weight[0] *= 0.5
        if self.n_samples % 2 == 0:
            weight[-1] *= 0.5
        s = 1j * self.omega[:, None]
        above = (spectrum * weight[:, None]) @ self.inputs.T / (s - self.poles)
        below = (spectrum.conj() * weight[:, None]) @ self.inputs.T / (-s - self.poles)
        return np.asarray(np.sum(above + below, axis=0))


def sensor_rows(model: ModalModel, sensors: Sequence[Sensor]) -> tuple[FloatArray, FloatArray]:
    """(n_sensors, n) rows of a modal model for sensors, and (n_sensors,) how often each is differentiated.

    Args:
        model: the rig.
        sensors: where they really are.
    """
    rows = [model.rows(s.position, 1 if s.quantity == "angular_velocity" else 0) for s in sensors]
    return np.stack(rows), np.array([float(ORDER_READ[s.quantity]) for s in sensors])
