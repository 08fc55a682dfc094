"""The missing force against the motion at its place, and over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.ticker import MaxNLocator

from models.arrays import FloatArray
from testbed.figures.report_style import COLOURS


def plot_force_over(
    ax: Axes,
    motion: FloatArray,
    force: FloatArray,
    time: FloatArray,
    *,
    label: str,
    walls: tuple[float, ...] = (),
) -> PathCollection:
    """Force against displacement or velocity, coloured by time, so that a drift shows.

    Args:
        ax: to draw on.
        motion: (n,) in the unit that the label names.
        force: (n,) N.
        time: (n,) s.
        label: of the horizontal axis.
        walls: where the sleeve's walls are, in the unit of the motion.
    """
    dots = ax.scatter(motion, force, s=2.0, c=time, cmap="viridis", linewidths=0.0, alpha=0.55)
    span = float(np.ptp(motion))
    for side in walls:
        if motion.min() - 0.2 * span < side < motion.max() + 0.2 * span:
            ax.axvline(side, color="#555555", linewidth=0.8, linestyle=":")
    ax.axhline(0.0, color="#bbbbbb", linewidth=0.6, zorder=0)
    ax.xaxis.set_major_locator(MaxNLocator(5))
    ax.set_xlabel(label)
    return dots


def plot_force_in_time(ax: Axes, time: FloatArray, force: FloatArray, linewidth: float = 0.4) -> None:
    """Force over the record.

    Args:
        ax: to draw on.
        time: (N,) s.
        force: (N,) N.
        linewidth: in points.
    """
    ax.plot(time, force, color="#555555", linewidth=linewidth)
    ax.axhline(0.0, color="#bbbbbb", linewidth=0.6, zorder=0)
    ax.set_xlim(float(time[0]), float(time[-1]))
    ax.set_xlabel("time [s]")


def plot_force_close(ax: Axes, time: FloatArray, force: FloatArray, displacement: FloatArray) -> None:
    """Force over a stretch of the record, and the displacement at its place on an axis of its own.

    Args:
        ax: to draw on.
        time: (n,) s.
        force: (n,) N.
        displacement: (n,) mm.
    """
    motion = ax.twinx()
    motion.plot(time, displacement, color=COLOURS["calibrated"], linewidth=0.9, linestyle="--")
    motion.set_ylabel("displacement [mm]")
    motion.spines["right"].set_visible(True)
    plot_force_in_time(ax, time, force, linewidth=1.1)
