"""Where along the beam one missing force explains most, and what the force follows."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from models.arrays import FloatArray
from testbed.figures.report_style import COLOURS, literal

SAMPLES, BAND = "#b8c4d0", "#f3d9cf"
"""Colours of single samples and of the interval of the place."""


def plot_profile(
    ax: Axes,
    position: FloatArray,
    explained: FloatArray,
    *,
    interval: tuple[float, float] | None,
    sleeves: Mapping[str, float],
    sensors: Mapping[str, float],
) -> None:
    """Share of the misfit that a force explains, over where it acts, with sleeves and sensors below.

    Args:
        ax: to draw on.
        position: (n,) m from the clamp.
        explained: (n,) share of the misfit beyond the noise.
        interval: of the most likely place, m.
        sleeves: name -> position, m.
        sensors: name -> position, m.
    """
    if interval is not None:
        ax.axvspan(*interval, facecolor=BAND, edgecolor=BAND, linewidth=2.0, zorder=0)
    ax.plot(position, 100.0 * explained, color=COLOURS["updated"], marker="o", markersize=2.5)
    ax.set_ylim(SENSORS_AT - 9.0, 106.0)
    ax.set_xlim(0.0, None)
    ax.set_yticks([0, 25, 50, 75, 100])
    ax.axhline(0.0, color="#444444", linewidth=0.6)
    for name, x in sleeves.items():
        ax.axvline(x, color="#555555", linewidth=0.8, linestyle=":", zorder=0)
        ax.annotate(literal(name), (x, 104.0), ha="center", va="bottom", fontsize=8, annotation_clip=False)
    places = np.array(list(sensors.values()))
    ax.plot(places, np.full(len(places), SENSORS_AT), linestyle="", marker="^", markersize=4.5, color="#444444")
    for name, x in sensors.items():
        ax.annotate(
            literal(name), (x, SENSORS_AT), (0, -5), textcoords="offset points", ha="center", va="top", fontsize=7
        )
    ax.set_xlabel("position of the force from the clamp [m]")
    ax.set_ylabel("explained [%]")


SENSORS_AT = -12.0
"""Height of the row of sensors, in % of the other axis."""


def plot_channels(ax: Axes, sensors: tuple[str, ...], explained: FloatArray) -> None:
    """Share of the misfit that a signal of one channel's own explains.

    Args:
        ax: to draw on.
        sensors: names.
        explained: (n,) share.
    """
    ax.barh(np.arange(len(sensors)), 100.0 * explained, color=COLOURS["calibrated"], height=0.6)
    ax.set_yticks(np.arange(len(sensors)), [literal(name) for name in sensors])
    ax.set_ylim(len(sensors) - 0.4, -0.6)
    ax.set_xlim(0.0, 100.0)
    ax.set_xlabel("one channel left out [%]")
    if explained.max(initial=0.0) < SEEN:
        ax.text(50.0, 0.5 * (len(sensors) - 1), "none explains\n1 %", ha="center", va="center", color="#666666")


SEEN = 0.01
"""Share that shows as a bar."""


def plot_curve(
    ax: Axes,
    samples: tuple[FloatArray, FloatArray] | None,
    curve: tuple[FloatArray, FloatArray, FloatArray],
    label: str,
) -> None:
    """Means of the force in bins of a quantity, with two standard errors, over single samples.

    Args:
        ax: to draw on.
        samples: (n,) quantity and (n,) force, N; None for none.
        curve: (n_bins,) quantity, mean and standard error of the mean, N.
        label: of the horizontal axis.
    """
    x, mean, error = curve
    if samples is not None:
        ax.plot(*samples, linestyle="", marker=".", markersize=1.2, color=SAMPLES, rasterized=True, zorder=0)
    ax.errorbar(x, mean, 2.0 * error, color=COLOURS["updated"], marker="o", markersize=2.5, elinewidth=0.9)
    ax.axhline(0.0, color="#bbbbbb", linewidth=0.6, zorder=0)
    ax.xaxis.set_major_locator(MaxNLocator(4))
    ax.set_xlabel(label)
