"""From the channels of a free decay to each mode's frequency and damping over time, and to what they depend on.

Denoise if asked to, cut out a band if asked to, find the modes, fit poles that stay to all channels at once, follow
every mode by the smoother and by the wavelet ridge, and ask whether it changes with amplitude or with time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from identification.decay.attempt import CHOSEN_NOTHING, Followed, Settings, best_attempt
from identification.decay.cause import Cause, Watched, find_cause
from identification.decay.course import integral_of
from identification.decay.own_scale import own_scale
from identification.decay.poles import Poles
from identification.decay.ridge import Skeleton, follow_mode
from identification.decay.smoother import Interval, SmoothedMode
from identification.progress import Progress
from identification.signals.denoise import Denoised, denoise_ensemble, denoise_wavelet
from identification.signals.peaks import Modes, cut_frequencies
from identification.signals.separate import separate
from models.arrays import ComplexArray, FloatArray
from models.errors import InputError

DENOISING = ("none", "wavelet", "ensemble")

MATERIAL = {"damping": 2e-3, "frequency": 2e-5}
"""Shares of a value by which its intervals have to part for it to change: less is of no use, and modes that nobody
counted bring it about."""

IMPOSSIBLE = 1e-6
"""Probability of a steady mode below which means of several decays that differ are a change."""

AROUND_RIDGE = 0.3
"""Of the window's width in frequency: what a mode may move by before its ridge is followed and not one frequency."""

OF_ITS_PEAK = 0.05
"""Share by which a mode's frequency may differ from that of the peak that shows it."""

HARDLY = 0.02
"""Np that a mode falls by over its decay at least, or it is told."""


@dataclass(frozen=True, eq=False)
class ModeInDecay:
    """One mode in one decay.

    Attributes:
        natural_freq, damping_ratio: of the pole where the mode stays; where it changes, means over the decay, each
            moment weighted by what it tells, Hz and -.
        natural_freq_std, damping_ratio_std: standard deviations of these.
        frequency, damping: both over time, Hz and -; of a mode that stays the pole's number with the pole's interval.
        shape: (n_channels,) complex amplitudes at the decay's first sample, in the channels' units.
        smoothed: what the blocks tell of frequency and damping over time, free to change.
        signal: (n_seen,) the mode alone, while it is seen, in the unit of the channel in which it is strongest.
        skeleton: the same course from the wavelet ridge.
        watched_decay, watched_turning: what the causes were asked about.
    """

    natural_freq: float
    damping_ratio: float
    natural_freq_std: float
    damping_ratio_std: float
    frequency: Interval
    damping: Interval
    shape: ComplexArray
    smoothed: SmoothedMode
    signal: FloatArray
    skeleton: Skeleton
    watched_decay: Watched
    watched_turning: Watched

    @property
    def ridge_freq(self) -> FloatArray:
        """(n_seen,) natural frequency along the ridge, whose own is damped, Hz."""
        return np.asarray(self.skeleton.frequency / np.sqrt(1.0 - self.damping_ratio**2))


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
    settings: Settings = CHOSEN_NOTHING,
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
    best = best_attempt(decays, starts, fs, kick_signs, settings, progress)
    cuts = _cuts(best.spectrum, best.decays[0].poles)
    found = [_decay(one, best.fs, cuts, progress) for one in best.decays]
    seen = [[decay.modes[m] for decay in found] for m in range(len(found[0].modes))]
    damping, frequency = (tuple(_cause(modes, what) for modes in seen) for what in MATERIAL)
    steady = [cause.verdict == "steady" for cause in damping], [cause.verdict == "steady" for cause in frequency]
    found = [_summed_up(decay, *steady) for decay in found]
    findings = [
        *best.findings,
        *(
            f"{mode.natural_freq:.4g} Hz hardly decays from {decay.start:.4g} s on: is it driven, or the mains?"
            for decay in found
            for mode in decay.modes
            if mode.smoothed.sigma * decay.signals.shape[1] / decay.fs < HARDLY
        ),
    ]
    return Identification(tuple(found), best.spectrum, cuts, denoised, damping, frequency, tuple(findings))


def _summed_up(decay: Decay, damping_steady: Sequence[bool], frequency_steady: Sequence[bool]) -> Decay:
    """With the pole's numbers for a mode that stays, which all of the decay has told at once."""
    poles, modes = decay.poles, list(decay.modes)
    for m, mode in enumerate(modes):
        if frequency_steady[m]:
            freq, std = float(poles.natural_freqs[m]), float(poles.natural_freq_stds[m])
            course = Interval.steady(mode.frequency.times, freq, std)
            modes[m] = mode = replace(mode, natural_freq=freq, natural_freq_std=std, frequency=course)  # noqa: PLW2901
        if damping_steady[m]:
            ratio, std = float(poles.damping_ratios[m]), float(poles.damping_ratio_stds[m])
            course = Interval.steady(mode.damping.times, ratio, std)
            modes[m] = replace(mode, damping_ratio=ratio, damping_ratio_std=std, damping=course)
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


def _cuts(spectrum: Modes, poles: Poles) -> FloatArray:
    """(n_modes - 1,) Hz, where the spectrum is lowest between the modes, or half way where they were named."""
    freqs, peaks = poles.natural_freqs, np.array([peak.frequency for peak in spectrum.peaks])
    if len(peaks) == len(freqs) and np.all(np.abs(peaks / freqs - 1.0) < OF_ITS_PEAK):
        return cut_frequencies(spectrum.peaks, spectrum.spectrum)
    return np.asarray(0.5 * (freqs[1:] + freqs[:-1]))


def _decay(followed: Followed, fs: float, cuts: FloatArray, progress: Progress) -> Decay:
    signals, poles = followed.signals, followed.poles
    modes = []
    for m, mode in enumerate(followed.modes):
        progress(f"mode {m + 1}: {mode.natural_freq.value[0]:.4g} Hz followed over {mode.decay.times[-1]:.3g} s")
        seen = int(np.ceil(mode.blocks.edges[-1] * fs))
        signal = _alone(signals, fs, poles, cuts, m)[:seen]
        modes.append(_mode(mode, signal, _ridge(signal, fs, mode), poles.shapes[m]))
    return Decay(followed.start, fs, signals, poles, tuple(modes))


def _alone(signals: FloatArray, fs: float, poles: Poles, cuts: FloatArray, mode: int) -> FloatArray:
    """(N,) one mode: the channels added up along its shape, in the strongest one's unit, then cut out of the others."""
    shape = poles.shapes[mode]
    turned = (shape * np.exp(-1j * np.angle(shape[np.argmax(np.abs(shape))]))).real
    weights = turned / poles.noise**2
    combined = weights @ signals * np.abs(turned).max() / float(weights @ turned)
    around = cuts[max(mode - 1, 0) : mode + 1]
    if not len(around):
        return np.asarray(combined)
    return np.asarray(separate(combined, fs, around)[min(mode, 1)])


def _ridge(signal: FloatArray, fs: float, mode: SmoothedMode) -> Skeleton:
    """The skeleton at the scale that suits the mode's course and noise."""
    blocks = mode.blocks
    time = np.arange(len(signal)) / fs
    share = np.interp(time, blocks.times, np.sqrt(0.5 * blocks.variances * np.diff(blocks.edges) * fs))
    turning = mode.turning.at(time) / (2.0 * np.pi)
    scale = own_scale(fs, float(np.median(turning)), mode.decay.at(time), share)
    steady = np.ptp(turning) < AROUND_RIDGE * fs / (2.0 * np.pi * scale)
    return follow_mode(signal, fs, float(np.median(turning)) if steady else turning, scale)


def _mode(mode: SmoothedMode, signal: FloatArray, skeleton: Skeleton, shape: ComplexArray) -> ModeInDecay:
    blocks = mode.blocks
    frequency, damping = mode.natural_freq, mode.damping_ratio
    (freq, freq_std), (ratio, ratio_std) = mode.mean_of(frequency), mode.mean_of(damping)
    log_amplitude = integral_of(mode.decay.times, mode.decay.rate, blocks.times)
    strongest = float(np.log(np.abs(blocks.shape).max()))
    scale = float(np.abs(mode.decay.rate).max())
    turning_scale = max(scale, float(np.ptp(mode.turning.rate)))
    return ModeInDecay(
        freq,
        ratio,
        freq_std,
        ratio_std,
        frequency,
        damping,
        shape,
        mode,
        signal,
        skeleton,
        Watched(mode.decay_points, log_amplitude + strongest, scale),
        Watched(mode.turning_points, log_amplitude + strongest, turning_scale),
    )
