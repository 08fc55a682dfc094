"""The spectra of a record's periods, and which of their lines are excited."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.ndimage import maximum_filter1d

from identification.frf import EXCITED_ABOVE_NOISE
from identification.period import find_period, split_periods
from models.arrays import BoolArray, ComplexArray, FloatArray
from models.band_limit import PAD, SCORE_EDGE
from models.record import Record

Plan = Literal["odd", "odd_detection", "mixed"]

MOST_BLOCKS = 32
"""Beyond so many periods neighbouring ones are averaged first: a sine of many cycles needs no more to be judged."""

PERIODS_TO_SPARE = 4
"""From so many on the last, of which the record's end belongs to, is not used."""

LEAST_PERIODS = 2
"""Periods that must be left: of one nothing is seen to repeat."""

NEARBY = 6
"""Lines to each side among which an excitation with detection lines has one that it excites."""

LOCAL_FLOOR = 1e-2
"""Power of a line, as a share of the strongest nearby, below which it was not meant to be excited."""

EXCITED_RANGE = 1e-4
"""The same as a share of the strongest of all, as far as a resonance takes the shaker's force away."""


@dataclass(frozen=True, eq=False)
class Periods:
    """The periods of a record on the lines above 0 Hz and below 0.35 fs.

    Spectra are scaled so that the squares of a period's lines add up to its mean square.

    Attributes:
        frequency: (K,) Hz.
        excitation: (M, K) each block's spectrum.
        responses: (M, n, K).
        excited: (K,) lines that the excitation was meant to reach.
        plan: odd lines alone, odd lines with detection lines among them, or lines of both kinds.
        samples: in one period.
        block: periods averaged in each of the M blocks.
        start: first sample of the first block.
        discarded: periods left out: those in which the excitation did not repeat yet, and the last.
    """

    frequency: FloatArray
    excitation: ComplexArray
    responses: ComplexArray
    excited: BoolArray
    plan: Plan
    samples: int
    block: int
    start: int
    discarded: int

    @property
    def n_blocks(self) -> int:
        """M."""
        return len(self.excitation)


def periods_of(record: Record) -> Periods | None:
    """The periods of a record, None where its excitation does not repeat or is not measured.

    Args:
        record: any.
    """
    period = None if record.excitation is None else find_period(record.excitation)
    if record.excitation is None or period is None or 2 * period > record.n_samples:
        return None
    steady = len(split_periods(record.excitation[None], period))
    # A recorder that filters a record both ways spoils its end, far below the response but not below its noise.
    end = record.n_samples - (PAD if steady >= PERIODS_TO_SPARE else 0)
    steady = min(steady, end // period)
    if steady < LEAST_PERIODS:
        return None
    block = -(-steady // MOST_BLOCKS)
    count = steady // block
    start = end - count * block * period
    spectra = _spectra(np.vstack([record.excitation, record.responses])[:, start:end], count, block, period)
    n_lines = spectra.shape[2]
    if n_lines == 0:
        return None
    excited = excited_lines(spectra[:, 0])
    if not excited.any():
        return None
    return Periods(
        frequency=np.arange(1, n_lines + 1) * record.fs / period,
        excitation=spectra[:, 0],
        responses=spectra[:, 1:],
        excited=excited,
        plan=_plan(excited),
        samples=period,
        block=block,
        start=start,
        discarded=record.n_samples // period - steady,
    )


def spectra_of(channels: FloatArray, periods: Periods) -> ComplexArray:
    """(M, n, K) spectra of other channels on the same periods.

    Args:
        channels: (n, N) as long as the record's.
        periods: of the record.
    """
    end = periods.start + periods.n_blocks * periods.block * periods.samples
    return _spectra(channels[:, periods.start : end], periods.n_blocks, periods.block, periods.samples)


def _spectra(channels: FloatArray, count: int, block: int, period: int) -> ComplexArray:
    """(count, n, K) of the means of blocks of periods."""
    means = channels.reshape(len(channels), count, block, period).mean(axis=2)
    last = int(np.ceil(SCORE_EDGE * period))
    return np.asarray(np.sqrt(2.0) / period * np.fft.rfft(means)[:, :, 1:last].swapaxes(0, 1))


def excited_lines(spectra: ComplexArray) -> BoolArray:
    """(K,) whether the excitation was meant to reach each line.

    A line that a shaker's own distortion or noise fills lies far below an excited one beside it; a line at which a
    resonance takes the shaker's force away has neighbours that are as weak.

    Args:
        spectra: (M, K) of the excitation's periods.
    """
    power = np.abs(spectra.mean(axis=0)) ** 2
    noise = float(np.median(np.var(spectra, axis=0, ddof=1))) / len(spectra)
    nearby = maximum_filter1d(power, 2 * NEARBY + 1, mode="nearest")
    least = max(EXCITED_RANGE * float(power.max()), EXCITED_ABOVE_NOISE * noise)
    reached = np.flatnonzero((power > LOCAL_FLOOR * nearby) & (power > least))
    # What lies beyond the end of a band, further down than a line's own floor, is the shaker's and not the band's.
    bands = np.split(reached, 1 + np.flatnonzero(np.diff(reached) > NEARBY))
    meant = [band for band in bands if band.size and power[band].max() > LOCAL_FLOOR * power.max()]
    excited = np.zeros(len(power), bool)
    excited[np.concatenate(meant) if meant else []] = True
    return excited


def _plan(excited: BoolArray) -> Plan:
    numbers = 1 + np.flatnonzero(excited)
    if np.any(numbers % 2 == 0):
        return "mixed"
    return "odd" if np.all(np.diff(numbers) == 2) else "odd_detection"
