"""Calibrated numbers of the rig in standard deviations of their owner's tolerances."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from models.arrays import FloatArray
from testbed.figures.report_style import COLOURS, literal


def plot_pulls(ax: Axes, labels: Sequence[str], pulls: FloatArray, stds: FloatArray) -> None:
    """Distance of each number from the rig file, with its own standard deviation, over the bands of one and two.

    Args:
        ax: to draw on.
        labels: of the numbers.
        pulls: (n,) calibrated minus given, in standard deviations of the tolerance.
        stds: (n,) of the calibrated values, in the same unit.
    """
    place = np.arange(len(labels))
    for width, shade in ((2.0, "#f1f4f8"), (1.0, "#dfe7f0")):
        ax.axvspan(-width, width, color=shade, linewidth=0.0, zorder=0)
    ax.axvline(0.0, color="#999999", linewidth=0.8)
    ax.errorbar(pulls, place, xerr=stds, fmt="o", markersize=4.5, color=COLOURS["calibrated"], elinewidth=1.1)
    ax.set_yticks(place, [literal(label) for label in labels])
    ax.set_ylim(len(labels) - 0.4, -0.6)
    reach = max(2.6, 1.15 * float(np.max(np.abs(pulls) + stds, initial=0.0)))
    ax.set_xlim(-reach, reach)
    ax.set_xlabel("calibrated - given [standard deviations of the tolerance]")
