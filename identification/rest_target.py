"""FRFs and mode shapes as a fit sees them: small motion about rest, against the linearised model."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from identification.at_rest import PairedModes, paired_modes, predicted_frfs
from identification.frf_noise import frf_noise
from identification.hypothesis import Hypothesis
from identification.metrics import pooled_nrmse
from identification.result import FrfScore, ModesScore
from identification.wire import sent_once
from models.arrays import BoolArray, ComplexArray, FloatArray
from models.errors import InputError
from models.record import FrfRecord, ModeShapeRecord
from models.simulate import Settings

FREQ_STD = 0.002
"""Standard deviation of a measured natural frequency, as a share of it: what modal analyses of one rig differ by."""

DAMPING_STD = 0.2
"""The same of a damping ratio."""

SHAPE_STD = 0.02
"""The same of an entry of a mode shape, as a share of its largest."""

BLUR = 0.1
"""Share of the FRF that is added to the noise of a soft difference, so that all lines count alike."""

SOFT_LINES = 400
"""Lines of soft FRFs at most."""

NO_MODE = 1.0
"""Relative error of a measured mode that the model does not have."""


@sent_once
@dataclass(frozen=True, eq=False)
class FrfTarget:
    """FRFs as a fit sees them.

    Attributes:
        record: measured, above 0 Hz.
        noise: (n_sensors, n) standard deviation of the real part, and of the imaginary part.
        method: how the noise was found, in words.
        quantities: of the sensors.
        is_soft: for the first of several fits: the difference is taken relative to the mean of both magnitudes, so that
            a resonance beside the measured one counts as 2 and not as a hundred, and the fit finds across.
    """

    record: FrfRecord
    noise: FloatArray
    method: str
    quantities: tuple[str, ...]
    is_soft: bool = False

    @classmethod
    def of(cls, record: FrfRecord, quantities: tuple[str, ...] | None = None) -> "FrfTarget":
        """With the noise that the record tells; where the sensors' quantities are None, they are one.

        Raises:
            InputError: too few lines.
        """
        above = record.above_0_hz()
        return cls(above, *frf_noise(above), ("",) * len(record.sensors) if quantities is None else quantities)

    def soft(self) -> "FrfTarget":
        """For the first of several fits, on some of the lines."""
        every = slice(None, None, -(-len(self.record.frequency) // SOFT_LINES))
        return replace(self, record=self.record.at_lines(every), noise=self.noise[:, every], is_soft=True)

    @property
    def n_data(self) -> int:
        """Real and imaginary parts."""
        return 2 * self.record.values.size

    @property
    def nrmse_of_noise(self) -> float:
        """NRMSE that the noise alone leaves."""
        return pooled_nrmse(2.0 * np.sum(self.noise**2, axis=1), self._power, self.quantities)

    def nrmse_left(self, residual: FloatArray) -> float:
        """NRMSE of a residual, (n_data,) in units of the noise."""
        error = np.sum(np.abs(residual.view(complex).reshape(self.noise.shape) * self.noise) ** 2, axis=1)
        return pooled_nrmse(error, self._power, self.quantities)

    @cached_property
    def _power(self) -> FloatArray:
        """(n_sensors,) sum over the lines."""
        return np.asarray(np.sum(np.abs(self.record.values) ** 2, axis=1))

    @property
    def frequency(self) -> FloatArray:
        """(n,) lines, Hz."""
        return self.record.frequency

    @property
    def excitation_position(self) -> float | None:
        """Where the force acts, m from the clamp, if it is not where the rig says."""
        return self.record.excitation_position

    def residual(self, hypothesis: Hypothesis, settings: Settings) -> FloatArray:
        """(n_data,) model minus measured in standard deviations of the noise."""
        del settings  # A linear model has no steps.
        model, measured = predicted_frfs(hypothesis, self.record), self.record.values
        weight = self._soft_weight * 2.0 / (np.abs(model) + np.abs(measured)) if self.is_soft else 1.0 / self.noise
        return _as_real((model - measured) * weight)

    @cached_property
    def _soft_weight(self) -> FloatArray:
        """(n_sensors, n) alike on all lines above the noise, of which the difference is in units on most of them."""
        share = self.noise / np.maximum(np.abs(self.record.values), self.noise)
        blurred = np.hypot(share, BLUR)
        return np.asarray(np.median(blurred / share) / blurred)

    def score(self, hypothesis: Hypothesis) -> FrfScore:
        """Errors of a hypothesis."""
        predicted, measured = predicted_frfs(hypothesis, self.record), self.record.values
        error, power = np.sum(np.abs(predicted - measured) ** 2, axis=1), self._power
        return FrfScore(
            record=self.record,
            predicted=predicted,
            method=self.method,
            nrmse=pooled_nrmse(error, power, self.quantities),
            noise_nrmse=self.nrmse_of_noise,
            channel_nrmse=np.sqrt(error / power),
            channel_noise_nrmse=np.sqrt(2.0 * np.sum(self.noise**2, axis=1) / power),
        )


@sent_once
@dataclass(frozen=True, eq=False)
class ModesTarget:
    """Natural frequencies, damping ratios where the file has them, and mode shapes as a fit sees them.

    Each of the model's shapes is scaled to the measured one it is paired with, by least squares.
    Source: the modal scale factor of R. J. Allemang and D. L. Brown, IMAC 1, 1982.

    Attributes:
        record: measured.
        damped: (n,) whether the damping ratio of a mode is known.
        size: (n, 1) largest entry of each shape.
        method: where the noise comes from, in words.
    """

    record: ModeShapeRecord
    damped: BoolArray
    size: FloatArray
    method: str = (
        f"assumed: {FREQ_STD:.1%} of a natural frequency, {DAMPING_STD:.0%} of a damping ratio, {SHAPE_STD:.0%} of a "
        "shape's largest entry"
    )

    @classmethod
    def of(cls, record: ModeShapeRecord) -> "ModesTarget":
        """With the noise of a usual modal analysis.

        Raises:
            InputError: a mode whose shape is 0 at all sensors.
        """
        size = np.abs(record.shapes).max(axis=1, keepdims=True)
        if not size.all():
            raise InputError(
                f"{record.name}: mode {int(np.argmin(size)) + 1} is 0 at all sensors of the rig",
                "a mode shape moves at one of them at least",
                "remove the mode, or give the rig a sensor where it moves",
            )
        n_modes = len(record.natural_freqs)
        known = np.zeros(n_modes) if record.damping_ratios is None else record.damping_ratios
        return cls(record, known > 0.0, size)

    def soft(self) -> "ModesTarget":
        """The same: frequencies and shapes of paired modes are far from none."""
        return self

    @property
    def n_data(self) -> int:
        """A frequency and the entries of a shape for each mode, and the damping ratios that are known."""
        return len(self.size) + int(self.damped.sum()) + self.record.shapes.size * (2 if self._is_complex else 1)

    @property
    def nrmse_of_noise(self) -> float:
        """NRMSE that the noise alone leaves."""
        n_parts = self.record.shapes.shape[1] * (2 if self._is_complex else 1)
        share = self.size[:, 0] ** 2 / np.sum(np.abs(self.record.shapes) ** 2, axis=1)
        return float(np.sqrt(FREQ_STD**2 + SHAPE_STD**2 * n_parts * np.mean(share)))

    def nrmse_left(self, residual: FloatArray) -> float:
        """Error of a residual, (n_data,) in units of the noise, as many times that of the noise."""
        return self.nrmse_of_noise * float(np.sqrt(np.mean(residual**2)))

    @property
    def frequency(self) -> FloatArray:
        """(n,) lines over the band of the modes, Hz."""
        return np.linspace(0.0, BAND_BEYOND * float(self.record.natural_freqs.max()), LINES + 1)[1:]

    @property
    def mode_freqs(self) -> FloatArray:
        """(n_data,) Hz of the measured mode that each number of a residual belongs to."""
        freqs = self.record.natural_freqs
        shapes = np.repeat(freqs, self.record.shapes.shape[1] * (2 if self._is_complex else 1))
        return np.concatenate([freqs, shapes, freqs[self.damped]])

    @property
    def excitation_position(self) -> float | None:
        """That of the rig."""
        return None

    def residual(self, hypothesis: Hypothesis, settings: Settings) -> FloatArray:
        """(n_data,) model minus measured in standard deviations of the noise."""
        del settings  # A linear model has no steps.
        modes = paired_modes(hypothesis, self.record)
        shape = self._shape_error(modes) / (SHAPE_STD * self.size)
        parts = [self._freq_error(modes) / FREQ_STD, _as_real(shape) if self._is_complex else shape.real.ravel()]
        if self.record.damping_ratios is not None:
            model, measured = modes.damping_ratios[self.damped], self.record.damping_ratios[self.damped]
            parts.append(np.nan_to_num(np.log(np.maximum(model, LEAST_DAMPING) / measured)) / DAMPING_STD)
        return np.concatenate(parts)

    def score(self, hypothesis: Hypothesis) -> ModesScore:
        """Errors of a hypothesis: those of frequencies, relative, and of shapes, by their norm, over all modes."""
        modes = paired_modes(hypothesis, self.record)
        norm = np.linalg.norm(self.record.shapes, axis=1)
        shape = np.linalg.norm(self._shape_error(modes), axis=1) / norm
        error = np.sqrt(np.mean(self._freq_error(modes) ** 2 + shape**2))
        return ModesScore(self.record, modes, self.method, float(error), self.nrmse_of_noise)

    @cached_property
    def _is_complex(self) -> bool:
        return bool(np.any(np.abs(self.record.shapes.imag) > REAL * self.size))

    def _freq_error(self, modes: PairedModes) -> FloatArray:
        return np.nan_to_num(np.log(modes.natural_freqs / self.record.natural_freqs), nan=NO_MODE)

    def _shape_error(self, modes: PairedModes) -> ComplexArray:
        """(n, n_sensors) the model's shapes, scaled, less the measured; less nothing where the model has no mode."""
        model, measured = np.nan_to_num(modes.shapes), self.record.shapes
        power = np.sum(np.abs(model) ** 2, axis=1, keepdims=True)
        along = np.sum(model.conj() * measured, axis=1, keepdims=True)
        return np.asarray(np.divide(along, power, out=np.zeros_like(along), where=power > 0.0) * model - measured)


LINES, BAND_BEYOND = 256, 1.2
"""Lines over the band of measured modes, and where it ends above the highest."""

LEAST_DAMPING = 1e-6

REAL = 1e-6
"""Imaginary parts below this share of a shape's largest entry are those of a real mode."""


def _as_real(values: ComplexArray) -> FloatArray:
    return np.ascontiguousarray(values).view(float).ravel()
