"""A stepped-sine test as a fit sees it: complex amplitudes against the model's steady state."""

from dataclasses import dataclass, replace

import numpy as np

from identification.hypothesis import Hypothesis
from identification.stepped_sine.balance import Balance
from identification.stepped_sine.record import SteppedSine
from identification.wire import sent_once
from models.arrays import FloatArray
from models.simulate import Settings

THIRD = np.sqrt(20.0)
"""Standard deviation of a third difference of white noise, in units of the noise's."""

MEDIAN_OF_TWO = np.sqrt(2.0 * np.log(2.0))
"""Median of the modulus of complex noise over the standard deviation of each of its parts."""


def scatter(record: SteppedSine) -> float:
    """Standard deviation of the real and of the imaginary part of responses, from what neighbours do not share.

    Third differences along the frequency, the median over lines and sensors: a resonance is smooth but at its top.

    Args:
        record: five lines or more.
    """
    size = np.abs(np.diff(record.responses, 3, axis=1)) / THIRD
    return float(np.median(size) / MEDIAN_OF_TWO)


@sent_once
@dataclass(frozen=True, eq=False)
class SteppedTarget:
    """One stepped-sine test with the noise it is judged in.

    Attributes:
        record: measured.
        noise: standard deviation of the real and of the imaginary part of a response, SI.
        is_soft: judged by the balance of forces on the measured motion.
    """

    record: SteppedSine
    noise: float
    is_soft: bool = False

    def soft(self) -> "SteppedTarget":
        """The same, judged by the balance of forces on the measured motion, which has no folds and is nearly linear."""
        return replace(self, is_soft=True)

    @property
    def n_data(self) -> int:
        """Real and imaginary parts."""
        return 2 * self.record.values.size

    @property
    def nrmse_of_noise(self) -> float:
        """NRMSE that the noise alone leaves."""
        return float(np.sqrt(2.0) * self.noise / np.sqrt(np.mean(np.abs(self.record.responses) ** 2)))

    def nrmse_left(self, residual: FloatArray) -> float:
        """NRMSE of a residual, (n_data,) in units of the noise."""
        return self.nrmse_of_noise * float(np.sqrt(np.mean(residual**2)))

    def residual(self, hypothesis: Hypothesis, settings: Settings) -> FloatArray:
        """(n_data,) model minus measured in standard deviations of the noise."""
        del settings  # A steady state has no steps.
        balance = Balance.of(hypothesis, self.record)
        left = balance.imbalance() if self.is_soft else balance.steady_state() - self.record.responses
        return np.ascontiguousarray(left / self.noise).view(float).ravel()

    def rms_error(self, hypothesis: Hypothesis) -> float:
        """Rms of the modulus of model minus measured over lines and sensors, SI.

        Args:
            hypothesis: an oscillator with its effects.
        """
        left = Balance.of(hypothesis, self.record).steady_state() - self.record.responses
        return float(np.sqrt(np.mean(np.abs(left) ** 2)))
