"""What gives an effect away in the signals: what a model leaves, and one channel held against the others."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from models.arrays import BoolArray, ComplexArray, FloatArray
from testbed.figures.report_style import COLOURS, NOISE, literal

OTHERS = "#b8c4d0"
"""Colour of the channels that no one suspects."""


class Left(NamedTuple):
    """What one model leaves of a channel.

    Attributes:
        label: of the model.
        colour: of the model.
        values: (n,) of frequency or time.
    """

    label: str
    colour: str
    values: FloatArray


def plot_left_by_frequency(ax: Axes, frequency: FloatArray, left: Sequence[Left], noise: float, unit: str) -> None:
    """Amplitude density of what the models leave, over the noise of the sensor.

    Args:
        ax: to draw on.
        frequency: (n,) Hz.
        left: of each model, in units of the channel per root hertz.
        noise: of the sensor, in the same unit.
        unit: of the channel.
    """
    for row in left:
        ax.semilogy(frequency, row.values, color=row.colour, linewidth=0.9, label=literal(row.label))
    ax.axhline(noise, color=NOISE, linewidth=1.0, linestyle="--", label="noise of the sensor")
    ax.set_xlabel("frequency [Hz]")
    ax.set_ylabel(f"left [{unit} / $\\sqrt{{\\mathrm{{Hz}}}}$]")
    ax.grid(visible=True)


def plot_left_over_time(ax: Axes, time: FloatArray, left: Sequence[Left], noise: float, unit: str) -> None:
    """Rms of what the models leave in windows, over the noise of the sensor.

    Args:
        ax: to draw on.
        time: (n,) middles of the windows, s.
        left: of each model, in units of the channel.
        noise: of the sensor, in the same unit.
        unit: of the channel.
    """
    for row in left:
        ax.semilogy(time, row.values, color=row.colour, marker="o", markersize=2.5, label=literal(row.label))
    ax.axhline(noise, color=NOISE, linewidth=1.0, linestyle="--")
    ax.set_xlabel("time [s]")
    ax.set_ylabel(f"left, rms in windows [{unit}]")
    sizes = np.concatenate([row.values for row in left] + [np.array([noise])])
    ax.set_ylim(0.5 * max(sizes.min(), LEAST_SHOWN * sizes.max()), 2.0 * sizes.max())
    ax.grid(visible=True)


LEAST_SHOWN = 1e-4
"""Smallest value shown, as a share of the largest."""


def plot_ratios(
    axes: tuple[Axes, Axes], frequency: FloatArray, ratios: ComplexArray, suspected: BoolArray, names: Sequence[str]
) -> None:
    """Each channel over the model, magnitude above and phase below, the suspected ones in front.

    Args:
        axes: for magnitude and phase.
        frequency: (n_bands,) Hz.
        ratios: (n_channels, n_bands) complex, NaN where a channel says nothing.
        suspected: (n_channels,) of which something is said.
        names: (n_channels,) sensors.
    """
    chosen = np.flatnonzero(suspected)
    together = ["every channel", *["_"] * (len(chosen) - 1)]
    labels = together if suspected.all() else [literal(names[int(i)]) for i in chosen]
    for values, ax, label, ideal in zip(
        (np.abs(ratios), np.degrees(np.angle(ratios))), axes, ("magnitude [-]", "phase [deg]"), (1.0, 0.0), strict=True
    ):
        ax.axhline(ideal, color="#444444", linewidth=0.6)
        for row in values[~suspected]:
            ax.plot(frequency, row, color=OTHERS, linewidth=0.8)
        for row, name in zip(values[suspected], labels, strict=True):
            ax.plot(frequency, row, color=COLOURS["updated"], marker="o", markersize=2.5, label=name, zorder=3)
        ax.set_xlabel("frequency [Hz]")
        ax.set_title(f"measured over calibrated model, {label}", loc="left")
        ax.grid(visible=True)
    turned = float(np.nanmax(np.abs(np.angle(ratios[suspected]))))
    if turned > 0.5 * np.pi:
        axes[1].set_yticks([-180, -90, 0, 90, 180])
    reach = 1.06 * np.degrees(max(turned, SMALL_TURN))
    axes[1].set_ylim(-reach, reach)


SMALL_TURN = 0.1
"""Phase, rad, that the axis shows at least."""
