"""The error of each channel above what the noise alone leaves."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from models.arrays import FloatArray

ROOM = 1.5
"""Factor that the axis leaves below the least and above the largest value."""

NARROW = 10.0
"""Factor between the ends of an axis, below which more numbers stand at it."""


def plot_errors(ax: Axes, sensors: Sequence[str], errors: FloatArray, noise: FloatArray) -> None:
    """Per-channel NRMSE and noise floor.

    Args:
        ax: to draw on.
        sensors: names.
        errors: (n_sensors,) NRMSE of the model.
        noise: (n_sensors,) NRMSE of a perfect model.
    """
    place = np.arange(len(sensors))
    ax.vlines(place, noise, errors, color="0.85", linewidth=2.0, zorder=1)
    ax.scatter(place, errors, color="tab:red", label="model", zorder=2)
    ax.scatter(place, noise, color="0.5", marker="_", s=160, linewidths=2.0, label="noise floor", zorder=2)
    ax.set_yscale("log")
    low, high = ax.get_ylim()
    ax.set_ylim(low / ROOM, high * ROOM)
    few = high * ROOM < NARROW * low / ROOM
    ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if few else (1.0, 2.0, 5.0)))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.yaxis.set_minor_formatter(NullFormatter())
    ax.grid(visible=True, axis="y", color="0.92")
    ax.set_axisbelow(True)
    ax.set_xlim(-0.6, len(sensors) - 0.4)
    ax.set_xticks(place, list(sensors))
    ax.set_ylabel("NRMSE [-]")
