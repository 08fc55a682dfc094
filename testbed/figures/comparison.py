"""The figures of a comparison: overlays with a zoom, FRFs with coherence, errors beside the noise floor, modes."""

from math import ceil
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from identification.result import RecordScore
from models.rig import Rig
from testbed.compare import Comparison, FrfPair
from testbed.figures.bars import plot_errors
from testbed.figures.frf import plot_coherence, plot_frf, tells
from testbed.figures.overlay import plot_overlay
from testbed.figures.save import save
from testbed.quantities import frf_unit, unit_of

ZOOM_SHARE = 0.05
"""Share of a record that the zoom shows, about the sample with the largest error."""


def save_comparison(comparison: Comparison, rig: Rig, folder: Path) -> None:
    """Draw all figures of a comparison into a folder.

    Args:
        comparison: finished.
        rig: for the units.
        folder: made if it does not exist.
    """
    for row in comparison.score.records if comparison.score is not None else ():
        save(overlay_figure(row, rig), folder, f"{row.record.name}-time")
        save(errors_figure(row), folder, f"{row.record.name}-nrmse")
    for pair in comparison.frfs:
        save(frf_figure(pair, rig), folder, f"{pair.record}-frf")


def overlay_figure(row: RecordScore, rig: Rig) -> Figure:
    """Every channel over the whole record, and beside it where the error is largest.

    Args:
        row: one record of a score.
        rig: for the units.
    """
    record, n = row.record, len(row.record.sensors)
    figure = Figure(figsize=(10.0, 1.9 * n), layout="constrained")
    axes = figure.subplots(n, 2, squeeze=False, width_ratios=(3, 2))
    for i, name in enumerate(record.sensors):
        zoom = _zoom(row, i)
        label = f"{name} [{unit_of(rig.sensor(name).quantity)}]"
        plot_overlay(axes[i, 0], record.time, record.responses[i], row.predicted[i], label)
        plot_overlay(axes[i, 1], record.time[zoom], record.responses[i, zoom], row.predicted[i, zoom], label)
        axes[i, 0].set_title(f"NRMSE {row.channel_nrmse[i]:.3g}, noise {row.channel_noise_nrmse[i]:.2g}", fontsize=9)
        axes[i, 1].set_title("where the error is largest", fontsize=9)
    for ax in axes[-1]:
        ax.set_xlabel("time [s]")
    axes[0, 0].legend(loc="upper right", fontsize=8)
    return figure


def _zoom(row: RecordScore, sensor: int) -> slice:
    n = row.record.n_samples
    half = max(int(0.5 * ZOOM_SHARE * n), min(20, n // 2))
    worst = int(np.argmax(np.abs(row.predicted[sensor] - row.record.responses[sensor])))
    centre = min(max(worst, half), n - half)
    return slice(centre - half, centre + half)


def errors_figure(row: RecordScore) -> Figure:
    """Error of each channel beside the noise floor.

    Args:
        row: one record of a score.
    """
    figure = Figure(figsize=(max(5.0, 0.8 * len(row.record.sensors)), 3.2), layout="constrained")
    ax = figure.subplots()
    plot_errors(ax, row.record.sensors, row.channel_nrmse, row.channel_noise_nrmse)
    ax.set_title(f"{row.record.name}: NRMSE {row.nrmse:.3g}, noise floor {row.noise_nrmse:.2g}", fontsize=9)
    figure.legend(loc="outside lower center", ncols=2, fontsize=8)
    return figure


def frf_figure(pair: FrfPair, rig: Rig) -> Figure:
    """Measured and predicted FRF of every sensor, above its coherence where that tells something.

    Args:
        pair: on the same lines.
        rig: for the units.
    """
    n, coherence = len(pair.sensors), pair.coherence if tells(pair.coherence) else None
    columns, kinds = min(2, n), 1 if coherence is None else 2
    rows = ceil(n / columns)
    figure = Figure(figsize=(6.0 * columns, 1.6 * rows * kinds), layout="constrained")
    axes = figure.subplots(kinds * rows, columns, squeeze=False, sharex=True, height_ratios=[2.0, 1.0][:kinds] * rows)
    for i, name in enumerate(pair.sensors):
        row, column = kinds * (i // columns), i % columns
        curves = {"measured": pair.measured[i], "predicted": pair.predicted[i]}
        plot_frf(axes[row, column], pair.frequency, curves, f"{name} [{frf_unit(rig, name)}]")
        if coherence is not None:
            plot_coherence(axes[row + 1, column], pair.frequency, coherence[i])
    for column in range(columns):
        filled = kinds * (rows if column + (rows - 1) * columns < n else rows - 1)
        axes[filled - 1, column].set_xlabel("frequency [Hz]")
        axes[filled - 1, column].tick_params(labelbottom=True)
        for ax in axes[filled:, column]:
            ax.remove()
    figure.suptitle(pair.record, fontsize=9)
    axes[0, 0].legend(fontsize=8)
    return figure
