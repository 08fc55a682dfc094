"""Where the missing force acts and what shape it has, as values."""

from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class FreedChannel:
    """What one channel's own free signal would explain.

    Attributes:
        sensor: its name.
        explained: share of the misfit beyond the noise.
        left: what it leaves of the other channels, over the noise.
    """

    sensor: str
    explained: float
    left: float


@dataclass(frozen=True, eq=False)
class PlacedForce:
    """The force at the most likely place, alone and free in time, and the motion there.

    Attributes:
        record: name.
        fs: Hz.
        q, v: (N,) m and m/s.
        force: (N,) N, in the band in which it can be told.
        told: (lines,) share of it that is told at each line.
    """

    record: str
    fs: float
    q: FloatArray
    v: FloatArray
    force: FloatArray
    told: FloatArray

    @property
    def time(self) -> FloatArray:
        """(N,) s."""
        return np.arange(len(self.force)) / self.fs


@dataclass(frozen=True, eq=False)
class Curve:
    """The force as a function of one quantity.

    Attributes:
        of: the quantity in words.
        x: (n_bins,) its means in bins.
        mean: (n_bins,) force there, N, what the other quantities explain taken out.
        error: (n_bins,) standard error of the mean, N.
    """

    of: str
    x: FloatArray
    mean: FloatArray
    error: FloatArray


@dataclass(frozen=True, eq=False)
class Shape:
    """What the force follows.

    Attributes:
        explained: share of the force's power, in blocks of time kept aside, by quantity or quantities.
        words: the reading, a sentence each.
        curves: of the force over displacement (from the place's middle), velocity and acceleration; of its size over
            time and over the amplitude of the displacement.
        middle: the place's middle, m: of its sleeve, or where the beam is in the mean.
        samples: the force in each record, the band in which it is not told filled by what it follows.
    """

    explained: tuple[tuple[str, float], ...]
    words: tuple[str, ...]
    curves: tuple[Curve, ...]
    samples: tuple[PlacedForce, ...]
    middle: float


@dataclass(frozen=True, eq=False)
class Located:
    """Where one force, free in time, would have to act to explain what the calibrated model leaves.

    Attributes:
        positions: (n_positions,) m from the clamp, ascending.
        explained: (n_positions,) share of the misfit beyond the noise that a force there explains.
        channels: the same for a signal on each channel.
        nothing: what the model leaves, over the noise, with laws at the motion that the channels tell.
        left: the same with the most likely force, or without the most likely channel.
        place: most likely position, m; None where nothing is missing, or a channel is told.
        interval: of the places that are not told from it, m.
        sleeve: at the place, if one is in the interval.
        sensor: the channel in which the misfit lies instead.
        share: explained there.
        enough: whether it reaches the noise.
        words: all this in a sentence.
        forces: at the place, one a record.
        shape: of the force; None where there is none.
    """

    positions: FloatArray
    explained: FloatArray
    channels: tuple[FreedChannel, ...]
    nothing: float
    left: float
    place: float | None
    interval: tuple[float, float] | None
    sleeve: str | None
    sensor: str | None
    share: float
    enough: bool
    words: str
    forces: tuple[PlacedForce, ...]
    shape: Shape | None

    def holds(self, position: float) -> bool:
        """Whether a position, m from the clamp, is told as the place or not told from it."""
        return self.interval is not None and self.interval[0] <= position <= self.interval[1]

    @property
    def where(self) -> str:
        """The place or channel in short; empty where none is told, or the misfit is at more than one place."""
        if not self.enough or (self.place is None and self.sensor is None):
            return ""
        return self.sensor or self.sleeve or f"{self.place:.3g} m"
