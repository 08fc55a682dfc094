"""Figures of an identification: what the modes were found in, and each mode over time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from identification.decay.identify import Decay, Identification, ModeInDecay
from identification.decay.smoother import Interval
from models.arrays import ComplexArray, FloatArray
from testbed.identify.sleeve import SleeveDamping

SMOOTHER, RIDGE, TRUTH = "tab:blue", "tab:orange", "black"
WIDEST = 4.0
"""Axes show the interval's middle and this many times its spread, so that a mode's last breath does not fill them."""

ROOM = 0.08
"""Of an axis's range, beyond what is drawn."""

SAME_PEAK = 0.03
"""Share of a mode's frequency within which a peak of the spectrum is this mode."""

LOWEST_LEVEL = -60.0
"""dB below the largest amplitude of a map, its darkest shade."""

LEAST_FREQUENCY, LEAST_DAMPING = 2e-3, 0.1
"""Half-widths of the axes at least, as shares of the values: what is steady looks so."""


@dataclass(frozen=True, eq=False)
class Scalogram:
    """A wavelet transform as it is drawn.

    Attributes:
        time: (n,) s.
        frequencies: (n_freq,) Hz.
        values: (n_freq, n) complex amplitudes.
        crest: (n,) Hz, the smoothest strong path through them; nan from where it has sunk into the noise.
    """

    time: FloatArray
    frequencies: FloatArray
    values: ComplexArray
    crest: FloatArray


@dataclass(frozen=True, eq=False)
class Truth:
    """What is known of a mode beforehand, for a figure.

    Attributes:
        times: (n,) s.
        natural_freq: (n,) Hz.
        damping_ratio: (n,).
    """

    times: FloatArray
    natural_freq: FloatArray
    damping_ratio: FloatArray


def sleeve_figure(damping: SleeveDamping, sleeve: str) -> Figure:
    """A sleeve's contact damping over the record with its interval, and the table that the updated rig has.

    Args:
        damping: of the sleeve.
        sleeve: its name.
    """
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    ax = figure.subplots()
    around = damping.value - damping.low, damping.high - damping.value
    ax.errorbar(
        damping.times, damping.value, around, fmt=".", color=SMOOTHER, alpha=0.5, elinewidth=0.6, label="modes, 95 %"
    )
    knots, above = damping.effect, 4  # matplotlib draws error bars above lines of the same order
    for number, (begin, end) in enumerate(damping.stretches):
        times = np.unique([begin, end, *(knot for knot in knots.times if begin < knot < end)])
        held = np.interp(times, knots.times, knots.values)
        label = "time_varying_damping, where it is told" if number == 0 else None
        ax.plot(times, held, color=RIDGE, label=label, zorder=above)
    ax.plot(knots.times, knots.values, color=RIDGE, marker="o", markersize=4.0, linestyle="", zorder=above)
    typical = WIDEST * float(np.median(damping.high - damping.low)) / 2.0
    low = max(damping.low.min(), damping.value.min() - typical)
    high = min(damping.high.max(), damping.value.max() + typical)
    edge = ROOM * (high - low)
    ax.set_ylim(min(low, *knots.values) - edge, max(high, *knots.values) + edge)
    ax.ticklabel_format(axis="y", useOffset=False)
    ax.set(xlabel="time in the record [s]", ylabel="contact damping [N s/m]", title=sleeve)
    figure.legend(fontsize=8, loc="outside lower center", ncols=2)
    return figure


def spectrum_figure(found: Identification, decay: Decay, name: str, unit: str) -> Figure:
    """The decay's strongest channel above the spectrum with its floor, the modes and the cuts between them."""
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    top, bottom = figure.subplots(2, 1)
    channel = int(np.argmax(decay.signals.std(axis=1)))
    top.plot(decay.start + np.arange(decay.signals.shape[1]) / decay.fs, decay.signals[channel], linewidth=0.5)
    top.set(xlabel="time [s]", ylabel=f"strongest channel [{unit}]", title=f"{name}: decay as analysed")
    plot_spectrum(bottom, found)
    figure.legend(*bottom.get_legend_handles_labels(), fontsize=8, loc="outside lower center", ncols=2)
    return figure


def plot_spectrum(ax: Axes, found: Identification) -> None:
    """Power of all channels over the noise's, the peaks taken for modes, and the cuts.

    Args:
        ax: to draw on.
        found: finished.
    """
    spectrum = found.spectrum.spectrum
    ax.semilogy(spectrum.frequency, spectrum.power, color="0.35", linewidth=0.7, label="all channels")
    ax.axhline(1.0, color="tab:green", linewidth=1.0, label="floor")
    ax.axhline(
        spectrum.threshold, color="tab:green", linestyle=":", label="peaks of noise reach this once in 1,000 records"
    )
    labelled = set()
    for freq in found.decays[0].poles.natural_freqs:
        style, label = _how_found(found, float(freq))
        ax.axvline(freq, color=SMOOTHER, linestyle=style, linewidth=1.0, label=None if label in labelled else label)
        labelled.add(label)
    for i, cut in enumerate(found.cuts):
        ax.axvline(cut, color="tab:red", linestyle="--", linewidth=0.8, label="cut" if i == 0 else None)
    ax.set(xlabel="frequency [Hz]", ylabel="power / floor")


def _how_found(found: Identification, freq: float) -> tuple[str, str]:
    """Line style and label of a mode: whether this spectrum shows it, or that of the decay's beginning, or neither."""
    parts = [peak.part for peak in found.spectrum.peaks if abs(peak.frequency / freq - 1.0) < SAME_PEAK]
    if not parts:
        return ":", "mode, found in what the others leave"
    return ("-", "mode, a peak") if min(parts) == 1 else ("-.", "mode, a peak of the decay's beginning alone")


def mode_figure(mode: ModeInDecay, scalogram: Scalogram, title: str, unit: str, truth: Truth | None = None) -> Figure:
    """Scalogram with its crest, skeleton, frequency and damping over time, and both over the amplitude.

    Args:
        mode: in one decay.
        scalogram: of its signal.
        title: above all.
        unit: of the amplitude.
        truth: where it is known.
    """
    figure = Figure(figsize=(11.0, 8.5), layout="constrained")
    figure.suptitle(title, fontsize=11)
    axes = figure.subplots(3, 2)
    end = float(mode.smoothed.decay.times[-1])
    plot_scalogram(axes[0, 0], scalogram, end)
    plot_skeleton(axes[0, 1], mode, end, unit)
    frequency, damping = mode.frequency, mode.damping
    plot_course(axes[1, 0], frequency, mode.skeleton.time, mode.ridge_freq, LEAST_FREQUENCY)
    plot_course(axes[1, 1], damping, mode.skeleton.time, mode.skeleton.damping_ratio, LEAST_DAMPING)
    if truth is not None:
        axes[1, 0].plot(truth.times, truth.natural_freq, color=TRUTH, linestyle="--", linewidth=1.0, label="truth")
        axes[1, 1].plot(truth.times, truth.damping_ratio, color=TRUTH, linestyle="--", linewidth=1.0, label="truth")
    for ax, label in ((axes[1, 0], "natural frequency [Hz]"), (axes[1, 1], "damping ratio [-]")):
        ax.set(xlabel="time [s]", ylabel=label, xlim=(0.0, end))
        ax.legend(fontsize=8, framealpha=1.0)
    plot_over_amplitude(axes[2, 0], mode, frequency, LEAST_FREQUENCY)
    plot_over_amplitude(axes[2, 1], mode, damping, LEAST_DAMPING)
    axes[2, 0].set(xlabel=f"amplitude [{unit}]", ylabel="natural frequency [Hz]")
    axes[2, 1].set(xlabel=f"amplitude [{unit}]", ylabel="damping ratio [-]")
    for ax in axes[2]:
        ax.legend(fontsize=8, framealpha=1.0)
    return figure


def plot_scalogram(ax: Axes, scalogram: Scalogram, end: float) -> None:
    """Magnitude of the wavelet transform in dB below its largest, with its crest.

    Args:
        ax: to draw on.
        scalogram: finished.
        end: of what is shown, s.
    """
    level = 20.0 * np.log10(np.maximum(np.abs(scalogram.values) / np.abs(scalogram.values).max(), 1e-4))
    image = ax.pcolormesh(
        scalogram.time, scalogram.frequencies, level, cmap="magma", vmin=LOWEST_LEVEL, vmax=0.0, shading="nearest",
        rasterized=True,
    )  # fmt: skip
    ax.plot(scalogram.time, scalogram.crest, color="cyan", linestyle="--", linewidth=1.0, label="crest of this map")
    ax.set(xlabel="time [s]", ylabel="frequency [Hz]", xlim=(0.0, end), title="Morlet transform [dB]")
    ax.set_ylim(scalogram.frequencies.min(), scalogram.frequencies.max())
    ax.legend(fontsize=8, loc="upper right")
    ax.figure.colorbar(image, ax=ax)


def plot_skeleton(ax: Axes, mode: ModeInDecay, end: float, unit: str) -> None:
    """Amplitude over time: the ridge's, and that of the blocks which the smoother runs through.

    Args:
        ax: to draw on.
        mode: in one decay.
        end: of what is shown, s.
        unit: of the amplitude.
    """
    blocks, watched = mode.smoothed.blocks, mode.watched_decay
    shown = mode.skeleton.time <= end
    ax.semilogy(mode.skeleton.time[shown], mode.skeleton.amplitude[shown], color=RIDGE, linewidth=1.0, label="ridge")
    ax.semilogy(
        blocks.times, np.exp(watched.log_amplitude), color=SMOOTHER, marker=".", markersize=3.0, linewidth=0.8,
        label="smoother",
    )  # fmt: skip
    ax.set(xlabel="time [s]", ylabel=f"amplitude [{unit}]", xlim=(0.0, end), title="skeleton")
    ax.legend(fontsize=8)


def plot_course(ax: Axes, course: Interval, ridge_times: FloatArray, ridge: FloatArray, least: float) -> None:
    """One quantity over time with its 95 % interval, and the ridge's beside it.

    Args:
        ax: to draw on.
        course: as identified.
        ridge_times: (N,) s.
        ridge: (N,).
        least: half-width of the axis at least, as a share of the value.
    """
    ax.plot(ridge_times, ridge, color=RIDGE, linewidth=0.7, alpha=0.8, label="ridge")
    ax.fill_between(course.times, course.low, course.high, color=SMOOTHER, alpha=0.25, linewidth=0.0, label="95 %")
    ax.plot(course.times, course.value, color=SMOOTHER, linewidth=1.4, label="identified")
    ax.set_ylim(*_limits(course, least))


def plot_over_amplitude(ax: Axes, mode: ModeInDecay, course: Interval, least: float) -> None:
    """One quantity over the mode's amplitude.

    Args:
        ax: to draw on.
        mode: in one decay.
        course: as identified.
        least: half-width of the axis at least, as a share of the value.
    """
    times = mode.smoothed.blocks.times
    amplitude = np.exp(mode.watched_decay.log_amplitude)
    order = np.argsort(amplitude)
    low, high = (np.interp(times, course.times, bound)[order] for bound in (course.low, course.high))
    ax.fill_between(amplitude[order], low, high, color=SMOOTHER, alpha=0.25, linewidth=0.0, label="95 %")
    ax.semilogx(amplitude[order], course.at(times)[order], color=SMOOTHER, linewidth=1.4, label="identified")
    ax.set_ylim(*_limits(course, least))


def _limits(course: Interval, least: float) -> tuple[float, float]:
    """Around the values, as wide as the typical interval asks for."""
    half = 0.5 * float(np.median(course.high - course.low))
    low, high = float(course.value.min()), float(course.value.max())
    margin = max(WIDEST * half, 0.15 * (high - low), least * abs(high))
    return low - margin, high + margin


def names_of(n_decays: int, n_modes: int) -> Sequence[tuple[int, int, str]]:
    """(decay, mode, file name) of every mode's figure."""
    pairs = [(d, m) for d in range(n_decays) for m in range(n_modes)]
    return [(d, m, f"mode-{m + 1}" if n_decays == 1 else f"decay-{d + 1}-mode-{m + 1}") for d, m in pairs]
