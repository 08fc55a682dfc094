"""The mains in all channels."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi
from typing import ClassVar, Self

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE
from models.effects.protocol import Effect, Family, Measurement, Parameter, Scene, Signature, StructureKind, parameter

HARMONICS = (1, 3, 5)
PHASE = Parameter("phi", "rad", lower=-pi, upper=pi, scale="linear", spread=2.0)
LIKELY = (45.0, 65.0)
"""Frequencies, Hz, between which a line is likely the mains'."""


@dataclass(frozen=True)
class MainsHum(Effect):
    """A line at the mains frequency and its odd harmonics 1, 3, 5 of amplitude 1/h, in all channels alike.

    Each harmonic's phase is free in each record. What lies above the recorder's band is not recorded.
    """

    kind: ClassVar[str] = "mains_hum"
    family: ClassVar[Family] = "measurement"
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "H. W. Ott, Electromagnetic Compatibility Engineering (2009), chapter 3: ground loops"
    signature: ClassVar[Signature] = Signature(
        frequency="sharp lines at the mains frequency, 3 and 5 times it, whatever is excited",
        level="of one size, so that its share is largest at low level",
        time="steady through the record, before and after the motion too",
        place="all channels by the same amount, so most in the quiet ones",
    )
    record_parameters: ClassVar[Mapping[str, Parameter]] = {f"hum_phase_{h}": PHASE for h in HARMONICS}

    frequency: float = parameter("f_m", "Hz", lower=1.0, upper=1e3, spread=0.01)
    amplitude: float = parameter("a_m", "channel unit", lower=0.0, spread=3.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """At lines that the model leaves, those near 50 and 60 Hz first, else at these; 1 % of the acceleration."""
        size = 0.01 * scene.velocity**2 / scene.displacement
        seen = sorted(scene.lines, key=lambda frequency: not LIKELY[0] < frequency < LIKELY[1])
        for frequency in seen or (50.0, 60.0):
            yield cls(scene.place, frequency=frequency, amplitude=size)

    def change_channels(self, channels: FloatArray, measurement: Measurement) -> FloatArray:
        """The channels with the hum in them."""
        time = np.arange(channels.shape[1]) / measurement.fs
        hum = np.zeros_like(time)
        for h in HARMONICS:
            if h * self.frequency < STOP_EDGE * measurement.fs:
                phase = measurement.free.get(f"hum_phase_{h}", 0.0)
                hum += self.amplitude / h * np.cos(2.0 * pi * h * self.frequency * time + phase)
        return channels + hum

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"all the time, on all channels alike, whatever the rig does: lines at {self.frequency:.5g} Hz and 3 and "
            f"5 times that, of amplitude {self.amplitude:.3g}"
        )
