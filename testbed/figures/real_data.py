"""Pictures of the studies of other people's measurements."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from testbed.figures.report_style import COLOURS, MEASURED
from testbed.real_data.bolted_beam import HELD_OUT, HELD_OUT_BAR, HYSTERESIS, BoltedBeam
from testbed.real_data.friction_frame import FrictionFrame, WeightResult
from testbed.real_data.silverbox import Silverbox

HIGHEST = 230.0
"""Hz, up to where the Silverbox is driven."""

SHOWN = 400
"""Samples of the frame's test that are drawn."""

PALETTE = ("#9a9a9a", "#2b6cb0", "#d1491b", "#2f855a", "#805ad5")


def silverbox_figure(study: Silverbox) -> Figure:
    """What each model leaves of the multisine test, over the frequency; errors on both tests.

    Args:
        study: finished.
    """
    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(2, 1))
    shown = study.frequency <= HIGHEST
    colours = dict(zip(study.errors, PALETTE, strict=False))
    for label, spectrum in study.spectra.items():
        colour = colours.get(label, MEASURED)
        left.semilogy(study.frequency[shown], 1e3 * spectrum[shown], color=colour, linewidth=1.0, label=label)
    left.set_xlabel("frequency [Hz]")
    left.set_ylabel("output, and what is left of it [mV/sqrt(Hz)]")
    left.set_title("multisine test", loc="left", fontsize=10)
    left.legend(fontsize=8, frameon=False)
    place = np.arange(len(study.errors))
    for shift, which in ((-0.2, 0), (0.2, 1)):
        values = [pair[which] for pair in study.errors.values()]
        bars = right.bar(place + shift, values, 0.38, color=list(colours.values()), alpha=1.0 if which == 0 else 0.5)
        right.bar_label(bars, [f"{value:.2f}" for value in values], fontsize=7)
    right.set_yscale("log")
    right.set_xticks(place, [label.replace(" ", "\n").replace("_", "\n") for label in study.errors], fontsize=7)
    right.set_ylabel("rms error [mV]")
    right.set_title("multisine test (full), arrow (pale)", loc="left", fontsize=10)
    return figure


def frame_figure(study: FrictionFrame) -> Figure:
    """Friction against weight with the line through two of them; the last weight's motion; errors.

    Args:
        study: finished.
    """
    figure = Figure(figsize=(13.0, 4.0), layout="constrained")
    force, motion, errors = figure.subplots(1, 3, width_ratios=(1, 1.5, 1.2))
    weights = [row.weight for row in study.rows]
    forces, stds = [row.force for row in study.rows], [row.std for row in study.rows]
    force.errorbar(weights, forces, stds, fmt="o", color=MEASURED, capsize=3, label="identified")
    force.plot(
        [weights[0], weights[-1]], [forces[0], study.predicted], color=COLOURS["updated"], label="line through two"
    )
    force.errorbar(
        weights[-1:],
        [study.predicted],
        [study.predicted_std],
        fmt="s",
        color=COLOURS["updated"],
        capsize=3,
        label="predicted",
    )
    force.set_xlabel("weight of the disc [g]")
    force.set_ylabel("friction force [N]")
    force.legend(fontsize=8, frameon=False)
    last = study.rows[-1]
    time = np.arange(SHOWN) / last.fs
    motion.plot(time, last.measured[:SHOWN], color=MEASURED, label="measured")
    found = "predicted with what was found"
    motion.plot(time, last.predicted[:SHOWN], color=COLOURS["updated"], linestyle="--", label=found)
    motion.set_xlabel("time in the half kept aside [s]")
    motion.set_ylabel("top [mm]")
    motion.margins(y=0.25)
    motion.set_title(f"{last.weight} g", loc="left", fontsize=10)
    motion.legend(fontsize=8, frameon=False, loc="upper right", ncols=2)
    _errors(errors, study)
    return figure


def _errors(ax: Axes, study: FrictionFrame) -> None:
    place = np.arange(len(study.rows))
    names = ("as given", "linear", "linear, loose", "with what was found")
    for number, (name, colour) in enumerate(zip(names, (PALETTE[i] for i in (0, 1, 4, 2)), strict=True)):
        values = [_error_of(row, number) for row in study.rows]
        bars = ax.bar(place + 0.2 * number - 0.3, values, 0.19, color=colour, label=name)
        ax.bar_label(bars, [f"{value:.2f}" for value in values], fontsize=6, rotation=90, padding=2)
    ax.set_xticks(place, [f"{row.weight} g" for row in study.rows])
    ax.margins(y=0.12)
    ax.set_ylabel("rms error on the half kept aside [mm]")
    ax.legend(fontsize=8, frameon=False)


def _error_of(row: WeightResult, number: int) -> float:
    return (row.given, row.linear, row.loose[1], row.updated)[number]


def beam_figure(study: BoltedBeam) -> Figure:
    """Responses at four force levels, measured and predicted; what every kind leaves in the hysteresis's place.

    Args:
        study: finished.
    """
    figure = Figure(figsize=(12.0, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
    first = next(iter(study.models))
    for k, level in enumerate(study.levels):
        name = f"{level.name}, kept aside" if k == HELD_OUT else level.name
        colour = PALETTE[(1, 3, 2, 4)[k % 4]]
        left.plot(level.frequency, np.abs(level.responses[0]), ".", color=colour, markersize=4, label=name)
        for label, style in ((first, ":"), (study.final, "-")):
            predicted = study.predicted[label][k]
            if predicted is not None:
                left.plot(level.frequency, np.abs(predicted), style, color=colour, linewidth=1.0)
    left.set_ylim(0.0, 1.4 * max(float(np.abs(level.responses).max()) for level in study.levels))
    left.set_xlabel("frequency [Hz]")
    left.set_ylabel("acceleration, first harmonic [m/s^2]")
    left.set_title("measured (dots), linear mode (dotted), with what was found (lines)", loc="left", fontsize=10)
    left.legend(fontsize=8, frameon=False)
    shown = [suspect for suspect in study.trial if suspect.held_out is not None]
    colours = [PALETTE[2] if suspect.label.startswith(HYSTERESIS) else PALETTE[1] for suspect in shown]
    right.barh([suspect.label for suspect in shown], [suspect.held_out or 0.0 for suspect in shown], color=colours)
    right.axvline(HELD_OUT_BAR, color="black", linewidth=0.8, linestyle="--", label="bound")
    right.invert_yaxis()
    right.tick_params(labelsize=7)
    right.set_xlabel("rms error at the level kept aside [m/s^2]")
    right.set_title("every kind in the place of the hysteresis", loc="left", fontsize=10)
    right.legend(fontsize=8, frameon=False)
    return figure
