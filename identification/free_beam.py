"""The linear structure without its sleeves, from rest: frequency responses, free decays, and forced motion of a record.

Where the bending stiffness drifts it is the structure of the record's start.

A record starts from rest and ends in motion, so its discrete spectra do not obey y = H f. They do up to free decays:
the response from rest is that to the force repeated forever, less the free decay of the state which the repetition has
at the first sample. Both are exact, in the eigenvectors of x' = A x + B f, x = (modal displacement, modal velocity).
Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), chapter 6.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

from models.arrays import AnyArray, ComplexArray, FloatArray
from models.band_limit import STOP_EDGE
from models.computed_once import computed_once
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
        shapes = np.array([model.rows(position) for position in positions]).reshape(-1, n)
        stiffness = np.diag(model.omega**2) + shapes.T @ (springs[:, None] * shapes)
        system = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -model.damping]])
        poles, basis = np.linalg.eig(system)
        force = np.vstack([np.zeros_like(shapes.T), shapes.T])
        return cls(poles, basis[:n], np.linalg.solve(basis, force.astype(complex)), shapes, n_samples, fs)

    @property
    def omega(self) -> FloatArray:
        """(lines,) circular frequencies of the record's spectrum, rad/s."""
        return 2.0 * np.pi * np.asarray(fft.rfftfreq(self.n_samples, 1.0 / self.fs))

    def acting_at(self, shapes: FloatArray) -> "FreeBeam":
        """The same structure, springs included, with forces at other places.

        Args:
            shapes: (n_places, n) displacement of the places by modal coordinate.
        """
        n = len(self.vectors)
        force = np.vstack([np.zeros((n, len(shapes))), shapes.T]).astype(complex)
        return replace(self, inputs=np.asarray(np.linalg.solve(self._basis, force), complex), shapes=shapes)

    def frf(self, rows: FloatArray, order: FloatArray, lines: int) -> ComplexArray:
        """(lines, n_rows, n_places) response of some rows to a unit force at each place.

        Args:
            rows: (n_rows, n) displacement (or slope) by modal coordinate.
            order: (n_rows,) how often each is differentiated in time.
            lines: how many, from 0 Hz.
        """
        paths = (rows @ self.vectors).T[:, :, None] * self.inputs[:, None, :]
        response = (self._above[:lines] @ paths.reshape(len(paths), -1)).reshape(lines, *paths.shape[1:])
        return np.asarray(response * self._differentiated(order)[:lines, :, None])

    def decays(self, rows: FloatArray, order: FloatArray) -> FloatArray:
        """(n_decays, n_rows, N) free decays that span what an unknown state at the first sample adds.

        Args:
            rows: (n_rows, n) as in ``frf``.
            order: (n_rows,) as in ``frf``.
        """
        turns = self.poles[self._recorded].imag
        readings = self._readings(rows, order)[:, self._recorded].T
        wave = readings[turns >= 0, :, None] * self._decay[turns >= 0, None, :]
        return np.concatenate([wave.real, wave[turns[turns >= 0] > 0].imag])

    def response(
        self, rows: FloatArray, order: FloatArray, force: FloatArray, start: FloatArray | None = None
    ) -> FloatArray:
        """(n_rows, N) response of some rows.

        Args:
            rows: (n_rows, n) as in ``frf``.
            order: (n_rows,) as in ``frf``.
            force: (n_places, N) N, below the recorder's stopped band.
            start: modal displacements and velocities at the first sample; None at rest. Shapes that it does not
                know rest.
        """
        spectrum = np.asarray(fft.rfft(force, axis=1)).T
        state = (spectrum @ self.inputs.T) * self._above
        forced = (state @ (rows @ self.vectors).T) * self._differentiated(order)
        free = -self._start(spectrum, state)
        if start is not None:
            free += np.linalg.solve(self._basis, self._resized(start).astype(complex))
        decay = (self._readings(rows, order) * free)[:, self._recorded]
        return np.asarray(
            fft.irfft(forced.T, self.n_samples) + decay.real @ self._decay.real - decay.imag @ self._decay.imag
        )

    def _resized(self, start: FloatArray) -> FloatArray:
        state, known = np.zeros((2, len(self.vectors))), start.reshape(2, -1)[:, : len(self.vectors)]
        state[:, : known.shape[1]] = known
        return state.ravel()

    @property
    def _basis(self) -> ComplexArray:
        return np.vstack([self.vectors, self.vectors * self.poles])

    @computed_once
    def _recorded(self) -> AnyArray:
        return np.asarray(np.abs(self.poles) <= 2.0 * np.pi * STOP_EDGE * self.fs)

    @computed_once
    def _above(self) -> ComplexArray:
        return np.asarray(1.0 / (1j * self.omega[:, None] - self.poles))

    @computed_once
    def _below(self) -> ComplexArray:
        return np.asarray(1.0 / (-1j * self.omega[:, None] - self.poles))

    @computed_once
    def _decay(self) -> ComplexArray:
        return np.asarray(np.exp(np.outer(self.poles[self._recorded], np.arange(self.n_samples) / self.fs)))

    def _readings(self, rows: FloatArray, order: FloatArray) -> ComplexArray:
        return np.asarray(rows @ self.vectors * self.poles ** order[:, None])

    def _differentiated(self, order: FloatArray) -> ComplexArray:
        return np.asarray((1j * self.omega[:, None]) ** order)

    def _start(self, spectrum: ComplexArray, state: ComplexArray) -> ComplexArray:
        """(2n,) eigencoordinates that the force repeated forever has at the first sample."""
        weight = np.full(len(spectrum), 1.0 / self.n_samples)
        weight[0] *= 0.5
        if self.n_samples % 2 == 0:
            weight[-1] *= 0.5
        mirrored = (weight[:, None] * spectrum.conj()).T @ self._below
        return np.asarray(weight @ state + np.einsum("pk,kp->k", mirrored, self.inputs))


def sensor_rows(model: ModalModel, sensors: Sequence[Sensor]) -> tuple[FloatArray, FloatArray]:
    """(n_sensors, n) rows of a modal model for sensors, and (n_sensors,) how often each is differentiated.

    Args:
        model: the rig.
        sensors: where they really are.
    """
    rows = [model.rows(s.position, 1 if s.quantity == "angular_velocity" else 0) for s in sensors]
    return np.stack(rows), np.array([float(ORDER_READ[s.quantity]) for s in sensors])
