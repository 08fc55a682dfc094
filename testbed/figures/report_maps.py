"""Error maps: sensors over frequency bands or time windows."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.ticker import MaxNLocator

from models.arrays import FloatArray
from testbed.figures.report_style import literal

CMAP = "YlOrRd"
AT_NOISE = "#e9edf1"
"""Cells whose error the noise explains."""

NOISE_MARGIN = 1.5
TICKS, FEWEST_TICKS = 7, 2


def plot_frequency_map(
    ax: Axes, frequency: FloatArray, sensors: Sequence[str], *, error: FloatArray, noise: FloatArray, norm: LogNorm
) -> QuadMesh:
    """Error in each band of each sensor; what is within ``NOISE_MARGIN`` of the noise is left pale.

    Args:
        ax: to draw on.
        frequency: (n_bands,) centres, Hz.
        sensors: names.
        error: (n_sensors, n_bands) over the channel's rms.
        noise: (n_sensors, n_bands) the same for a perfect model.
        norm: of the colours.
    """
    mesh = _mesh(ax, np.ma.masked_array(error, error <= NOISE_MARGIN * noise), sensors, norm)
    places, labels = frequency_ticks(frequency)
    ax.set_xticks(places, labels)
    ax.set_xlabel("frequency [Hz]")
    return mesh


def frequency_ticks(frequency: FloatArray) -> tuple[FloatArray, list[str]]:
    """Where 1, 2, 5, 10 ... Hz lie on an axis that counts bands; the bands' own centres where fewer than two do.

    Args:
        frequency: (n_bands,) centres, Hz, growing; band i reaches from i to i + 1 on the axis.
    """
    decades = 10.0 ** np.arange(np.floor(np.log10(frequency[0])), np.ceil(np.log10(frequency[-1])) + 1.0)
    rounds = np.outer(decades, (1.0, 2.0, 5.0)).ravel()
    rounds = rounds[(rounds >= frequency[0]) & (rounds <= frequency[-1])]
    if len(rounds) < FEWEST_TICKS:
        shown = np.unique(np.linspace(0, len(frequency) - 1, min(TICKS, len(frequency))).round().astype(int))
        return shown + 0.5, [f"{frequency[i]:.3g}" for i in shown]
    places = np.interp(np.log(rounds), np.log(frequency), np.arange(len(frequency)) + 0.5)
    return places, [f"{value:g}" for value in rounds]


def time_ticks(time: FloatArray) -> tuple[FloatArray, list[str]]:
    """Where round times lie on an axis that counts windows; the windows' own centres where fewer than two do.

    Args:
        time: (n_windows,) centres, s, evenly apart; window i reaches from i to i + 1 on the axis.
    """
    rounds = np.asarray(MaxNLocator(TICKS).tick_values(time[0], time[-1]))
    rounds = rounds[(rounds >= time[0]) & (rounds <= time[-1])]
    if len(rounds) < FEWEST_TICKS:
        rounds = time[:: max(1, len(time) - 1)]
    return np.interp(rounds, time, np.arange(len(time)) + 0.5), [f"{t:.4g}" for t in rounds]


def plot_time_map(ax: Axes, time: FloatArray, sensors: Sequence[str], error: FloatArray, norm: LogNorm) -> QuadMesh:
    """Error in each window of each sensor.

    Args:
        ax: to draw on.
        time: (n_windows,) centres, s.
        sensors: names.
        error: (n_sensors, n_windows) over the channel's rms.
        norm: of the colours.
    """
    mesh = _mesh(ax, np.ma.masked_array(error), sensors, norm)
    places, labels = time_ticks(time)
    ax.set_xticks(places, labels)
    ax.set_xlabel("time [s]")
    return mesh


def _mesh(ax: Axes, error: "np.ma.MaskedArray", sensors: Sequence[str], norm: LogNorm) -> QuadMesh:
    ax.set_facecolor(AT_NOISE)
    mesh = ax.pcolormesh(
        np.ma.clip(error, norm.vmin, norm.vmax), cmap=CMAP, norm=norm, edgecolors="white", linewidth=0.3
    )
    ax.set_yticks(np.arange(len(sensors)) + 0.5, [literal(name) for name in sensors])
    ax.set_ylim(len(sensors), 0)
    ax.tick_params(length=2)
    return mesh
