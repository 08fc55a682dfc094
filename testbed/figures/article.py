"""Figures of the article's case study."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from testbed.article.study import AtRest
from testbed.figures.sweep import plot_curve
from testbed.outputs import Json


def frequencies_figure(rests: Sequence[AtRest]) -> Figure:
    """Four natural frequencies against the clearance: of the linearised model, and as the article measured them."""
    figure = Figure(figsize=(9.0, 5.6), layout="constrained")
    clearances = [1e3 * rest.clearance for rest in rests]
    for order, ax in enumerate(figure.subplots(2, 2, sharex=True).ravel()):
        ours = [rest.natural_freqs[order] for rest in rests]
        theirs = [rest.measured_freqs[order] for rest in rests]
        ax.plot(clearances, theirs, "s", color="0.5", label="the article's test")
        ax.plot(clearances, ours, "o", color="tab:blue", label="linearised about rest")
        ax.set(ylabel=f"f{order + 1} [Hz]", ylim=(0.93 * min(ours + theirs), 1.03 * max(ours + theirs)))
        if order >= 2:
            ax.set_xlabel("clearance [mm]")
    figure.axes[0].legend(fontsize=8, loc="lower left")
    return figure


def sines_figure(rows: Sequence[Json]) -> Figure:
    """Half the swing at the tip over the frequency of the sine, one panel a clearance, with the backbone."""
    columns = min(3, len(rows))
    lines = -(-len(rows) // columns)
    figure = Figure(figsize=(4.2 * columns, 3.4 * lines), layout="constrained")
    panels = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for ax, row in zip(panels, rows, strict=False):
        for number, level in enumerate(row["levels"]):
            for part, curve in enumerate(level["curves"]):
                freqs, peaks, stable = (np.array(curve[key]) for key in ("frequency", "peak", "stable"))
                name = f"{level['amplitude']:g} N" if part == 0 else None
                plot_curve(ax, freqs, peaks, stable, f"C{number}", name, None)
            if level["check"] is not None:
                at = level["check"]["freq"]
                curve = level["curves"][0]
                nearest = int(np.argmin(np.abs(np.array(curve["frequency"]) - at)))
                ax.plot(at, curve["peak"][nearest], "o", color=f"C{number}", markersize=4, markerfacecolor="white")
        ax.plot(
            row["backbone"]["frequency"], row["backbone"]["peak"], "--", color="0.25", linewidth=1.0, label="backbone"
        )
        ax.set(title=f"{1e3 * row['clearance']:g} mm", yscale="log")
        ax.grid(visible=True, which="both", color="0.93")
    for ax in panels[-columns:]:
        ax.set_xlabel("frequency of the sine [Hz]")
    panels[0].set_ylabel("tip [m/s^2]")
    panels[0].legend(fontsize=8)
    return figure
