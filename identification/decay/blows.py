"""When something strikes the rig, told piece by piece from the force, or from the channels where there is none."""

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from identification.decay.free import LOOK_BACK, LOUD, ONSET, QUIET_SHARE, acting_level
from identification.decay.poles import Poles
from models.arrays import FloatArray

REMEMBERED = 200
"""Pieces of force from whose levels the quiet one is taken."""

FORESEEN = 0.1
"""Share of the motion's amplitude up to which a forecast may fail, since damping changes."""

TINY = float(np.finfo(float).tiny)


@dataclass(eq=False)
class ForceWatch:
    """Tells blows by the force: it acts where it exceeds its quiet level, or a share of its peak so far.

    ``identification.decay.free`` does the same with a whole record. A force that is never quiet acts throughout.
    """

    _levels: deque[float] = field(default_factory=lambda: deque(maxlen=REMEMBERED))
    _peak: float = 0.0
    _loudest: float = 0.0

    def see(self, force: FloatArray) -> int | None:
        """Where in a piece the force acts last, or None.

        Args:
            force: (n,) that follows the last piece's, N.
        """
        level = float(np.sqrt(np.mean(force**2)))
        self._levels.append(level)
        self._peak = max(self._peak, float(np.abs(force).max()))
        self._loudest = max(self._loudest, level)
        quiet = float(np.percentile(self._levels, QUIET_SHARE))
        acting = np.flatnonzero(np.abs(force) > acting_level(quiet, self._loudest, self._peak))
        return int(acting[-1]) if acting.size else None


@dataclass(eq=False)
class ChannelWatch:
    """Tells blows by the power of the channels, as long as no mode is known by which to foresee it.

    A blow is told where a piece has ``ONSET`` times the power of those before it; pieces of an eighth of the lowest
    mode's period look back over half an oscillation. Weaker blows are not seen, and none that lasts beyond two pieces.

    Attributes:
        piece: samples.
    """

    piece: int
    _powers: deque[float] = field(default_factory=lambda: deque(maxlen=LOOK_BACK))
    _loudest: float = 0.0
    _open: bool = False

    def see(self, channels: FloatArray) -> int | None:
        """Where in a block the last blow may act last, or None.

        Args:
            channels: (n_channels, n) that follow the last block's, n a whole number of pieces.
        """
        last = None
        for start in range(0, channels.shape[1], self.piece):
            part = channels[:, start : start + self.piece]
            power = float(np.mean(part**2))
            onset = bool(self._powers) and power > ONSET * max(self._powers) and power > LOUD * self._loudest
            if onset or self._open:  # a blow that begins late in a piece ends in the next one
                last = start + part.shape[1] - 1
            self._open = onset
            self._powers.append(power)
            self._loudest = max(self._loudest, power)
        return last


@dataclass(frozen=True, eq=False)
class Forecast:
    """How the channels go on unless something strikes the rig.

    Attributes:
        poles: of a window.
        first: number of the window's first sample.
        fs: sampling rate, Hz.
    """

    poles: Poles
    first: int
    fs: float

    def surprise(self, channels: FloatArray, first: int, piece: int) -> int | None:
        """Where in a block a blow may act last that strikes in it, or None.

        A blow is told by a piece in which what was not foreseen has ``ONSET`` times the power of noise and of a tenth
        of the motion. It lasts for two pieces at most.

        Args:
            channels: (n_channels, n) from sample number ``first`` on, n a whole number of pieces.
            first: number of the sample.
            piece: samples.
        """
        time = (first - self.first + np.arange(channels.shape[1])) / self.fs
        shapes = self.poles.shapes
        expected = np.real(shapes.T @ np.exp(self.poles.values[:, None] * time))
        motion = 0.5 * (np.abs(shapes.T) ** 2 @ np.exp(2.0 * self.poles.values.real[:, None] * time))
        allowed = self.poles.noise[:, None] ** 2 + FORESEEN**2 * motion
        power = np.mean((channels - expected) ** 2 / np.maximum(allowed, TINY), axis=0)
        struck = np.flatnonzero(power.reshape(-1, piece).mean(axis=1) > ONSET)
        return int((struck[0] + 2) * piece - 1) if struck.size else None
