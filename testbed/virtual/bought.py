"""Sensors as they are bought: what they add to the truth, and what they take from it."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.errors import InputError
from testbed.virtual.experiment import SensorTable

STANDARD_GRAVITY = 9.80665
"""m/s^2."""


@dataclass(frozen=True)
class Bought:
    """A sensor with its data sheet's numbers; the defaults are an ideal one.

    Attributes:
        noise_density: of white noise, SI per root hertz.
        range: largest reading, SI; beyond it the reading is clipped.
        bits: of the converter, over plus and minus the range; 0 for none.
        resonance: of the sensor on its mount, Hz.
        quality: of that resonance.
        mass: kg, with its cable, on the beam.
        position_error: m, how much further from the clamp it sits than the rig file says.
        gain_error: it reads 1 + this times the truth.
        source: of the numbers.
    """

    noise_density: float = 0.0
    range: float = np.inf
    bits: int = 0
    resonance: float = np.inf
    quality: float = 30.0
    mass: float = 0.0
    position_error: float = 0.0
    gain_error: float = 0.0
    source: str = ""

    def reads(self, truth: FloatArray, fs: float, rng: np.random.Generator) -> FloatArray:
        """(N,) what the recorder holds of a true channel.

        Args:
            truth: (N,) band-limited, SI.
            fs: Hz.
            rng: of the noise.
        """
        freq = fft.rfftfreq(len(truth), 1.0 / fs)
        turned = freq / self.resonance
        gain = (1.0 + self.gain_error) / (1.0 - turned**2 + 1j * turned / self.quality)
        heard = fft.irfft(fft.rfft(truth) * gain, len(truth))
        if self.noise_density:
            white = rng.standard_normal((1, len(truth))) * self.noise_density * np.sqrt(fs / 2.0)
            heard = heard + record_channels(white, 1, len(truth), fs)[0]
        heard = np.clip(heard, -self.range, self.range)
        if self.bits and np.isfinite(self.range):
            step = 2.0 * self.range / 2**self.bits
            heard = step * np.round(heard / step)
        return np.asarray(heard)

    def share_at_end(self, reading: FloatArray) -> float:
        """Share of a channel's samples that stand at the end of the sensor's range, clipped.

        Args:
            reading: (N,) as ``reads`` gives it.
        """
        return float(np.mean(np.abs(reading) >= self.range * (1.0 - AT_END)))


AT_END = 1e-9
"""Share of the range by which a reading at its end may be rounded."""

PRESETS: dict[str, Bought] = {
    "PCB 352C66": Bought(
        noise_density=1.6e-6 * STANDARD_GRAVITY,
        range=50.0 * STANDARD_GRAVITY,
        resonance=35e3,
        mass=2e-3,
        source="maker's data sheet: 100 mV/g, 50 g peak, resolution 0.16 mg rms from 1 Hz to 10 kHz, here spread "
        "evenly over that band; resonance above 35 kHz; 2 g without cable",
    ),
    "PCB 356A02": Bought(
        noise_density=5e-6 * STANDARD_GRAVITY,
        range=500.0 * STANDARD_GRAVITY,
        resonance=25e3,
        mass=10.5e-3,
        source="maker's data sheet: 10 mV/g, 500 g peak, resolution 0.5 mg rms from 1 Hz to 10 kHz, here spread "
        "evenly over that band; resonance above 25 kHz; 10.5 g without cable",
    ),
    "VG91": Bought(
        noise_density=float(np.deg2rad(0.02 / 60.0 * np.sqrt(2.0))),
        range=float(np.deg2rad(300.0)),
        resonance=1e3,
        quality=0.7,
        mass=0.11,
        source="a small fibre-optic gyroscope, assumed from its class: random walk 0.02 deg per root hour, 300 deg/s, "
        "1 kHz, 110 g; the sheet of the very model was not at hand",
    ),
}
"""Of the article's instruments."""


def bought(table: SensorTable | None, where: str) -> Bought:
    """The sensor that an experiment's table describes.

    Args:
        table: of the experiment, or None for an ideal sensor.
        where: how errors call it.

    Raises:
        InputError: an unknown preset, or a converter without a range.
    """
    if table is None:
        return Bought()
    if table.preset is not None and table.preset not in PRESETS:
        raise InputError(
            f'{where}.preset = "{table.preset}"',
            f"the presets are {', '.join(PRESETS)}",
            "choose one, or give the numbers",
        )
    base = PRESETS[table.preset] if table.preset is not None else Bought()
    given = {key: value for key, value in table.model_dump(exclude={"preset"}).items() if value is not None}
    sensor = replace(base, **given)
    if sensor.bits and not np.isfinite(sensor.range):
        raise InputError(
            f"{where}.bits = {sensor.bits} without a range", "a converter spreads its bits over a range", "add range"
        )
    return sensor
