"""The picture of one kind of effect: where it shows, and what it is."""

from collections.abc import Mapping
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter
from PIL import Image

from testbed.effects_page.panels import Curve, CurveName, Panel
from testbed.effects_page.showing import Showing
from testbed.figures.report_style import COLOURS, literal, report_style
from testbed.figures.save import DPI

LOOKS: Mapping[CurveName, str] = {
    "without": COLOURS["given"],
    "with": COLOURS["updated"],
    "early": "#f0b29c",
    "late": COLOURS["updated"],
    "low": "#7fb0dc",
    "high": "#1f4e85",
}
COLUMNS, SIZE = 3, (7.5, 4.4)
"""900 points wide at the resolution of ``testbed.figures.save``."""

LETTERS, WIDTH = 7.0, 128
"""Size of the letters and how many of them fill a line of the title."""


N_COLOURS = 48
"""Of a picture file: the curves', and the shades of their edges and of the letters."""


def effect_figure(shown: Showing) -> Figure:
    """All panels of an effect, three in a row, under its words.

    Args:
        shown: finished.
    """
    with report_style():
        figure = Figure(figsize=SIZE, layout="constrained")
        axes = figure.subplots(-(-len(shown.panels) // COLUMNS), COLUMNS, squeeze=False).ravel()
        for ax, panel in zip(axes, shown.panels, strict=True):
            plot_panel(ax, panel)
        figure.suptitle(literal(fill(shown.title, WIDTH)), fontsize=LETTERS + 1, x=0.01, ha="left")
    return figure


def save_small(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG of few colours, a third of the size of one with all of them.

    Args:
        figure: drawn.
        path: of the file, in a folder that is made if it does not exist.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.set_dpi(DPI)
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
    picture.quantize(N_COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


def plot_panel(ax: Axes, panel: Panel) -> None:
    """One panel with its curves.

    Args:
        ax: to draw on.
        panel: finished.
    """
    for x in panel.marked:
        ax.axvline(x, color="#dddddd", linewidth=3.0, zorder=0)
    for curve in panel.curves:
        _plot_curve(ax, curve)
    if panel.log_x:
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(LogLocator(10.0, (1.0, 2.0, 5.0)))
        ax.xaxis.set_major_formatter(ScalarFormatter())
        ax.xaxis.set_minor_formatter(NullFormatter())
    if panel.log_y:
        ax.set_yscale("log")
    else:
        _widen(ax, panel)
    if panel.place is not None:
        ax.plot([panel.place], [0.0], "^", color=LOOKS["with"], transform=ax.get_xaxis_transform(), clip_on=False)
    ax.set_title(literal(panel.title), fontsize=LETTERS, loc="left")
    ax.set_xlabel(panel.x_label, fontsize=LETTERS, labelpad=1.0)
    ax.set_ylabel(literal(panel.y_label), fontsize=LETTERS, labelpad=1.0)
    ax.tick_params(labelsize=LETTERS - 0.5, pad=1.5)
    ax.legend(fontsize=LETTERS - 0.5, handlelength=1.2, borderpad=0.1, labelspacing=0.2)


def _plot_curve(ax: Axes, curve: Curve) -> None:
    # What is drawn first shows beneath what is drawn on it.
    wide, colour = curve.name == "without", LOOKS[curve.name]
    if curve.marks:
        ax.plot(curve.x, curve.y, "o", markersize=6.0 if wide else 3.5, color=colour, label=curve.name)
    else:
        ax.plot(curve.x, curve.y, linewidth=2.2 if wide else 0.9, color=colour, label=curve.name)


def _widen(ax: Axes, panel: Panel) -> None:
    """Limits of the y axis: not narrower than rounding, from 0 where that is the least."""
    values = np.concatenate([curve.y for curve in panel.curves])
    low, high = float(values.min()), float(values.max())
    if panel.from_zero:
        ax.set_ylim(0.0, 1.08 * max(high, panel.least_span))
    elif high - low < panel.least_span:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * panel.least_span, middle + 0.5 * panel.least_span)
