"""One attempt at a record's decays: find the modes, fit their poles, follow them, and leave out what is not told.

Where as many modes are lost as are told, the decays are begun later too: a beginning that does not ring in modes, since
something strikes there, hides those that ring after it. The begin that lets most modes be followed is taken, the
earliest of equals.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.linalg import LinAlgError

from identification.decay.course import UNTOLD, Told
from identification.decay.followed import why_untold
from identification.decay.mode_search import LEAST_PERIODS, search_modes
from identification.decay.poles import Poles, fit_poles
from identification.decay.smoother import SmoothedMode, follow_modes
from identification.decay.starts import widened_by_decays, widened_by_starts
from identification.progress import Progress
from identification.signals.peaks import LEAST_SAMPLES, Modes, find_modes
from identification.signals.separate import separate
from models.arrays import FloatArray
from models.errors import InputError

RATE_PER_BAND = 2.6
"""Least sampling rate that is kept, in units of a band's upper edge."""

OTHER = 0.05
"""Share by which a mode's frequency may differ between the decays of one record."""

LATER = (1.0, 2.0, 4.0, 8.0)
"""Periods of the lowest mode that later begins leave out."""


@dataclass(frozen=True)
class Settings:
    """What the user chose.

    Attributes:
        band: Hz, the only band that is looked at; None for all of it.
        freqs: Hz, about where modes are, besides those that the spectrum shows.
        denoising: one of ``DENOISING``, before all else.
        told: what is known of the courses' form.
        seed: of the ensemble's noise.
    """

    band: tuple[float, float] | None = None
    freqs: tuple[float, ...] = ()
    denoising: str = "none"
    told: Told = UNTOLD
    seed: int = 0


CHOSEN_NOTHING = Settings()


@dataclass(frozen=True, eq=False)
class Followed:
    """The modes of one decay that are told.

    Attributes:
        start: s from the record's first sample.
        signals: (n_channels, N) as analysed.
        poles: of the modes told.
        modes: as they were followed.
    """

    start: float
    signals: FloatArray
    poles: Poles
    modes: tuple[SmoothedMode, ...]


@dataclass(frozen=True, eq=False)
class Attempt:
    """The decays from one begin on.

    Attributes:
        fs: Hz, of the signals that were analysed.
        spectrum: of the first decay.
        lowest: Hz, of all modes that were found.
        decays: those that show the first one's modes.
        untold: of each mode that was left out, why.
        findings: what was decided and why, in words.
    """

    fs: float
    spectrum: Modes
    lowest: float
    decays: tuple[Followed, ...]
    untold: tuple[str, ...]
    findings: tuple[str, ...]

    @property
    def n_told(self) -> int:
        """Modes that are told."""
        return len(self.decays[0].modes) if self.decays else 0


def best_attempt(
    decays: Sequence[FloatArray],
    starts: Sequence[float],
    fs: float,
    kick_signs: FloatArray,
    settings: Settings,
    progress: Progress,
) -> Attempt:
    """The modes from the begin that lets most of them be followed.

    Args:
        decays: (n_channels, N) each, denoised where that was asked for.
        starts: s, when each begins in its record.
        fs: Hz.
        kick_signs: (n_channels,), see ``kick_of``.
        settings: what the user chose.
        progress: told what is being done.

    Raises:
        InputError: no mode stands out, a decay too short for its modes, settings that do not fit, or no mode that can
            be followed from any begin.
    """
    try:
        best = _attempt(decays, starts, fs, kick_signs, settings, progress)
    except LinAlgError as error:
        raise InputError(
            "modes that cannot be computed: a matrix is singular",
            "the modes of a decay differ from one another and ring for several periods",
            "name the modes with --mode, look at one band with --band, or begin later with --from",
        ) from error
    longest = min(signals.shape[1] for signals in decays) - LEAST_SAMPLES
    begins = [int(np.ceil(periods * fs / best.lowest)) for periods in LATER]
    for begin in begins:
        if len(best.untold) < max(best.n_told, 1) or begin > longest:
            break
        progress(f"{len(best.untold)} modes cannot be followed; begun {begin / fs:.3g} s later")
        later = [start + begin / fs for start in starts]
        try:
            trial = _attempt([signals[:, begin:] for signals in decays], later, fs, kick_signs, settings, progress)
        except (InputError, LinAlgError):
            continue
        if trial.n_told > best.n_told:
            told = f"begun {begin / fs:.3g} s later: what rings before cannot be followed as modes that decay"
            best = replace(trial, findings=(told, *trial.findings))
    if not best.n_told:
        raise InputError(
            "; ".join(best.untold or best.findings),
            f"a mode is told that is followed over {LEAST_PERIODS:g} periods, or while it falls by 30 dB",
            "begin later with --from, look at one band with --band, strike more softly, or measure with less noise",
        )
    return replace(best, findings=(*best.findings, *best.untold))


def _attempt(
    decays: Sequence[FloatArray],
    starts: Sequence[float],
    fs: float,
    kick_signs: FloatArray,
    settings: Settings,
    progress: Progress,
) -> Attempt:
    spectrum = _in_band(find_modes(decays[0], fs), settings.band)
    decays, rate, findings = _band(decays, fs, settings)
    first = decays[0] - decays[0].mean(axis=1, keepdims=True)
    poles, decided = search_modes(first, rate, spectrum, settings.freqs, settings.band)
    findings += decided
    progress(f"{len(poles.values)} modes: {', '.join(f'{freq:.4g}' for freq in poles.natural_freqs)} Hz")
    shown = []
    for signals, start in zip(decays, starts, strict=True):
        level = _without_offset(signals, rate, poles)
        own = fit_poles(level, rate, poles.values)
        if (np.abs(own.natural_freqs / poles.natural_freqs - 1.0) > OTHER).any():
            findings.append(f"the decay from {start:.4g} s on does not show all of the first one's modes; left out")
            continue
        modes = follow_modes(level, rate, own, kick_signs, settings.told)
        shown.append((start, level, widened_by_starts(level, rate, own), modes))
    widened = widened_by_decays([own for _, _, own, _ in shown])
    reasons: dict[int, str] = {}
    for (start, level, _, modes), own in zip(shown, widened, strict=True):
        for m, mode in enumerate(modes):
            why = why_untold(mode, own, m, np.abs(level).max(axis=1))
            if why is not None and m not in reasons:
                when = f" in the decay from {start:.4g} s on" if len(shown) > 1 else ""
                reasons[m] = f"not told: {own.natural_freqs[m]:.4g} Hz{when}: {why}"
    kept = [m for m in range(len(poles.values)) if m not in reasons]
    followed = tuple(
        Followed(start, level, own.only(kept), tuple(mode for m in kept if (mode := modes[m]) is not None))
        for (start, level, _, modes), own in zip(shown, widened, strict=True)
    )
    lowest = float(poles.natural_freqs[0])
    return Attempt(rate, spectrum, lowest, followed, tuple(reasons[m] for m in sorted(reasons)), tuple(findings))


def _band(decays: Sequence[FloatArray], fs: float, settings: Settings) -> tuple[list[FloatArray], float, list[str]]:
    """The decays with nothing but the band, at the rate that it needs."""
    if settings.band is None:
        return list(decays), fs, []
    low, high = settings.band
    if not 0.0 <= low < high < 0.5 * fs:
        raise InputError(
            f"a band from {low:g} to {high:g} Hz",
            f"it lies between 0 and half the sampling rate, {0.5 * fs:g} Hz, and begins below its end",
            "name its lower edge first",
        )
    edges = np.array([low, high]) if low > 0.0 else np.array([high])
    step = max(int(fs / (RATE_PER_BAND * high)), 1)
    parts = [separate(decay, fs, edges)[-2][:, ::step] for decay in decays]
    return parts, fs / step, [f"cut out {low:g} to {high:g} Hz by analytical mode decomposition, ends predicted"]


def _in_band(found: Modes, band: tuple[float, float] | None) -> Modes:
    """What was found in a band alone."""
    if band is None:
        return found
    return replace(found, peaks=tuple(peak for peak in found.peaks if band[0] < peak.frequency < band[1]))


def _without_offset(signals: FloatArray, fs: float, poles: Poles) -> FloatArray:
    """Without the channels' constants, told from the decay itself, whose mean is not 0."""
    waves = poles.waves(signals.shape[1], fs)
    basis = np.concatenate([waves.real, waves.imag, np.ones((1, signals.shape[1]))])
    numbers = np.linalg.lstsq(basis @ basis.T, basis @ signals.T, rcond=None)[0]
    return np.asarray(signals - numbers[-1][:, None])
