"""The figure of one sensor's error budget: at each level, how the response splits over frequency."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from identification.budget.split import Cause, Split
from testbed.figures.report_style import literal, report_style

MOST_LEVELS = 3

BELOW_NOISE = 0.05
"""How far below the lowest noise an axis reaches; what lies lower is chance."""

DISTORTIONS: tuple[tuple[Cause, str, str], ...] = (
    ("odd", "odd distortion", "#d1491b"),
    ("even", "even distortion", "#2b6cb0"),
    ("odd_or_even", "odd or even distortion", "#7b3fa0"),
)


def budget_figure(splits: Sequence[Split], sensor: str, unit: str, excitation_unit: str) -> Figure:
    """One panel a level, the lowest above.

    Args:
        splits: one record a level, from the lowest up; the lowest and the highest are shown if there are many.
        sensor: name, in all of them.
        unit: of the sensor.
        excitation_unit: of the levels.
    """
    shown = list(splits) if len(splits) <= MOST_LEVELS else [splits[0], *splits[1 - MOST_LEVELS :]]
    with report_style():
        figure = Figure(figsize=(10.0, 3.2 * len(shown) + 0.6), layout="constrained")
        axes = figure.subplots(len(shown), 1, squeeze=False, sharex=True, sharey=True)[:, 0]
        for ax, split in zip(axes, shown, strict=True):
            plot_split(ax, split, split.record.sensors.index(sensor))
            ax.set_ylabel(
                f"{literal(sensor)}, rms of a line\n[{unit}]" if unit else f"{literal(sensor)}, rms of a line"
            )
            title = f"{split.record.name}: rms {split.level:.3g} {excitation_unit}, {split.n_periods} periods"
            ax.set_title(literal(title), loc="left")
        axes[0].set_ylim(bottom=BELOW_NOISE * min(float(np.sqrt(s.noise_per_line.min())) for s in shown) or None)
        axes[-1].set_xlabel("frequency [Hz]")
        handles = {h.get_label(): h for ax in axes for h in ax.get_legend_handles_labels()[0]}
        figure.legend(handles=list(handles.values()), loc="outside upper center", ncols=4)
    return figure


def plot_split(ax: Axes, split: Split, sensor: int) -> None:
    """Response, noise, distortion, transient and time variation of one sensor, line by line.

    A distortion that a band does not hold above chance is pale.

    Args:
        ax: to draw on.
        split: of the record.
        sensor: its number there.
    """
    frequency, lines = split.periods.frequency, split.lines
    excited = split.periods.excited
    ax.semilogy(frequency, np.sqrt(lines.noise[sensor]), ".", color="0.82", markersize=2)
    for cause, label, colour in DISTORTIONS:
        on, share = split.lines_of(cause), split.shares[cause]
        if not on.any():
            continue
        ax.plot([], [], "o", color=colour, markersize=4, label=label)
        band = np.clip(np.searchsorted(split.bands, frequency[on]) - 1, 0, len(split.bands) - 2)
        there = share.found[sensor, band]
        for chosen, alpha in ((~there, 0.18), (there, 0.9)):
            values = np.sqrt(lines.distortion[sensor, on][chosen])
            ax.semilogy(frequency[on][chosen], values, "o", color=colour, alpha=alpha, markersize=2.6, mew=0)
    if split.shares["transient"].found[sensor].any():
        ax.semilogy(frequency, np.sqrt(lines.transient[sensor]), color="#2f855a", linewidth=0.7, label="transient")
    if split.shares["time_variation"].found[sensor].any():
        varying = np.sqrt(lines.time_variation[sensor, excited])
        ax.semilogy(frequency[excited], varying, "x", color="#b7791f", markersize=4, label="time variation")
    response = np.sqrt(lines.response[sensor, excited])
    ax.semilogy(frequency[excited], response, "o-", color="black", markersize=2.4, linewidth=0.6, label="response")
    floor = np.sqrt(split.noise_per_line[sensor])
    ax.stairs(floor, split.bands, baseline=None, color="0.45", linewidth=1.4, label="noise")
    ax.grid(visible=True, axis="y")
