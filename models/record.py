"""Measurements as values: time records, FRFs and mode shapes of one rig, in SI units.

Files are read elsewhere (``testbed.records``); here is only what the models and the identification need to know.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from models.arrays import BoolArray, ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class Record:
    """One test: the measured excitation and the sensors' channels on one uniform time base.

    Attributes:
        name: how the report calls it, normally the file's name.
        fs: sampling rate, Hz.
        excitation: (N,) measured excitation in the SI unit of its quantity (N, m/s^2, m/s or m); None for a free decay.
        sensors: names of the rig's sensors that this record holds, in the order of ``responses``.
        responses: (n_sensors, N) in the SI unit of each sensor's quantity.
        excitation_position: where this record's force acts, m from the clamp, if it is not where the rig says
            (a roving hammer).
        moving_start: the first samples show motion, so the state at the start has to be estimated.
        findings: what the reader noticed and did not refuse (a dead channel left out, a unit assumed).
    """

    name: str
    fs: float
    excitation: FloatArray | None
    sensors: tuple[str, ...]
    responses: FloatArray
    excitation_position: float | None = None
    moving_start: bool = False
    findings: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        """Make the arrays read-only: a record is a value."""
        self.responses.setflags(write=False)
        if self.excitation is not None:
            self.excitation.setflags(write=False)

    @property
    def n_samples(self) -> int:
        """Samples in each channel."""
        return int(self.responses.shape[1])

    @property
    def duration(self) -> float:
        """Length in seconds, N / fs."""
        return self.n_samples / self.fs

    @property
    def time(self) -> FloatArray:
        """(N,) seconds from the first sample."""
        return np.arange(self.n_samples) / self.fs


def is_dead(samples: FloatArray) -> bool:
    """Whether a channel is constant, to rounding.

    Args:
        samples: (N,) in any unit.
    """
    return bool(np.ptp(samples) <= max(1e-12 * np.abs(samples).max(), LEAST_VARIATION))


LEAST_VARIATION = 1e-30
"""In any unit: nothing that lives varies by less."""


@dataclass(frozen=True, eq=False)
class FrfRecord:
    """Measured frequency response functions from one excitation point.

    Attributes:
        name: how the report calls it.
        frequency: (n,) Hz.
        sensors: names of the rig's sensors, in the order of ``values``.
        values: (n_sensors, n) response per unit excitation, SI.
        excitation_position: m from the clamp, where it differs from the rig's.
        coherence: (n_sensors, n) of each response with the excitation, or None where the file has none.
    """

    name: str
    frequency: FloatArray
    sensors: tuple[str, ...]
    values: ComplexArray
    excitation_position: float | None = None
    coherence: FloatArray | None = None

    def above_0_hz(self) -> "FrfRecord":
        """Without a line at 0 Hz, where an accelerometer reads nothing and a transmissibility is 0 / 0."""
        return self.at_lines(self.frequency > 0)

    def at_lines(self, lines: slice | BoolArray) -> "FrfRecord":
        """On some of the lines only."""
        return replace(
            self,
            frequency=self.frequency[lines],
            values=self.values[:, lines],
            coherence=None if self.coherence is None else self.coherence[:, lines],
        )


@dataclass(frozen=True, eq=False)
class ModeShapeRecord:
    """Measured natural frequencies and mode shapes at the rig's sensors.

    Attributes:
        name: how the report calls it.
        sensors: names of the rig's sensors, in the order of the columns of ``shapes``.
        natural_freqs: (n,) Hz.
        damping_ratios: (n,) or None where the file has none.
        shapes: (n, n_sensors) complex or real, any scale.
    """

    name: str
    sensors: tuple[str, ...]
    natural_freqs: FloatArray
    damping_ratios: FloatArray | None
    shapes: ComplexArray


AnyRecord = Record | FrfRecord | ModeShapeRecord
