"""How far the toleranced numbers of a rig can imitate an effect that its description lacks."""

from math import inf

import numpy as np
from scipy import fft
from scipy.optimize import lsq_linear

from models.arrays import FloatArray
from models.band_limit import SCORE_EDGE
from models.effects import Effect
from models.errors import DivergenceError
from models.rig import Rig
from tests.benchmarks.hidden_rigs import Trial, channels_of

FARTHEST = 4.0
"""Deviations of its tolerance by which a calibration moves a number at most."""

STEP = 0.02
"""Differences are taken over this share of a tolerance."""

N_USED = 8192
"""Samples of each record; the whole ones tell the same and take twice as long."""

SMALLEST_SHARE = 0.2
"""Of a Gauss-Newton step that is worth taking."""


def in_band(channels: FloatArray) -> FloatArray:
    """(n, 2 lines) real and imaginary parts of the spectra below the frequency up to which errors are judged."""
    spectra = fft.rfft(channels, axis=1, norm="ortho")[:, : int(SCORE_EDGE * channels.shape[1]) + 1]
    return np.sqrt(2.0) * np.hstack([spectra.real, spectra.imag])


class Imitation:
    """How much an effect shows beyond what the rig's toleranced numbers imitate, in units of the noise.

    Args:
        trial: the rig as drawn, and the forces; the records held out are not used.
        built: the rig as built.
        noise: of sensors and force, as a share of their rms.
        rng: draws the force's noise.
    """

    def __init__(self, trial: Trial, built: Rig, noise: float, rng: np.random.Generator) -> None:
        self.forces = [trial.forces[name][:N_USED] for name in trial.training]
        self.drawn, self.built = trial.rig.parameters(), built
        self.off = np.array([(b.value - d.value) / d.std for b, d in zip(built.parameters(), self.drawn, strict=True)])
        plain = [channels_of(built, force) for force in self.forces]
        self.scales = [float(np.linalg.norm(in_band(channels))) for channels in plain]
        shaken = [force + noise * force.std() * rng.standard_normal(len(force)) for force in self.forces]
        carried = self._stacked([channels_of(built, force) for force in shaken]) - self._stacked(plain)
        self.floor = float(np.hypot(self._size(carried), noise * np.sqrt(2.0 * SCORE_EDGE)))

    def shown(self, effect: Effect, rounds: int) -> float:
        """Error of the model calibrated in so many rounds over that of a perfect one; infinite where it flies apart."""
        try:
            return self._shown(effect, rounds)
        except DivergenceError:
            return inf

    def _shown(self, effect: Effect, rounds: int) -> float:
        target = self._stacked([channels_of(self.built, force, (effect,)) for force in self.forces])
        weight = self.floor / np.sqrt(target.size / len(self.forces))  # noise of one entry
        deviations, left = self.off, target - self._channels(self.off)
        for _ in range(rounds):
            change = self._correction(deviations, left / weight, weight)
            share, trial = 1.0, target - self._channels(deviations + change)
            while np.linalg.norm(trial) > np.linalg.norm(left) and share > SMALLEST_SHARE:
                share *= 0.5
                trial = target - self._channels(deviations + share * change)
            if np.linalg.norm(trial) > 0.97 * np.linalg.norm(left):
                break
            deviations, left = deviations + share * change, trial
            if self._size(left) < 0.3 * self.floor:
                break
        return float(np.hypot(self._size(left) / self._size(target), self.floor) / self.floor)

    def _correction(self, deviations: FloatArray, left: FloatArray, weight: float) -> FloatArray:
        """(n,) the linear least-squares change of the numbers with their prior, within their bounds."""
        here = self._channels(deviations)
        moves = STEP * np.eye(len(deviations))
        slopes = np.stack([(self._channels(deviations + move) - here) / (STEP * weight) for move in moves], axis=1)
        root = np.linalg.cholesky(slopes.T @ slopes + np.eye(len(deviations)))
        pull = np.linalg.solve(root, slopes.T @ left - deviations)
        bounds = (-FARTHEST - deviations - 1e-9, FARTHEST - deviations + 1e-9)
        return np.asarray(lsq_linear(root.T, pull, bounds).x)

    def _channels(self, deviations: FloatArray) -> FloatArray:
        """Channels of the rig with its numbers so many deviations off the drawing, in a row."""
        values = {d.path: d.value + x * d.std for d, x in zip(self.drawn, deviations, strict=True)}
        rig = self.built.with_values(values)
        return self._stacked([channels_of(rig, force) for force in self.forces])

    def _stacked(self, channels: list[FloatArray]) -> FloatArray:
        """Spectra of all channels in a row, each record in units of its size."""
        return np.concatenate([in_band(c).ravel() / scale for c, scale in zip(channels, self.scales, strict=True)])

    def _size(self, stacked: FloatArray) -> float:
        """Rms over the records."""
        return float(np.linalg.norm(stacked) / np.sqrt(len(self.forces)))
