"""How far the toleranced numbers of a rig can imitate effects that its description lacks."""

from collections.abc import Sequence
from math import inf
from zlib import crc32

import numpy as np
from scipy import fft
from scipy.optimize import lsq_linear

from identification.metrics import mean_by_quantity
from models.arrays import FloatArray
from models.band_limit import SCORE_EDGE
from models.effects import Effect
from models.errors import DivergenceError, InputError
from models.plant import build_plant
from testbed.hidden_effects.motion import channels_of
from testbed.hidden_effects.trials import LEARNT, Trial
from testbed.virtual.noise import Noise
from testbed.virtual.virtual_record import drawn

FARTHEST = 4.0
"""Deviations of its tolerance by which a calibration moves a number at most."""

STEP = 0.02
"""Differences are taken over this share of a tolerance."""

SMALLEST_SHARE = 0.2
"""Of a Gauss-Newton step that is worth taking."""

ENOUGH = 0.97
"""A step that leaves more than this share ends the calibration."""


def in_band(channels: FloatArray) -> FloatArray:
    """(n, 2 lines) real and imaginary parts of the spectra below the frequency up to which errors are judged."""
    spectra = fft.rfft(channels, axis=1, norm="ortho")[:, : int(SCORE_EDGE * channels.shape[1]) + 1]
    return np.asarray(np.sqrt(2.0) * np.hstack([spectra.real, spectra.imag]))


class Imitation:
    """How much effects show beyond what the rig's toleranced numbers imitate, in units of the noise.

    The calibration is a chord method: the derivatives are those at the rig as built, taken once for all effects.

    Args:
        trial: the rig, as its owner describes it and as built, and the forces; the record held out is not used.
        noise: of the measurement chain.
        rng: draws the force's noise.
        names: of the records.

    Raises:
        DivergenceError: the motion without an effect left the finite numbers.
    """

    def __init__(self, trial: Trial, noise: Noise, rng: np.random.Generator, names: Sequence[str] = LEARNT) -> None:
        self.fs = trial.fs
        self.forces = [trial.first_seconds(name) for name in names]
        self.drawn, self.built = trial.rig.parameters(), trial.built
        built = trial.built
        self.off = np.array([(b.value - d.value) / d.std for b, d in zip(built.parameters(), self.drawn, strict=True)])
        plain = [channels_of(built, force, self.fs) for force in self.forces]
        self.scales = [self._scale(in_band(channels)) for channels in plain]
        self.here = self._stacked(plain)
        shaken = [force + noise.excitation * force.std() * rng.standard_normal(len(force)) for force in self.forces]
        carried = self._stacked([channels_of(built, force, self.fs) for force in shaken]) - self.here
        self.floor = float(np.hypot(self._size(carried), noise.response * np.sqrt(2.0 * SCORE_EDGE)))
        self.weight = self.floor / np.sqrt(self.here.size / len(self.forces))  # noise of one entry
        moves = STEP * np.eye(len(self.off))
        slopes = [(self._channels(self.off + move) - self.here) / (STEP * self.weight) for move in moves]
        self.slopes = np.stack(slopes, axis=1)
        self.root = np.linalg.cholesky(self.slopes.T @ self.slopes + np.eye(len(self.off)))

    def shown(self, effects: tuple[Effect, ...], rounds: int) -> float:
        """Error of the model calibrated in so many rounds over that of a perfect one; infinite where it flies apart."""
        try:
            return self._shown(effects, rounds)
        except (DivergenceError, InputError):  # it has no state at rest either
            return inf

    def _shown(self, effects: tuple[Effect, ...], rounds: int) -> float:
        plant = build_plant(self.built, effects)
        free = drawn(plant, np.random.default_rng(crc32(repr([e.kind for e in effects]).encode())))
        channels = [channels_of(self.built, force, self.fs, effects, free) for force in self.forces]
        return self._left(self._stacked(channels), rounds)

    def shown_by(self, changes: Sequence[FloatArray], rounds: int) -> float:
        """The same of given changes of the channels, (n_sensors, N) for each record."""
        return self._left(self.here + self._stacked(list(changes)), rounds)

    def _left(self, target: FloatArray, rounds: int) -> float:
        deviations, left = self.off, target - self.here
        for _ in range(rounds):
            change = self._correction(deviations, left / self.weight)
            share, trial = 1.0, target - self._channels(deviations + change)
            while np.linalg.norm(trial) > np.linalg.norm(left) and share > SMALLEST_SHARE:
                share *= 0.5
                trial = target - self._channels(deviations + share * change)
            if np.linalg.norm(trial) > ENOUGH * np.linalg.norm(left):
                break
            deviations, left = deviations + share * change, trial
        return float(np.hypot(self._size(left) / self._size(target), self.floor) / self.floor)

    def _correction(self, deviations: FloatArray, left: FloatArray) -> FloatArray:
        """(n,) the linear least-squares change of the numbers with their prior, within their bounds."""
        pull = np.linalg.solve(self.root, self.slopes.T @ left - deviations)
        bounds = (-FARTHEST - deviations - 1e-9, FARTHEST - deviations + 1e-9)
        return np.asarray(lsq_linear(self.root.T, pull, bounds).x)

    def _channels(self, deviations: FloatArray) -> FloatArray:
        """Channels of the rig with its numbers so many deviations off the drawing, in a row."""
        values = {d.path: d.value + x * d.std for d, x in zip(self.drawn, deviations, strict=True)}
        rig = self.built.with_values(values)
        return self._stacked([channels_of(rig, force, self.fs) for force in self.forces])

    def _scale(self, spectra: FloatArray) -> FloatArray:
        """(n_sensors, 1) by the quantity of each channel, such that a whole record in these units has a norm of 1."""
        powers = mean_by_quantity(np.sum(spectra**2, axis=1), [sensor.quantity for sensor in self.built.sensors])
        return np.sqrt(len(powers) * powers)[:, None]

    def _stacked(self, channels: list[FloatArray]) -> FloatArray:
        """Spectra of all channels in a row, each record in units of its size."""
        return np.concatenate([(in_band(c) / scale).ravel() for c, scale in zip(channels, self.scales, strict=True)])

    def _size(self, stacked: FloatArray) -> float:
        """Rms over the records."""
        return float(np.linalg.norm(stacked) / np.sqrt(len(self.forces)))
