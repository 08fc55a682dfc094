"""A small oscillator that hangs on the structure: a cable, a loose fixture, a tuned mass."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, log
from typing import ClassVar, Self

import numpy as np

from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, StructureKind, parameter
from models.structure import Absorber as Attached
from models.structure import Structure

WIDEST, MOST_STEPS = 2.0**0.5, 6
"""Ratio of two neighbouring frequencies that are tried, at most, unless it takes more steps from mode to mode."""

SLOWEST = 5e-3
"""Share of the sixth natural frequency below which a mode is one of what the structure hangs on; of a cantilever the
first is 0.012 of it."""


@dataclass(frozen=True)
class Absorber(Effect):
    """A mass on a spring and a dashpot, with its frequency and damping ratio as on a fixed base, weight included."""

    kind: ClassVar[str] = "absorber"
    family: ClassVar[Family] = "structure"
    places: ClassVar[tuple[PlaceKind, ...]] = ("position",)
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")
    source: ClassVar[str] = "J. P. Den Hartog, Mechanical Vibrations (1956), section 3.2"
    signature: ClassVar[Signature] = Signature(
        frequency="one resonance becomes two about the absorber's own frequency, or shows a notch there",
        level="the same at every level",
        time="a free decay beats as energy goes there and back; alike through the record",
        place="modes that move at its place; in the notch the beam stands still there",
    )
    unique: ClassVar[bool] = False

    mass: float = parameter("m_a", "kg", lower=0.0, neutral=0.0)
    frequency: float = parameter("f_a", "Hz", lower=1e-3, spread=1.0)
    damping_ratio: float = parameter("zeta_a", "-", lower=1e-4, upper=2.0, spread=1.0)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """2 % of the structure's mass, damped by 2 %, in half octaves from half the first frequency of vibration.

        Modes that are driven move off theirs as sleeves are met, and what hangs on a structure need not be tuned to it.
        """
        mass = 0.02 * scene.structure.line_mass * (scene.structure.length or 1.0)
        for frequency in _filled(scene.natural_freqs):
            yield cls(scene.place, mass=mass, frequency=frequency, damping_ratio=0.02)

    def change_structure(self, structure: Structure) -> Structure:
        """The structure with the oscillator on it."""
        hung = Attached(self.place.position, self.mass, self.frequency, self.damping_ratio)
        return replace(structure, absorbers=(*structure.absorbers, hung)) if self.mass > 0.0 else structure

    def in_words(self) -> str:
        """When it acts and what it does."""
        return (
            f"at every amplitude, near {self.frequency:.4g} Hz: {self.mass:.3g} kg on a spring move against the "
            f"structure there (damping ratio {self.damping_ratio:.2g}), and one resonance becomes two"
        )


def _filled(natural_freqs: Sequence[float]) -> Iterator[float]:
    """Half of the first frequency, Hz, then the frequencies and some between them.

    As many as leave no gap wider than half an octave, in ``MOST_STEPS`` from one to the next at most.
    A structure that nothing holds, or that is about to buckle, has modes at next to no frequency; they are left out.
    """
    held = [freq for freq in natural_freqs if freq > SLOWEST * natural_freqs[-1]]
    for low, high in pairwise((0.5 * held[0], *held) if held else ()):
        n = min(ceil(log(high / low) / log(WIDEST)), MOST_STEPS)
        yield from np.geomspace(low, high, n, endpoint=False).tolist()
    yield from held[-1:]
