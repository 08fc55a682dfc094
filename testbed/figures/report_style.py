"""How all figures of a report look: one colour a model, thin lines, no ornament."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl

MEASURED, NOISE = "#000000", "#8a8a8a"
COLOURS: Mapping[str, str] = {"given": "#9a9a9a", "calibrated": "#2b6cb0", "updated": "#d1491b"}
"""Colour of each stage of the model; measurements are black."""

SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#444444",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "svg.fonttype": "path",
    "svg.hashsalt": "report",
}


@contextmanager
def report_style() -> Iterator[None]:
    """Draw and save figures inside this context."""
    with mpl.rc_context(SETTINGS):
        yield


def literal(text: str) -> str:
    """A name as it is, where matplotlib would take a dollar sign for the start of a formula.

    Args:
        text: of a label.
    """
    return text.replace("$", r"\$")
