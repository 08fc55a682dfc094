"""A floor that shakes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi
from typing import ClassVar, Self

import numpy as np

from models.arrays import FloatArray
from models.effects.protocol import Effect, Family, Parameter, Scene, Signature, StructureKind, parameter

PHASE = Parameter("phi", "rad", lower=-pi, upper=pi, scale="linear", spread=2.0)


@dataclass(frozen=True)
class BaseMotion(Effect):
    """Clamp and sleeves shake together at one frequency from the record's start; the phase is free in each record."""

    kind: ClassVar[str] = "base_motion"
    family: ClassVar[Family] = "measurement"
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "R. W. Clough, J. Penzien, Dynamics of Structures (1993), section 2.5: support excitation"
    signature: ClassVar[Signature] = Signature(
        frequency="one line that the excitation does not hold, larger near a resonance",
        level="of one size, so that its share is largest at low level",
        time="from the record's start, steady once the beam's own motion has died out",
        place="all channels: the floor's acceleration and the beam's answer, shaped like the beam",
    )
    record_parameters: ClassVar[Mapping[str, Parameter]] = {"base_phase": PHASE}

    frequency: float = parameter("f_b", "Hz", lower=0.1, upper=1e4, spread=1.0, step=1e-5)
    amplitude: float = parameter("a_b", "m/s^2", lower=0.0, spread=3.0, neutral=0.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """At the lines that the model leaves, else at its natural frequencies; 1 % of the motion's acceleration."""
        size = 0.01 * scene.velocity**2 / scene.displacement
        for frequency in scene.lines or scene.natural_freqs:
            yield cls(scene.place, frequency=frequency, amplitude=size)

    def base_acceleration(self, time: FloatArray, free: Mapping[str, float]) -> FloatArray:
        """Acceleration of clamp and sleeves, m/s^2."""
        return np.asarray(self.amplitude * np.cos(2.0 * pi * self.frequency * time + free.get("base_phase", 0.0)))

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"all the time, whatever the excitation does: clamp and sleeves shake with {self.amplitude:.3g} m/s^2 at "
            f"{self.frequency:.5g} Hz"
        )
