"""Measured and predicted channel over time."""

from matplotlib.axes import Axes

from models.arrays import FloatArray


def plot_overlay(ax: Axes, time: FloatArray, measured: FloatArray, predicted: FloatArray, label: str) -> None:
    """One channel as measured and as predicted.

    Args:
        ax: to draw on.
        time: (N,) s.
        measured: (N,) in the unit that the label names.
        predicted: (N,) the same.
        label: of the vertical axis.
    """
    ax.plot(time, measured, color="0.35", linewidth=1.0, label="measured")
    ax.plot(time, predicted, color="tab:red", linewidth=0.8, alpha=0.8, label="predicted")
    ax.set_xlim(float(time[0]), float(time[-1]))
    ax.set_ylabel(label)
