"""The modes of a decay that keep frequency and damping: the peaks of its spectrum, and those that it does not show.

Poles are begun from the peaks. A pole that leaves too much beside it is tried as two; modes that are named, and heavily
damped ones that ring in what the others leave, are added where they explain more than they cost.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from identification.decay.colour import left_over
from identification.decay.poles import Poles, fit_poles
from identification.signals.peaks import Modes
from models.arrays import FloatArray, IntArray
from models.errors import InputError

Band = tuple[float, float] | None
"""Hz, the only band that is looked at, cut out of the record before; None for all of it."""

HEAVIEST = 0.5
"""A pole whose damping ratio is above this does not oscillate enough to be called a mode."""

SURE = 2.0
"""Standard deviations of their difference that two frequencies are apart, or they are one."""

GROWTH = 1.0
"""Np that a mode may grow by over a decay, by error."""

STRAYED = 0.2
"""A pole that ends further than this share from the peak it began at is not that peak's."""

MOST_HIDDEN, TRIED = 6, 6
HIDDEN_DAMPING, HIDDEN_WIDTH, HIDDEN_APART = 0.1, 0.2, 0.1
"""So many modes that no peak shows are looked for at most, from so many lines each, with this damping ratio, in what
the others leave, smoothed over this share of the lowest frequency; closer than the last share to another it is that
other one, which changes.
"""

SPLIT, CLOSEST, NEAR, LEFT, LEAST_NEAR = 0.015, 5e-3, 0.05, 2.0, 8
"""A pole is split at this distance to either side, into modes that differ by the second share at least, where what is
left within the third of it is denser than around by this factor; on fewer lines than the last nothing is split."""

HIGHEST = 0.4
"""Share of the sampling rate up to which a mode without a peak is looked for."""

NAMED_DAMPING = 0.01
"""Damping ratio from which a named mode is begun."""

SAME = 0.03
"""Share of its frequency within which a peak is the mode that was named."""

PRICE_OF_FIRST = 3.0
"""What a mode without a peak has to explain, in multiples of Schwarz's price: noise has many lines to choose from."""

LEAST_PERIODS = 8.0
"""Of the lowest mode in a decay."""


def search_modes(
    signals: FloatArray, fs: float, spectrum: Modes, named: Sequence[float], band: Band
) -> tuple[Poles, list[str]]:
    """All modes of a decay as poles that stay, and what was decided on the way, in words.

    Args:
        signals: (n_channels, N) without their means.
        fs: sampling rate, Hz.
        spectrum: with the peaks in the band.
        named: Hz, about where modes are besides those that the spectrum shows.
        band: what was cut out.

    Raises:
        InputError: no mode stands out, or a name that no mode of this decay can have.
    """
    freqs, widths = _starting_points(spectrum, named, band, signals, fs)
    poles, kept = _fitted(signals, fs, freqs, widths, named)
    findings = [f"there is no mode about {freq:.4g} Hz" for freq in np.delete(freqs, kept)]
    poles, split = _split(signals, fs, poles)
    findings += [f"{freq:.4g} Hz is two modes: one leaves too much beside it" for freq in split]
    poles, missing = _with_named(signals, fs, poles, named)
    findings += [f"there is no mode about {freq:.4g} Hz beside those found" for freq in missing]
    poles, hidden = _with_hidden(signals, fs, poles, band)
    findings += [f"{freq:.4g} Hz is no peak, but what the others left rings there" for freq in hidden]
    poles, one = _told_apart(signals, fs, poles)
    findings += [f"{first:.5g} and {second:.5g} Hz are not told apart; one mode" for first, second in one]
    return poles, findings


def _starting_points(
    spectrum: Modes, named: Sequence[float], band: Band, signals: FloatArray, fs: float
) -> tuple[FloatArray, FloatArray]:
    """(n,) frequencies and half-power widths to begin the fit from, Hz: the peaks, or else those that are named."""
    low, high = LEAST_PERIODS * fs / signals.shape[1], 0.5 * fs
    for freq in named:
        if not low <= freq < high:
            raise InputError(
                f"a mode about {freq:g} Hz",
                f"modes of a decay of {signals.shape[1] / fs:.3g} s at {fs:.4g} Hz lie from {low:.3g} to {high:.4g} Hz",
                "name another frequency with --mode, or take a longer stretch",
            )
    asked = [(freq, fs / signals.shape[1]) for freq in sorted(named)]
    seen = [(peak.frequency, peak.width) for peak in spectrum.peaks]
    freqs, widths = np.array(seen or asked or [_strongest_line(signals, fs, band)]).T
    return freqs, widths


def _inside(band: Band, fs: float) -> tuple[float, float]:
    """Frequencies between which a mode without a peak is looked for, away from where a band was cut, Hz."""
    if band is None:
        return 0.0, HIGHEST * fs
    return band[0] * (1.0 + HIDDEN_APART), band[1] * (1.0 - HIDDEN_APART)


def _loudest_lines(lines: FloatArray, power: FloatArray, band: Band, fs: float, most: int = 1) -> list[float]:
    """Where the power is largest, away from where a band was cut and where a mode has its least periods, Hz.

    Besides the largest, others follow that are the largest away from those before.
    """
    low, high = _inside(band, fs)
    inside = (lines > max(low, LEAST_PERIODS * (lines[1] - lines[0]))) & (lines < high)
    found: list[float] = []
    while inside.any() and len(found) < most:
        found.append(float(lines[inside][np.argmax(power[inside])]))
        inside &= np.abs(lines / found[-1] - 1.0) > HIDDEN_WIDTH
    return found


def _strongest_line(signals: FloatArray, fs: float, band: Band) -> tuple[float, float]:
    """Frequency and width of what rings most where no peak stands out, if a heavily damped mode explains it.

    Raises:
        InputError: none does.
    """
    lines, power = _spectrum(signals, fs)
    for freq in _loudest_lines(lines, uniform_filter1d(power, 5), band, fs):
        one = fit_poles(signals, fs, [2.0 * np.pi * freq * (1j - HIDDEN_DAMPING)])
        gain = signals.shape[1] * float(np.sum(np.log(signals.std(axis=1) / one.noise)))
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


def _split(signals: FloatArray, fs: float, poles: Poles) -> tuple[Poles, list[float]]:
    """The poles, those of them in two that are two modes nearer than their peaks can be told apart.

    Two modes are taken for one if they leave nothing there beyond the noise around, and differ in frequency: a mode
    that changes leaves more, or splits into one frequency twice.
    """
    found: list[float] = []
    left = _left(signals, fs, poles)
    for freq in poles.natural_freqs.tolist():
        if _density(*left, poles, freq) < LEFT:
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
        less = _left(signals, fs, more)
        if sound and _density(*less, more, freq) < LEFT:
            found.append(freq)
            poles, left = more, less
    return poles, found


def _spectrum(signals: FloatArray, fs: float) -> tuple[FloatArray, FloatArray]:
    """(n_lines,) Hz, and the channels' power there."""
    power = np.sum(np.abs(np.fft.rfft(signals, axis=1)) ** 2, axis=0)
    return np.asarray(np.fft.rfftfreq(signals.shape[1], 1.0 / fs)), np.asarray(power)


def _left(signals: FloatArray, fs: float, poles: Poles) -> tuple[FloatArray, FloatArray]:
    """(n_lines,) Hz, and the power of what poles leave, every channel's over its noise."""
    left = left_over(signals, poles.waves(signals.shape[1], fs))
    return _spectrum(left / poles.noise[:, None], fs)


def _density(lines: FloatArray, power: FloatArray, poles: Poles, freq: float) -> float:
    """How dense what poles leave is about a frequency, in multiples of its density around."""
    near = np.abs(lines / freq - 1.0) < NEAR
    around = (np.abs(np.log2(np.maximum(lines, 1e-9) / freq)) < 1.0) & ~near
    for other in poles.natural_freqs:
        around &= np.abs(lines / other - 1.0) > NEAR
    if np.count_nonzero(near) < LEAST_NEAR or np.count_nonzero(around) < LEAST_NEAR:
        return 0.0
    return float(np.mean(power[near]) / np.mean(power[around]))


def _with_named(signals: FloatArray, fs: float, poles: Poles, named: Sequence[float]) -> tuple[Poles, list[float]]:
    """The poles with those named that are modes, and the frequencies about which there is none."""
    missing: list[float] = []
    for freq in sorted(named):
        if np.abs(poles.natural_freqs / freq - 1.0).min() < SAME:
            continue
        further = _one_more(signals, fs, poles, 2.0 * np.pi * freq * (1j - NAMED_DAMPING))
        if further is not None and abs(further.freq / freq - 1.0) < STRAYED:
            poles = further.poles
        else:
            missing.append(freq)
    return poles, missing


@dataclass(frozen=True, eq=False)
class _Further:
    """Poles with one more, its frequency in Hz, and its distance from the nearest other as a share of it."""

    poles: Poles
    freq: float
    apart: float


def _one_more(signals: FloatArray, fs: float, poles: Poles, start: complex) -> _Further | None:
    """The poles with one more, begun from ``start``, if it is a mode and explains what it costs."""
    try:
        more = fit_poles(signals, fs, np.append(poles.values, start))
    except InputError:
        return None
    gain = signals.shape[1] * float(np.sum(np.log(poles.noise / more.noise)))
    new = int(np.argmax(np.abs(more.values[:, None] - poles.values).min(axis=1)))
    grows = float(more.values.real.max()) * signals.shape[1] / fs > GROWTH
    if (
        gain < _price(signals.shape)
        or grows
        or not (more.damping_ratios[new] > 0.0 and more.damping_ratios.max() < HEAVIEST)
    ):
        return None
    freq = float(more.natural_freqs[new])
    return _Further(more, freq, float(np.abs(np.delete(more.natural_freqs, new) / freq - 1.0).min()))


def _with_hidden(signals: FloatArray, fs: float, poles: Poles, band: Band) -> tuple[Poles, list[float]]:
    """The poles and those of heavily damped modes that no peak shows, each paid for by what it explains."""
    low, high = _inside(band, fs)
    found: list[float] = []
    while len(found) < MOST_HIDDEN:
        lines, power = _left(signals, fs, poles)
        width = max(round(HIDDEN_WIDTH * poles.natural_freqs[0] / (lines[1] - lines[0])), 3)
        starts = _loudest_lines(lines, uniform_filter1d(power, width), band, fs, TRIED)
        tried = (_one_more(signals, fs, poles, 2.0 * np.pi * freq * (1j - HIDDEN_DAMPING)) for freq in starts)
        sound = (one for one in tried if one and one.apart > HIDDEN_APART and low < one.freq < high)
        further = next(sound, None)
        if further is None:
            break
        found.append(further.freq)
        poles = further.poles
    return poles, found


def _told_apart(signals: FloatArray, fs: float, poles: Poles) -> tuple[Poles, list[tuple[float, float]]]:
    """The poles, the stronger of each two that errors or the decay's length do not tell apart, and those pairs."""
    one: list[tuple[float, float]] = []
    while len(poles.values) > 1:
        order = np.argsort(poles.natural_freqs)  # poles are ordered by how fast they turn
        freqs, stds = poles.natural_freqs, poles.natural_freq_stds[order]
        errors = np.hypot(stds[1:], stds[:-1])
        near = np.flatnonzero(np.diff(freqs[order]) < np.maximum(SURE * errors, fs / signals.shape[1]))
        if not len(near):
            break
        pair = order[near[0] : near[0] + 2]
        weaker = pair[np.argmin(_explained(signals.shape, fs, poles)[pair])]
        one.append((float(freqs[pair[0]]), float(freqs[pair[1]])))
        poles = fit_poles(signals, fs, np.delete(poles.values, weaker))
    return poles, one


def _explained(size: tuple[int, ...], fs: float, poles: Poles) -> FloatArray:
    """(n_modes,) log-likelihood that each mode brings by itself: half its energy over the noise's."""
    energy = 0.5 * np.sum(np.exp(2.0 * poles.values.real[:, None] * np.arange(size[1]) / fs), axis=1)
    return np.asarray(0.5 * energy * np.sum(np.abs(poles.shapes) ** 2 / poles.noise**2, axis=1))


def _price(size: tuple[int, ...]) -> float:
    """What a further mode has to explain. Source: Schwarz, Ann. Stat. 6 (1978) 461."""
    return float((1.0 + size[0]) * np.log(size[0] * size[1]))
