"""FRFs of one sensor: measured, as given, updated, above the coherence of the measurement."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from models.arrays import ComplexArray, FloatArray
from testbed.figures.report_style import MEASURED, literal


class Curve(NamedTuple):
    """One FRF with its legend and its colour."""

    label: str
    colour: str
    values: ComplexArray


def plot_frfs(ax: Axes, frequency: FloatArray, measured: ComplexArray, models: Sequence[Curve], title: str) -> None:
    """Magnitudes on a logarithmic scale.

    Args:
        ax: to draw on.
        frequency: (n_freq,) Hz.
        measured: (n_freq,) FRF.
        models: predicted on the same lines, in the order of drawing.
        title: sensor and unit.
    """
    ax.semilogy(frequency, np.abs(measured), color=MEASURED, linewidth=2.0, label="measured")
    for curve in models:
        ax.semilogy(frequency, np.abs(curve.values), color=curve.colour, linewidth=0.9, label=literal(curve.label))
    ax.set_title(literal(title), loc="left")
    ax.grid(visible=True)
    ax.tick_params(labelbottom=False)


def plot_coherence_strip(ax: Axes, frequency: FloatArray, coherence: FloatArray) -> None:
    """Coherence of the measured channel with the excitation.

    Args:
        ax: to draw on.
        frequency: (n_freq,) Hz.
        coherence: (n_freq,) from 0 to 1.
    """
    ax.fill_between(frequency, 0.0, coherence, color="#cfd8e3", linewidth=0.0)
    ax.set_ylim(0.0, 1.0)
    ax.set_yticks([0, 1])
