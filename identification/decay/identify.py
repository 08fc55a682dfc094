"""From the channels of a free decay to each mode's frequency and damping over time, and to what they depend on.

Denoise if asked to, cut out a band if asked to, find the modes, fit poles that stay to all channels at once, follow
every mode by the smoother and by the wavelet ridge, and ask whether it changes with amplitude or with time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from identification.decay.cause import Cause, Watched, find_cause
from identification.decay.colour import left_over
from identification.decay.course import UNTOLD, Told, integral_of
from identification.decay.own_scale import own_scale
from identification.decay.poles import Poles, fit_poles
from identification.decay.ridge import Skeleton, follow_mode
from identification.decay.smoother import SmoothedMode, smooth_decay
from identification.progress import Progress
from identification.signals.denoise import Denoised, denoise_ensemble, denoise_wavelet
from identification.signals.peaks import Modes, cut_frequencies, find_modes
from identification.signals.separate import separate
from models.arrays import ComplexArray, FloatArray, IntArray
from models.errors import InputError

DENOISING = ("none", "wavelet", "ensemble")

RATE_PER_BAND = 2.6
"""Least sampling rate that is kept, in units of a band's upper edge."""

HEAVIEST = 0.5
"""A pole whose damping ratio is above this does not oscillate enough to be called a mode."""

STRAYED = 0.2
"""A pole that ends further than this share from the peak it began at is not that peak's."""

MOST_HIDDEN = 3
HIDDEN_DAMPING, HIDDEN_WIDTH, HIDDEN_APART = 0.1, 0.2, 0.1
"""A mode that no peak shows is looked for with this damping ratio, in what the others leave, smoothed over this share
of the lowest frequency; closer than the last share to another it is that other one, which changes."""

HIGHEST = 0.4
"""Share of the sampling rate up to which it is looked for."""

MATERIAL = {"damping": 2e-3, "frequency": 2e-5}
"""Shares of a value by which its intervals have to part for it to change: less is of no use, and modes that nobody
counted bring it about."""

AROUND_RIDGE = 0.3
"""Of the window's width in frequency: what a mode may move by before its ridge is followed and not one frequency."""

LEAST_PERIODS = 8.0
"""Of the lowest mode in a decay."""


@dataclass(frozen=True)
class Settings:
    """What the user chose.

    Attributes:
        band: Hz, the only band that is looked at; None for all of it.
        freqs: Hz, about where the modes are; found from the spectrum where none is given.
        denoising: one of ``DENOISING``, before all else.
        told: what is known of the courses' form.
        seed: of the ensemble's noise.
    """

    band: tuple[float, float] | None = None
    freqs: tuple[float, ...] = ()
    denoising: str = "none"
    told: Told = UNTOLD
    seed: int = 0


@dataclass(frozen=True, eq=False)
class ModeInDecay:
    """One mode in one decay.

    Attributes:
        natural_freq, damping_ratio: means over the decay, each moment weighted by what it tells, Hz and -.
        natural_freq_std, damping_ratio_std: of a mode that stays; of one that changes, of the mean.
        shape: (n_channels,) complex amplitudes at the decay's first sample, in the channels' units.
        smoothed: frequency and damping over time with intervals.
        skeleton: the same from the wavelet ridge.
        watched_decay, watched_turning: what the causes were asked about.
    """

    natural_freq: float
    damping_ratio: float
    natural_freq_std: float
    damping_ratio_std: float
    shape: ComplexArray
    smoothed: SmoothedMode
    skeleton: Skeleton
    watched_decay: Watched
    watched_turning: Watched


@dataclass(frozen=True, eq=False)
class Decay:
    """One free decay.

    Attributes:
        start: s from the record's first sample.
        fs: Hz, of the signals that were analysed.
        signals: (n_channels, N) as analysed.
        poles: modes that stay, all channels together.
        modes: in order of frequency.
    """

    start: float
    fs: float
    signals: FloatArray
    poles: Poles
    modes: tuple[ModeInDecay, ...]


@dataclass(frozen=True, eq=False)
class Identification:
    """All that a record's decays tell of its modes.

    Attributes:
        decays: in order of time.
        spectrum: the first decay's, with the peaks that were taken for modes.
        cuts: (n_modes - 1,) Hz, between the modes.
        denoised: what was taken away before, of each decay; empty where nothing was asked for.
        damping_causes, frequency_causes: of each mode, from all decays together.
        findings: what was decided and why, in words.
    """

    decays: tuple[Decay, ...]
    spectrum: Modes
    cuts: FloatArray
    denoised: tuple[Denoised, ...]
    damping_causes: tuple[Cause, ...]
    frequency_causes: tuple[Cause, ...]
    findings: tuple[str, ...] = field(default=())


def identify(
    decays: Sequence[FloatArray],
    starts: Sequence[float],
    fs: float,
    kick_signs: FloatArray,
    settings: Settings = Settings(),
    progress: Progress = lambda _: None,
) -> Identification:
    """Identify the modes of one or more free decays of the same channels.

    Args:
        decays: (n_channels, N) each.
        starts: s, when each begins in its record.
        fs: sampling rate, Hz.
        kick_signs: (n_channels,) 1 for displacements and accelerations, -1 for velocities.
        settings: what the user chose.
        progress: told what is being done.

    Raises:
        InputError: no mode stands out, a decay too short for its modes, or settings that do not fit.
    """
    decays, denoised = _denoised(decays, fs, settings, progress)
    spectrum = _in_band(find_modes(decays[0], fs), settings.band)
    decays, rate, findings = _band(decays, fs, settings)
    first = decays[0] - decays[0].mean(axis=1, keepdims=True)
    freqs, widths = _starting_points(spectrum, settings, first.shape[1] / rate)
    progress(f"{len(freqs)} modes: {', '.join(f'{freq:.4g}' for freq in freqs)} Hz")
    poles, kept = _fitted(first, rate, freqs, widths)
    findings += [f"the peak at {freq:.4g} Hz is no mode of the decay" for freq in np.delete(freqs, kept)]
    if not settings.freqs and settings.band is None:
        poles, hidden = _with_hidden(first, rate, poles)
        findings += [f"{freq:.4g} Hz is no peak, but what the others left rings there" for freq in hidden]
    cuts = _cuts(spectrum, poles)
    found = []
    for signals, start in zip(decays, starts, strict=True):
        level = _without_offset(signals, rate, poles)
        own = fit_poles(level, rate, poles.values)
        found.append(_decay(level, start, rate, own, cuts, kick_signs, settings, progress))
    seen = [[decay.modes[m] for decay in found] for m in range(len(poles.values))]
    damping, frequency = (tuple(_cause(modes, what) for modes in seen) for what in MATERIAL)
    return Identification(tuple(found), spectrum, cuts, denoised, damping, frequency, tuple(findings))


def _cause(modes: Sequence[ModeInDecay], what: str) -> Cause:
    """What a mode's ``damping`` or ``frequency`` depends on; steady where it changes by less than anybody can use."""
    damping = what == "damping"
    courses = [mode.smoothed.damping_ratio if damping else mode.smoothed.natural_freq for mode in modes]
    highest, lowest = max(course.low.max() for course in courses), min(course.high.min() for course in courses)
    cause = find_cause([mode.watched_decay if damping else mode.watched_turning for mode in modes])
    changes = highest - lowest > MATERIAL[what] * abs(highest)
    return cause if changes else replace(cause, verdict="steady", law=None)


def _denoised(
    decays: Sequence[FloatArray], fs: float, settings: Settings, progress: Progress
) -> tuple[list[FloatArray], tuple[Denoised, ...]]:
    if settings.denoising == "none":
        return list(decays), ()
    progress(f"denoising {len(decays[0])} channels ({settings.denoising})")
    if settings.denoising == "wavelet":
        cleaned = [denoise_wavelet(decay, fs) for decay in decays]
    elif settings.denoising == "ensemble":
        cleaned = [denoise_ensemble(decay, fs, seed=settings.seed) for decay in decays]
    else:
        raise InputError(
            f"denoising = {settings.denoising!r}", f"it is one of {', '.join(DENOISING)}", "name one of these"
        )
    return [one.signals for one in cleaned], tuple(cleaned)


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


def _starting_points(spectrum: Modes, settings: Settings, duration: float) -> tuple[FloatArray, FloatArray]:
    """(n,) frequencies and half-power widths to begin the fit from, Hz."""
    if settings.freqs:
        freqs = np.array(sorted(settings.freqs))
        return freqs, np.full(len(freqs), 1.0 / duration)
    if not spectrum.peaks:
        raise InputError(
            "a decay in which no mode stands out of the noise",
            "a mode is a peak of the spectrum that noise alone reaches in one of a thousand records",
            "name the modes with --mode, or the stretch with --from and --to",
        )
    return np.array([p.frequency for p in spectrum.peaks]), np.array([p.width for p in spectrum.peaks])


def _fitted(signals: FloatArray, fs: float, freqs: FloatArray, widths: FloatArray) -> tuple[Poles, IntArray]:
    """Poles that stay, and the peaks that they belong to; a peak that turns out to be no mode is dropped."""
    kept = np.arange(len(freqs))
    if signals.shape[1] / fs * freqs.min() < LEAST_PERIODS:
        raise InputError(
            f"a decay of {signals.shape[1] / fs:.3g} s for a mode at {freqs.min():.4g} Hz",
            f"a mode is followed over {LEAST_PERIODS:g} periods or more",
            "take a longer stretch, or leave the mode out with --band",
        )
    while True:
        begin = np.asarray(2.0 * np.pi * (1j * freqs[kept] - 0.5 * widths[kept]))
        poles = fit_poles(signals, fs, begin)
        astray = np.abs(poles.natural_freqs / freqs[kept] - 1.0) > STRAYED
        wrong = np.flatnonzero(astray | (poles.damping_ratios > HEAVIEST))
        if not len(wrong) or len(kept) == 1:
            return poles, kept
        kept = np.delete(kept, wrong[0])


def _without_offset(signals: FloatArray, fs: float, poles: Poles) -> FloatArray:
    """Without the channels' constants, told from the decay itself, whose mean is not 0."""
    waves = np.exp(poles.values[:, None] * np.arange(signals.shape[1]) / fs)
    basis = np.concatenate([waves.real, waves.imag, np.ones((1, signals.shape[1]))])
    numbers = np.linalg.lstsq(basis @ basis.T, basis @ signals.T, rcond=None)[0]
    return np.asarray(signals - numbers[-1][:, None])


def _with_hidden(signals: FloatArray, fs: float, poles: Poles) -> tuple[Poles, list[float]]:
    """The poles and those of heavily damped modes that no peak shows, each paid for by what it explains.

    Source: Schwarz, Ann. Stat. 6 (1978) 461, for what a further mode has to explain.
    """
    n_channels, n = signals.shape
    found: list[float] = []
    while len(found) < MOST_HIDDEN:
        waves = np.exp(poles.values[:, None] * np.arange(n) / fs)
        power = np.sum(np.abs(np.fft.rfft(left_over(signals, waves) / poles.noise[:, None], axis=1)) ** 2, axis=0)
        lines = np.fft.rfftfreq(n, 1.0 / fs)
        smooth = uniform_filter1d(power, max(round(HIDDEN_WIDTH * poles.natural_freqs[0] * n / fs), 3))
        inside = (lines > LEAST_PERIODS * fs / n) & (lines < HIGHEST * fs)
        freq = float(lines[inside][np.argmax(smooth[inside])])
        begin = np.append(poles.values, 2.0 * np.pi * freq * (1j - HIDDEN_DAMPING))
        try:
            more = fit_poles(signals, fs, begin)
        except InputError:
            break
        gain = n * float(np.sum(np.log(poles.noise / more.noise)))
        new = int(np.argmax(np.abs(more.values[:, None] - poles.values).min(axis=1)))
        apart = np.abs(np.delete(more.natural_freqs, new) / more.natural_freqs[new] - 1.0).min()
        sound = apart > HIDDEN_APART and 0.0 < more.damping_ratios[new] < HEAVIEST
        if gain < 0.5 * (2.0 + 2.0 * n_channels) * np.log(n_channels * n) or not sound:
            break
        found.append(float(more.natural_freqs[new]))
        poles = more
    return poles, found


def _cuts(spectrum: Modes, poles: Poles) -> FloatArray:
    """(n_modes - 1,) Hz, where the spectrum is lowest between the modes, or half way where they were named."""
    if len(spectrum.peaks) == len(poles.values):
        return cut_frequencies(spectrum.peaks, spectrum.spectrum)
    freqs = poles.natural_freqs
    return np.asarray(0.5 * (freqs[1:] + freqs[:-1]))


def _decay(
    signals: FloatArray,
    start: float,
    fs: float,
    poles: Poles,
    cuts: FloatArray,
    kick_signs: FloatArray,
    settings: Settings,
    progress: Progress,
) -> Decay:
    smoothed = smooth_decay(signals, fs, poles, kick_signs, settings.told)
    modes = []
    for m, mode in enumerate(smoothed):
        progress(f"mode {m + 1}: {mode.natural_freq.value[0]:.4g} Hz followed over {mode.decay.times[-1]:.3g} s")
        skeleton = _ridge(alone(signals, fs, poles, cuts, m), fs, mode)
        modes.append(_mode(mode, skeleton, poles, m))
    return Decay(start, fs, signals, poles, tuple(modes))


def alone(signals: FloatArray, fs: float, poles: Poles, cuts: FloatArray, mode: int) -> FloatArray:
    """(N,) one mode: the channels added up along its shape, in the strongest one's unit, then cut out of the others.

    Args:
        signals: (n_channels, N).
        fs: Hz.
        poles: of all modes.
        cuts: (n_modes - 1,) Hz, between the modes.
        mode: which.
    """
    shape = poles.shapes[mode]
    turned = (shape * np.exp(-1j * np.angle(shape[np.argmax(np.abs(shape))]))).real
    weights = turned / poles.noise**2
    combined = weights @ signals * np.abs(turned).max() / float(weights @ turned)
    around = cuts[max(mode - 1, 0) : mode + 1]
    if not len(around):
        return np.asarray(combined)
    return np.asarray(separate(combined, fs, around)[min(mode, 1)])


def _ridge(signal: FloatArray, fs: float, mode: SmoothedMode) -> Skeleton:
    """The skeleton at the scale that suits the mode's course and noise, for as long as the mode is seen."""
    blocks = mode.blocks
    seen = min(int(np.ceil(blocks.edges[-1] * fs)), len(signal))
    time = np.arange(seen) / fs
    share = np.interp(time, blocks.times, np.sqrt(0.5 * blocks.variances * np.diff(blocks.edges) * fs))
    turning = mode.turning.at(time) / (2.0 * np.pi)
    scale = own_scale(fs, float(np.median(turning)), mode.decay.at(time), share)
    steady = np.ptp(turning) < AROUND_RIDGE * fs / (2.0 * np.pi * scale)
    return follow_mode(signal[:seen], fs, float(np.median(turning)) if steady else turning, scale)


def _mode(mode: SmoothedMode, skeleton: Skeleton, poles: Poles, m: int) -> ModeInDecay:
    blocks = mode.blocks
    trust = 1.0 / blocks.variances
    log_amplitude = integral_of(mode.decay.times, mode.decay.rate, blocks.times)
    strongest = float(np.log(np.abs(blocks.shape).max()))
    scale = float(np.abs(mode.decay.rate).max())
    turning_scale = max(scale, float(np.ptp(mode.turning.rate)))
    return ModeInDecay(
        float(np.average(mode.natural_freq.at(blocks.times), weights=trust)),
        float(np.average(mode.damping_ratio.at(blocks.times), weights=trust)),
        float(poles.natural_freq_stds[m]),
        float(poles.damping_ratio_stds[m]),
        poles.shapes[m],
        mode,
        skeleton,
        Watched(mode.decay_points, log_amplitude + strongest, scale),
        Watched(mode.turning_points, log_amplitude + strongest, turning_scale),
    )
