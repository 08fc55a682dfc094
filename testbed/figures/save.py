"""Figures as files, without a display."""

import re
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

DPI = 120


def save(figure: Figure, folder: Path, name: str) -> None:
    """Write a figure as PNG.

    Args:
        figure: drawn.
        folder: made if it does not exist.
        name: without suffix; what a file name cannot carry is replaced.
    """
    folder.mkdir(parents=True, exist_ok=True)
    FigureCanvasAgg(figure)
    figure.savefig(folder / f"{file_name(name)}.png", dpi=DPI)


def file_name(name: str) -> str:
    """The name with everything but letters, digits, points, dashes and underscores as a dash."""
    return re.sub(r"[^\w.-]+", "-", name).strip("-.") or "figure"
