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
from identification.decay.course import NORMAL_95, UNTOLD, Told, integral_of
from identification.decay.own_scale import own_scale
from identification.decay.poles import Poles, fit_poles
from identification.decay.ridge import Skeleton, follow_mode
from identification.decay.smoother import Interval, SmoothedMode, smooth_decay
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

SPLIT, CLOSEST, NEAR, LEFT, LEAST_NEAR = 0.015, 5e-3, 0.05, 2.0, 8
"""A pole is split at this distance to either side, into modes that differ by the second share at least, where what is
left within the third of it is denser than around by this factor; on fewer lines than the last nothing is split."""

NAMED_DAMPING = 0.01
"""Damping ratio from which a named mode is begun."""

HIGHEST = 0.4
"""Share of the sampling rate up to which it is looked for."""

MATERIAL = {"damping": 2e-3, "frequency": 2e-5}
"""Shares of a value by which its intervals have to part for it to change: less is of no use, and modes that nobody
counted bring it about."""

IMPOSSIBLE = 1e-6
"""Probability of a steady mode below which means of several decays that differ are a change."""

AROUND_RIDGE = 0.3
"""Of the window's width in frequency: what a mode may move by before its ridge is followed and not one frequency."""

OTHER = 0.05
"""Share by which a mode's frequency may differ between the decays of one record."""

HARDLY = 0.02
"""Np that a mode falls by over its decay at least, or it is told."""

SAME = 0.03
"""Share of its frequency within which a peak is the mode that was named."""

PRICE_OF_FIRST = 3.0
"""What a mode without a peak has to explain, in multiples of Schwarz's price: noise has many lines to choose from."""

LEAST_PERIODS = 8.0
"""Of the lowest mode in a decay."""


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


@dataclass(frozen=True, eq=False)
class ModeInDecay:
    """One mode in one decay.

    Attributes:
        natural_freq, damping_ratio: of the pole where the mode stays; where it changes, means over the decay, each
            moment weighted by what it tells, Hz and -.
        natural_freq_std, damping_ratio_std: standard deviations of these.
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
    freqs, widths = _starting_points(spectrum, settings, first, rate)
    progress(f"{len(freqs)} modes: {', '.join(f'{freq:.4g}' for freq in freqs)} Hz")
    poles, kept = _fitted(first, rate, freqs, widths, settings.freqs)
    findings += [f"there is no mode about {freq:.4g} Hz" for freq in np.delete(freqs, kept)]
    poles, split = _split(first, rate, poles)
    findings += [f"{freq:.4g} Hz is two modes: one leaves too much beside it" for freq in split]
    poles, missing = _with_named(first, rate, poles, settings.freqs)
    findings += [f"there is no mode about {freq:.4g} Hz beside those found" for freq in missing]
    poles, hidden = _with_hidden(first, rate, poles, settings.band)
    findings += [f"{freq:.4g} Hz is no peak, but what the others left rings there" for freq in hidden]
    cuts = _cuts(spectrum, poles)
    found = []
    for signals, start in zip(decays, starts, strict=True):
        level = _without_offset(signals, rate, poles)
        own = fit_poles(level, rate, poles.values)
        if (np.abs(own.natural_freqs / poles.natural_freqs - 1.0) > OTHER).any():
            findings.append(f"the decay from {start:.4g} s on does not show all of the first one's modes; left out")
            continue
        found.append(_decay(level, start, rate, own, cuts, kick_signs, settings, progress))
    seen = [[decay.modes[m] for decay in found] for m in range(len(poles.values))]
    damping, frequency = (tuple(_cause(modes, what) for modes in seen) for what in MATERIAL)
    steady = [cause.verdict == "steady" for cause in damping], [cause.verdict == "steady" for cause in frequency]
    found = [_summed_up(decay, *steady) for decay in found]
    findings += [
        f"{mode.natural_freq:.4g} Hz hardly decays from {decay.start:.4g} s on: is it driven, or the mains?"
        for decay in found
        for mode in decay.modes
        if mode.smoothed.sigma * decay.signals.shape[1] / decay.fs < HARDLY
    ]
    return Identification(tuple(found), spectrum, cuts, denoised, damping, frequency, tuple(findings))


def _summed_up(decay: Decay, damping_steady: Sequence[bool], frequency_steady: Sequence[bool]) -> Decay:
    """With the pole's numbers for a mode that stays, which all of the decay has told at once."""
    poles, modes = decay.poles, list(decay.modes)
    for m, mode in enumerate(modes):
        if frequency_steady[m]:
            freq, std = float(poles.natural_freqs[m]), float(poles.natural_freq_stds[m])
            modes[m] = mode = replace(mode, natural_freq=freq, natural_freq_std=std)  # noqa: PLW2901
        if damping_steady[m]:
            ratio, std = float(poles.damping_ratios[m]), float(poles.damping_ratio_stds[m])
            modes[m] = replace(mode, damping_ratio=ratio, damping_ratio_std=std)
    return replace(decay, modes=tuple(modes))


def _cause(modes: Sequence[ModeInDecay], what: str) -> Cause:
    """What a mode's ``damping`` or ``frequency`` depends on; steady where it changes by less than anybody can use."""
    damping = what == "damping"
    courses = [mode.smoothed.damping_ratio if damping else mode.smoothed.natural_freq for mode in modes]
    highest, lowest = max(course.low.max() for course in courses), min(course.high.min() for course in courses)
    cause = find_cause([mode.watched_decay if damping else mode.watched_turning for mode in modes])
    means = [mode.damping_ratio if damping else mode.natural_freq for mode in modes]
    parted = max(highest - lowest, float(np.ptp(means)) if cause.probabilities["steady"] < IMPOSSIBLE else 0.0)
    return cause if parted > MATERIAL[what] * abs(highest) else replace(cause, verdict="steady", law=None)


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


def _starting_points(
    spectrum: Modes, settings: Settings, signals: FloatArray, fs: float
) -> tuple[FloatArray, FloatArray]:
    """(n,) frequencies and half-power widths to begin the fit from, Hz: the peaks, or else those that are named."""
    low, high = LEAST_PERIODS * fs / signals.shape[1], 0.5 * fs
    for freq in settings.freqs:
        if not low <= freq < high:
            raise InputError(
                f"a mode about {freq:g} Hz",
                f"modes of a decay of {signals.shape[1] / fs:.3g} s at {fs:.4g} Hz lie from {low:.3g} to {high:.4g} Hz",
                "name another frequency with --mode, or take a longer stretch",
            )
    named = [(freq, fs / signals.shape[1]) for freq in sorted(settings.freqs)]
    seen = [(peak.frequency, peak.width) for peak in spectrum.peaks]
    freqs, widths = np.array(seen or named or [_strongest_line(signals, fs, settings.band)]).T
    return freqs, widths


def _inside(band: tuple[float, float] | None, fs: float) -> tuple[float, float]:
    """Frequencies between which a mode without a peak is looked for, away from where a band was cut, Hz."""
    if band is None:
        return 0.0, HIGHEST * fs
    return band[0] * (1.0 + HIDDEN_APART), band[1] * (1.0 - HIDDEN_APART)


def _strongest_line(signals: FloatArray, fs: float, band: tuple[float, float] | None) -> tuple[float, float]:
    """Frequency and width of what rings most where no peak stands out, if a heavily damped mode explains it.

    Raises:
        InputError: none does.
    """
    n = signals.shape[1]
    low, high = _inside(band, fs)
    lines = np.fft.rfftfreq(n, 1.0 / fs)
    power = np.sum(np.abs(np.fft.rfft(signals, axis=1)) ** 2, axis=0)
    smooth = uniform_filter1d(power, 5)
    inside = (lines > max(low, LEAST_PERIODS * fs / n)) & (lines < high)
    freq = float(lines[inside][np.argmax(smooth[inside])]) if inside.any() else 0.0
    if freq > 0.0:
        one = fit_poles(signals, fs, [2.0 * np.pi * freq * (1j - HIDDEN_DAMPING)])
        gain = n * float(np.sum(np.log(signals.std(axis=1) / one.noise)))
        sound = 0.0 < one.damping_ratios[0] < HEAVIEST and abs(one.natural_freqs[0] / freq - 1.0) < STRAYED
        if sound and gain > PRICE_OF_FIRST * _price(signals.shape):
            return float(one.natural_freqs[0]), 2.0 * float(one.natural_freqs[0] * one.damping_ratios[0])
    where = "" if band is None else f" between {band[0]:g} and {band[1]:g} Hz"
    raise InputError(
        f"a decay in which no mode stands out of the noise{where}",
        "a mode is a peak of the spectrum that noise alone reaches in one of a thousand records, or rings by itself",
        "name the modes with --mode, or another stretch with --from and --to",
    )


def _fitted(
    signals: FloatArray, fs: float, freqs: FloatArray, widths: FloatArray, named: Sequence[float]
) -> tuple[Poles, IntArray]:
    """Poles that stay, and the frequencies that they began from; one that leads to no mode is dropped."""
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
        explained = _explained(signals.shape, fs, poles)
        faint = np.isin(freqs[kept], named) & (explained < _price(signals.shape))
        wrong = np.flatnonzero(astray | faint | (poles.damping_ratios > HEAVIEST))
        if not len(wrong):
            return poles, kept
        if len(kept) == 1:
            went = f"{poles.natural_freqs[0]:.4g} Hz with a damping ratio of {poles.damping_ratios[0]:.2g}"
            raise InputError(
                f"no mode about {freqs[kept[0]]:.4g} Hz",
                f"the fit that began there went to {went}, or explains no more than noise would",
                "name another frequency with --mode, or leave it out",
            )
        kept = np.delete(kept, wrong[np.argmin(explained[wrong])])


def _with_named(signals: FloatArray, fs: float, poles: Poles, named: Sequence[float]) -> tuple[Poles, list[float]]:
    """The poles with those named that are modes, and the frequencies about which there is none."""
    missing: list[float] = []
    for freq in sorted(named):
        if np.abs(poles.natural_freqs / freq - 1.0).min() < SAME:
            continue
        try:
            more = fit_poles(signals, fs, np.append(poles.values, 2.0 * np.pi * freq * (1j - NAMED_DAMPING)))
        except InputError:
            missing.append(freq)
            continue
        gain = signals.shape[1] * float(np.sum(np.log(poles.noise / more.noise)))
        new = int(np.argmax(np.abs(more.values[:, None] - poles.values).min(axis=1)))
        near = abs(more.natural_freqs[new] / freq - 1.0) < STRAYED and 0.0 < more.damping_ratios[new] < HEAVIEST
        if near and gain > _price(signals.shape):
            poles = more
        else:
            missing.append(freq)
    return poles, missing


def _explained(size: tuple[int, ...], fs: float, poles: Poles) -> FloatArray:
    """(n_modes,) log-likelihood that each mode brings by itself: half its energy over the noise's."""
    energy = 0.5 * np.sum(np.exp(2.0 * poles.values.real[:, None] * np.arange(size[1]) / fs), axis=1)
    return np.asarray(0.5 * energy * np.sum(np.abs(poles.shapes) ** 2 / poles.noise**2, axis=1))


def _price(size: tuple[int, ...]) -> float:
    """What a further mode has to explain. Source: Schwarz, Ann. Stat. 6 (1978) 461."""
    return float((1.0 + size[0]) * np.log(size[0] * size[1]))


def _split(signals: FloatArray, fs: float, poles: Poles) -> tuple[Poles, list[float]]:
    """The poles, those of them in two that are two modes nearer than their peaks can be told apart.

    Two modes are taken for one if they leave nothing there beyond the noise around, and differ in frequency: a mode
    that changes leaves more, or splits into one frequency twice.
    """
    found: list[float] = []
    for freq in poles.natural_freqs.tolist():
        if _left_at(signals, fs, poles, freq) < LEFT:
            continue
        m = int(np.argmin(np.abs(poles.natural_freqs - freq)))
        pole = complex(poles.values[m])
        pair = [1j * pole.imag * (1.0 + side * SPLIT) + 0.5 * pole.real for side in (-1.0, 1.0)]
        try:
            more = fit_poles(signals, fs, [*np.delete(poles.values, m), *pair])
        except InputError:
            continue
        gaps = np.diff(more.natural_freqs) / more.natural_freqs[:-1]
        sound = gaps.min() > CLOSEST and more.damping_ratios.min() > 0.0 and more.damping_ratios.max() < HEAVIEST
        if sound and _left_at(signals, fs, more, freq) < LEFT:
            found.append(freq)
            poles = more
    return poles, found


def _left_at(signals: FloatArray, fs: float, poles: Poles, freq: float) -> float:
    """How dense what the poles leave is about a frequency, in multiples of its density around."""
    n = signals.shape[1]
    waves = np.exp(poles.values[:, None] * np.arange(n) / fs)
    left = left_over(signals, waves)
    power = np.sum(np.abs(np.fft.rfft(left / poles.noise[:, None], axis=1)) ** 2, axis=0)
    lines = np.fft.rfftfreq(n, 1.0 / fs)
    near = np.abs(lines / freq - 1.0) < NEAR
    around = (np.abs(np.log2(np.maximum(lines, 1e-9) / freq)) < 1.0) & ~near
    for other in poles.natural_freqs:
        around &= np.abs(lines / other - 1.0) > NEAR
    if np.count_nonzero(near) < LEAST_NEAR or np.count_nonzero(around) < LEAST_NEAR:
        return 0.0
    return float(np.mean(power[near]) / np.mean(power[around]))


def _without_offset(signals: FloatArray, fs: float, poles: Poles) -> FloatArray:
    """Without the channels' constants, told from the decay itself, whose mean is not 0."""
    waves = np.exp(poles.values[:, None] * np.arange(signals.shape[1]) / fs)
    basis = np.concatenate([waves.real, waves.imag, np.ones((1, signals.shape[1]))])
    numbers = np.linalg.lstsq(basis @ basis.T, basis @ signals.T, rcond=None)[0]
    return np.asarray(signals - numbers[-1][:, None])


def _with_hidden(
    signals: FloatArray, fs: float, poles: Poles, band: tuple[float, float] | None
) -> tuple[Poles, list[float]]:
    """The poles and those of heavily damped modes that no peak shows, each paid for by what it explains."""
    n = signals.shape[1]
    low, high = _inside(band, fs)
    found: list[float] = []
    while len(found) < MOST_HIDDEN:
        waves = np.exp(poles.values[:, None] * np.arange(n) / fs)
        power = np.sum(np.abs(np.fft.rfft(left_over(signals, waves) / poles.noise[:, None], axis=1)) ** 2, axis=0)
        lines = np.fft.rfftfreq(n, 1.0 / fs)
        smooth = uniform_filter1d(power, max(round(HIDDEN_WIDTH * poles.natural_freqs[0] * n / fs), 3))
        inside = (lines > max(low, LEAST_PERIODS * fs / n)) & (lines < high)
        freq = float(lines[inside][np.argmax(smooth[inside])])
        begin = np.append(poles.values, 2.0 * np.pi * freq * (1j - HIDDEN_DAMPING))
        try:
            more = fit_poles(signals, fs, begin)
        except InputError:
            break
        gain = n * float(np.sum(np.log(poles.noise / more.noise)))
        new = int(np.argmax(np.abs(more.values[:, None] - poles.values).min(axis=1)))
        apart = np.abs(np.delete(more.natural_freqs, new) / more.natural_freqs[new] - 1.0).min()
        within = low < more.natural_freqs[new] < high
        sound = within and apart > HIDDEN_APART and 0.0 < more.damping_ratios[new] < HEAVIEST
        if gain < _price(signals.shape) or not sound:
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


def _std_of_mean(course: Interval, times: FloatArray, trust: FloatArray) -> float:
    """Of a weighted mean along a course, its errors taken to be the same everywhere: an upper bound."""
    half = np.interp(times, course.times, 0.5 * (course.high - course.low))
    return float(np.average(half, weights=trust)) / NORMAL_95


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
        _std_of_mean(mode.natural_freq, blocks.times, trust),
        _std_of_mean(mode.damping_ratio, blocks.times, trust),
        poles.shapes[m],
        mode,
        skeleton,
        Watched(mode.decay_points, log_amplitude + strongest, scale),
        Watched(mode.turning_points, log_amplitude + strongest, turning_scale),
    )
