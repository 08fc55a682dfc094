"""The figure of nonlinear FRFs."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.arrays import FloatArray
from testbed.sweep import Sweep


def sweep_figure(found: Sweep) -> Figure:
    """Half the swing of a reading over the frequency: stable motion solid, unstable dotted, the backbone dashed.

    Args:
        found: finished.
    """
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    ax = figure.subplots()
    levels = sorted({float(curve.amplitudes[0]) for curve in found.curves})
    for curve in found.curves:
        level = float(curve.amplitudes[0])
        peaks, label = curve.peaks([found.sensor])[:, 0], f"{level:g} {found.level_unit}"
        plot_curve(ax, curve.freqs, peaks, curve.is_stable, f"C{levels.index(level)}", label, None)
    if found.spine is not None:
        peaks = found.spine.peaks([found.sensor])[:, 0]
        ax.plot(found.spine.freqs, peaks, "--", color="0.25", linewidth=1.2, label="backbone")
    if any(not curve.is_stable.all() for curve in found.curves):
        ax.plot([], [], ":", color="0.25", linewidth=1.0, label="dotted: unstable")
    lines, names = ax.get_legend_handles_labels()
    once = dict(zip(names, lines, strict=True))
    ax.legend(once.values(), once.keys(), fontsize=8)
    ax.set(xlim=found.band, xlabel="frequency of the sine [Hz]", yscale="log")
    ax.set_ylabel(f"half the swing of {found.sensor} [{found.unit}]")
    ax.grid(visible=True, which="both", color="0.92")
    return figure


def plot_curve(
    ax: Axes,
    freqs: FloatArray,
    peaks: FloatArray,
    stable: np.ndarray,
    color: str,
    label: str | None,
    unstable: str | None,
) -> None:
    """One curve: stable stretches solid, unstable ones dotted and thin.

    Args:
        ax: to draw on.
        freqs: (n,) Hz.
        peaks: (n,) half of what the reading swings.
        stable: (n,) of bool.
        color: of both.
        label: of the stable stretches; None for no entry in the legend.
        unstable: of the others.
    """
    reached = stable | np.roll(stable, 1) | np.roll(stable, -1)  # a stretch goes on to where the next one begins
    ax.plot(freqs, np.where(reached, peaks, np.nan), color=color, linewidth=1.2, label=label)
    if not stable.all():
        ax.plot(freqs, np.where(stable, np.nan, peaks), ":", color=color, linewidth=1.0, label=unstable)
