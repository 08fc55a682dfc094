"""What drives the rigs: multisines, sweeps, bursts and steady noise, each of rms 1, and a hammer."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar, Literal, Protocol

import numpy as np

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.excitations import Lines, faded, half_sine_hammer, logarithmic_sweep, random_phase_multisine

Phases = Literal["random", "schroeder"]

LOW = 5.0
"""Hz, lower end of the excited band."""

BLOW_AT = 0.1
"""s from the record's start, or from that of a blow's turn."""

DECAY_SECONDS = 8.0
"""Of the record of the hammer, however many its blows."""


STEADY_TELLS = 4.0
"""s of a wave that is everywhere the same, by which a rig is looked at; the whole tells the same and takes longer."""


class Wave(Protocol):
    """A force over time."""

    @property
    def telling(self) -> float:
        """First seconds, in which it has done all that it does."""
        ...

    def draw(self, fs: float, top: float, rng: np.random.Generator) -> FloatArray:
        """(N,) one of rms 1.

        Args:
            fs: Hz.
            top: upper end of the band, Hz.
            rng: draws what is left open.
        """
        ...


@dataclass(frozen=True)
class Multisine:
    """Periods of equal sines.

    Attributes:
        phases: random, or Schroeder's of a low crest.
        lines: of its period's spectrum that are excited.
        period: s.
        duration: s, whole periods.
    """

    phases: Phases
    lines: Lines
    period: float
    duration: float
    telling: ClassVar[float] = STEADY_TELLS

    def draw(self, fs: float, top: float, rng: np.random.Generator) -> FloatArray:
        """As ``Wave`` has it."""
        n_periods, period = round(self.duration / self.period), round(self.period * fs)
        if self.phases == "random":
            return random_phase_multisine(rng, fs, period * n_periods, n_periods, LOW, top, 1.0, self.lines)
        return np.tile(schroeder_multisine(fs, period, LOW, top, self.lines, rng), n_periods)


@dataclass(frozen=True)
class Sweep:
    """Sines that grow by equal ratios in equal times through the band, or fall.

    Attributes:
        duration: s.
        sweeps: how often it runs through the band in that time.
    """

    duration: float
    sweeps: int = 1

    @property
    def telling(self) -> float:
        """As ``Wave`` has it: once through the band."""
        return self.duration / self.sweeps

    def draw(self, fs: float, top: float, rng: np.random.Generator) -> FloatArray:
        """As ``Wave`` has it."""
        one = logarithmic_sweep(fs, round(self.duration / self.sweeps * fs), LOW, top, 1.0)
        return _of_rms_1(np.tile(one if rng.random() < 0.5 else one[::-1], self.sweeps))


@dataclass(frozen=True)
class Bursts:
    """Random noise, each time another, and silence after it.

    Attributes:
        duration: s.
        turns: how many bursts.
        share: of a turn that is not silent; all of it is steady noise.
    """

    duration: float
    turns: int
    share: float
    telling: ClassVar[float] = STEADY_TELLS

    def draw(self, fs: float, top: float, rng: np.random.Generator) -> FloatArray:
        """As ``Wave`` has it; noise is a multisine that never comes again, faded in and out over a tenth each."""
        turn = round(self.duration / self.turns * fs)
        loud = round(self.share * turn)
        fade = faded(np.minimum(np.arange(loud), np.arange(loud)[::-1]) / (0.1 * loud))
        silence = np.zeros(turn - loud)
        bursts = [fade * random_phase_multisine(rng, fs, loud, 1, LOW, top, 1.0) for _ in range(self.turns)]
        return _of_rms_1(np.concatenate([part for burst in bursts for part in (burst, silence)]))


def schroeder_multisine(
    fs: float, period: int, low: float, high: float, lines: Lines, rng: np.random.Generator
) -> FloatArray:
    """(period,) a sum of equal sines whose phases -pi k (k - 1) / K keep its crest low, of rms 1.

    It runs up or down the band, and begins where it passes 0 straight.

    Args:
        fs: Hz.
        period: samples.
        low: lower end of the band, Hz.
        high: upper end, Hz.
        lines: all of the spectrum, or the odd ones only.
        rng: draws the direction.

    Source: M. R. Schroeder, IEEE Trans. Inf. Theory 16 (1970) 85, eq. (11).
    """
    freq = np.arange(period // 2 + 1) * fs / period
    excited = np.flatnonzero((freq >= low) & (freq <= high))
    if lines != "full":
        excited = excited[excited % 2 == 1]
    k = np.arange(1, len(excited) + 1)
    phases = -pi * k * (k - 1) / len(k) * (1.0 if rng.random() < 0.5 else -1.0)
    spectrum = np.zeros(len(freq), complex)
    spectrum[excited] = np.exp(1j * phases)
    wave = np.fft.irfft(spectrum, period)
    bend = np.roll(wave, 1) - 2.0 * wave + np.roll(wave, -1)
    return _of_rms_1(np.roll(wave, -int(np.argmin(wave**2 + bend**2))))


def draw_blows(fs: float, width: float, turns: int) -> FloatArray:
    """(N,) blows of a hammer with peaks of about 1, and what follows each; band-limited like any true force.

    Args:
        fs: Hz.
        width: of a blow, s.
        turns: how many blows share the time equally.
    """
    one = half_sine_hammer(fs, round(DECAY_SECONDS / turns * fs), BLOW_AT, width, 1.0)
    blows = np.tile(one, turns)
    return np.asarray(record_channels(blows[None], 1, len(blows), fs)[0])


def _of_rms_1(wave: FloatArray) -> FloatArray:
    return np.asarray(wave / np.sqrt(np.mean(wave**2)))
