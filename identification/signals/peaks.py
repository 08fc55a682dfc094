"""Modes of a free decay: the peaks of its spectrum that stand out of noise and of stronger modes' skirts.

Besides the whole record its first quarter and first sixteenth are looked at, for modes that have died by then stand
out better there. A peak is a mode where noise alone would not reach it (the false-alarm probability is per record),
where the valleys beside it are deeper than noise makes them, and where it exceeds the skirts of every stronger mode:
several knocks in one record, or a frequency that moves, make ripples on those skirts.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.signal import find_peaks, peak_widths

from identification.signals.spectrum import SummedSpectrum, summed_spectrum
from models.arrays import FloatArray
from models.errors import InputError

FALSE_ALARM = 1e-3
"""Chance that a record of noise alone shows a mode."""

PARTS = (1, 4, 16)
"""The record is looked at over its whole length and over its first part of so many."""

LEAST_CYCLES = 8.0
"""Periods that a part must hold for its lines to show a mode."""

BAND_EDGE = 0.45
"""Share of the sampling rate up to which modes are looked for: above it the anti-aliasing filter shapes the noise."""

LEAST_SAMPLES = 512
"""Samples of the shortest part: its floor needs a hundred lines."""

CLOSEST = 0.03
"""Peaks closer than this share of their frequency are one mode whose frequency moves."""

PROMINENCE = 2.0
"""dB from a peak down to the higher of the valleys that part it from stronger ones; 1 % damping leaves it at 5 %."""

CLEAR = 4.0
"""The same in roots of the power, whose standard deviation under noise is 0.7 whatever the power."""

SKIRT_RING = (0.03, 0.08)
"""Distances from a mode, in shares of its frequency, at which its skirt is measured."""

ABOVE_SKIRTS = 6.0
"""A mode has this many times the power of stronger modes' skirts: ripples of equal knocks reach four times."""

FLAT = 2.0
"""Between two modes, powers within this factor of the lowest are as low as it."""

MOST = 12


@dataclass(frozen=True)
class Peak:
    """A mode seen in the spectrum.

    Attributes:
        frequency: Hz.
        level: dB above the floor.
        width: Hz, between the points of half power, where the window's own width is 1.4 over the part's length.
        drop: dB from the first half of the record to the second; about 0 for a steady tone such as mains hum.
        false_alarm: chance that noise alone reaches this level anywhere in the record.
        part: 1 where the whole record shows it, 4 or 16 where its first quarter or sixteenth does.
    """

    frequency: float
    level: float
    width: float
    drop: float
    false_alarm: float
    part: int


@dataclass(frozen=True, eq=False)
class Modes:
    """The modes of a record and what they were seen in.

    Attributes:
        peaks: the modes by frequency.
        spectrum: of the whole record.
        part_spectra: of the record's beginnings, the longest first.
    """

    peaks: tuple[Peak, ...]
    spectrum: SummedSpectrum
    part_spectra: tuple[SummedSpectrum, ...]


def find_modes(
    signals: FloatArray,
    fs: float,
    *,
    band: tuple[float, float] | None = None,
    most: int = MOST,
    false_alarm: float = FALSE_ALARM,
) -> Modes:
    """Find the modes of a free decay that begins with the record.

    Args:
        signals: (n_channels, N).
        fs: sampling rate, Hz.
        band: Hz, where to look; from ``LEAST_CYCLES`` per record to ``BAND_EDGE`` of fs where none is given.
        most: modes returned at most, the highest above the floor.
        false_alarm: chance that a record of noise alone shows a mode.

    Raises:
        InputError: a size that does not fit, a dead channel, a record too short or a band without lines.
    """
    low, high = _checked(signals, fs, band)
    parts = [part for part in PARTS if signals.shape[1] >= part * LEAST_SAMPLES]
    spectra = []
    found: list[Peak] = []
    for part in parts:
        size = signals.shape[1] // part
        lowest = max(low, LEAST_CYCLES * fs / size)
        if lowest >= 0.5 * high:
            break
        spectrum = summed_spectrum(signals[:, :size], fs, (lowest, high), false_alarm / len(parts))
        spectra.append(spectrum)
        unresolved = 2.0 * spectrum.resolution if part > 1 else 0.0
        for line, width in _lines(spectrum):
            frequency, level = _top(spectrum, line)
            if all(abs(frequency - o.frequency) > max(CLOSEST * o.frequency, unresolved) for o in found):
                chance = min(len(parts) * spectrum.false_alarm(float(spectrum.power[line])), 1.0)
                found.append(Peak(frequency, level, width, _drop(signals, fs, frequency), chance, part))
    strongest = sorted(found, key=lambda peak: -peak.level)[:most]
    return Modes(tuple(sorted(strongest, key=lambda peak: peak.frequency)), spectra[0], tuple(spectra[1:]))


def cut_frequencies(peaks: tuple[Peak, ...], spectrum: SummedSpectrum) -> FloatArray:
    """(n_modes - 1,) Hz, between each two neighbouring modes the frequency where the spectrum is lowest.

    The spectrum is smoothed over a tenth of the gap, and of all that lies within ``FLAT`` of its lowest the frequency
    nearest to the modes' geometric mean is taken, so that in a wide gap the noise does not decide.

    Args:
        peaks: the modes by frequency.
        spectrum: of the whole record.
    """
    cuts = []
    for lower, upper in pairwise(peaks):
        between = (spectrum.frequency > lower.frequency) & (spectrum.frequency < upper.frequency)
        smooth = max(round(0.1 * np.count_nonzero(between)), 1)
        power, frequency = (
            np.convolve(values[between], np.full(smooth, 1.0 / smooth), mode="valid")
            for values in (spectrum.power, spectrum.frequency)
        )
        lowest = frequency[power <= FLAT * power.min()]
        cuts.append(lowest[np.argmin(np.abs(np.log(lowest**2 / (lower.frequency * upper.frequency))))])
    return np.array(cuts, dtype=float)


def _checked(signals: FloatArray, fs: float, band: tuple[float, float] | None) -> tuple[float, float]:
    if signals.ndim != 2 or signals.shape[1] < LEAST_SAMPLES or not np.all(np.isfinite(signals)):
        raise InputError(
            f"signals of size {signals.shape}",
            f"they are (n_channels, N) finite samples, N {LEAST_SAMPLES} or more",
            "pass one row per channel and a longer record",
        )
    for i, row in enumerate(signals):
        if np.ptp(row) == 0.0:
            raise InputError(f"signals[{i}] is {row[0]:g} throughout", "a mode moves", "leave the dead channel out")
    lowest, highest = LEAST_CYCLES * fs / signals.shape[1], BAND_EDGE * fs
    low, high = band or (lowest, highest)
    if not lowest <= 2.0 * max(low, lowest) < min(high, highest):
        raise InputError(
            f"a band from {low:g} to {high:g} Hz",
            f"it spans an octave or more between {lowest:g} and {highest:g} Hz",
            "widen the band or take a longer record",
        )
    return max(low, lowest), min(high, highest)


def _lines(spectrum: SummedSpectrum) -> list[tuple[int, float]]:
    """The lines that are modes, the strongest first, and their widths in Hz."""
    power, frequency = spectrum.power, spectrum.frequency
    level = 10.0 * np.log10(power)
    at, found = find_peaks(level, height=10.0 * np.log10(spectrum.threshold), prominence=PROMINENCE)
    valley = power[at] * 10.0 ** (-found["prominences"] / 10.0)
    clear = np.sqrt(spectrum.shape) * (np.sqrt(power[at]) - np.sqrt(valley)) > CLEAR
    widths = peak_widths(power, at)[0] * spectrum.step
    modes: list[tuple[int, float]] = []
    skirts = np.zeros_like(power)
    for i in np.argsort(-power[at]):
        line = int(at[i])
        apart = all(abs(frequency[line] - frequency[j]) >= CLOSEST * frequency[line] for j, _ in modes)
        if clear[i] and apart and power[line] > ABOVE_SKIRTS * skirts[line]:
            modes.append((line, float(widths[i])))
            skirts += _skirt(spectrum, line)
    return modes


def _skirt(spectrum: SummedSpectrum, line: int) -> FloatArray:
    """(n_lines,) power that falls with the squared distance from the mode, sized on its quieter side."""
    distance = spectrum.frequency - spectrum.frequency[line]
    share = distance / spectrum.frequency[line]
    sized = spectrum.power * distance**2
    rings = [(SKIRT_RING[0] < side * share) & (side * share < SKIRT_RING[1]) for side in (-1.0, 1.0)]
    size = min((float(np.median(sized[ring])) for ring in rings if np.any(ring)), default=0.0)
    return np.asarray(size / np.maximum(distance**2, spectrum.step**2))


def _top(spectrum: SummedSpectrum, line: int) -> tuple[float, float]:
    """Frequency in Hz and level in dB of the parabola through the line and its neighbours."""
    before, here, after = 10.0 * np.log10(spectrum.power[line - 1 : line + 2])
    shift = 0.5 * (before - after) / (before - 2.0 * here + after)
    return float(spectrum.frequency[line] + shift * spectrum.step), float(here - 0.25 * (before - after) * shift)


def _drop(signals: FloatArray, fs: float, frequency: float) -> float:
    half = signals.shape[1] // 2
    time = np.arange(half)
    turn = np.cos(0.5 * np.pi * time / half) ** 2 * np.exp(-2j * np.pi * frequency / fs * time)
    halves = signals[:, :half], signals[:, half : 2 * half]
    first, second = (float(np.sum(np.abs(part @ turn) ** 2)) for part in halves)
    return 10.0 * float(np.log10(first / second)) if second > 0.0 else np.inf
