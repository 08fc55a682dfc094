"""What the measurement chain of a virtual test adds to the signals."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from identification.metrics import mean_by_quantity
from models.arrays import FloatArray
from models.band_limit import record_channels
from models.rig import Sensor


@dataclass(frozen=True)
class Noise:
    """White Gaussian noise on the channels and on the measured excitation.

    Attributes:
        response: rms as a share of a signal's rms.
        excitation: rms as a share of the excitation's rms.
        share_of: ``quantity``: of the rms over all channels of the same quantity, so that all sensors of a kind have
            the same noise and a quiet one shows it more; ``channel``: of each channel's own rms.
        noise: ``after`` the recorder's low-pass, white to half the sampling rate (the converter's), or ``before`` it,
            so that the low-pass cuts it too (the sensor's).
    """

    response: float
    excitation: float
    share_of: Literal["quantity", "channel"] = "quantity"
    noise: Literal["after", "before"] = "after"

    def on_channels(
        self, channels: FloatArray, sensors: tuple[Sensor, ...], fs: float, rng: np.random.Generator
    ) -> FloatArray:
        """(n_sensors, N) the channels, given in the same shape, with noise."""
        power = np.mean(channels**2, axis=1)
        if self.share_of == "quantity":
            power = mean_by_quantity(power, [sensor.quantity for sensor in sensors])
        return np.asarray(channels + self.response * np.sqrt(power)[:, None] * self._white(channels.shape, fs, rng))

    def on_excitation(self, excitation: FloatArray, fs: float, rng: np.random.Generator) -> FloatArray:
        """(N,) the measured excitation with noise."""
        size = self.excitation * np.sqrt(np.mean(excitation**2))
        return np.asarray(excitation + size * self._white((1, len(excitation)), fs, rng)[0])

    def _white(self, shape: tuple[int, ...], fs: float, rng: np.random.Generator) -> FloatArray:
        white = rng.standard_normal(shape)
        return white if self.noise == "after" else record_channels(white, 1, shape[1], fs)
