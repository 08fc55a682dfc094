"""The error falling from model to model, against the noise floor."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullFormatter

from models.arrays import FloatArray
from testbed.figures.report_style import MEASURED, NOISE, literal

TWO_DIGITS = 9.95
"""Per cent from which no decimal is shown."""

CLEAR = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 0.8}
"""Behind a number, so that a line that runs through it leaves it readable."""


def plot_error_steps(ax: Axes, labels: Sequence[str], errors: FloatArray, noise: float, colours: Sequence[str]) -> None:
    """Error of each model in order, and the noise floor as a line.

    Args:
        ax: to draw on.
        labels: of the models.
        errors: (n_models,) NRMSE.
        noise: NRMSE of a perfect model.
        colours: of the models.
    """
    place = np.arange(len(labels))
    values = 100.0 * np.array([_three_digits(error) for error in errors])
    noise = _three_digits(noise)
    ax.step(place, values, where="mid", color="#bbbbbb", linewidth=1.0, zorder=1)
    ax.scatter(place, values, s=46, c=list(colours), zorder=3, label="records learned from")
    for x, y in zip(place, values, strict=True):
        ax.annotate(
            f"{y:.0f} %" if y >= TWO_DIGITS else f"{y:#.2g} %",
            (x, y),
            (0, 7),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8.5,
            bbox=CLEAR,
        )
    ax.axhline(100.0 * noise, color=NOISE, linewidth=1.0, linestyle="--", zorder=1)
    ax.annotate(
        f"noise floor {100.0 * noise:.2g} %", (0.0, 100.0 * noise), (4, -3), xycoords=("axes fraction", "data"),
        textcoords="offset points", ha="left", va="top", fontsize=8.5, color="#666666",
    )  # fmt: skip
    ax.set_xticks(place, [literal(label) for label in labels])
    ax.set_xlim(-0.6, len(labels) - 0.4)
    _percent_axis(ax)


def plot_holdout(ax: Axes, place: Sequence[int], errors: FloatArray, noise: float) -> None:
    """Errors on records kept aside, hollow, beside the models that made them.

    Args:
        ax: of ``plot_error_steps``.
        place: index of each model.
        errors: NRMSE of each.
        noise: NRMSE of a perfect model on these records.
    """
    x, values = np.asarray(place) + 0.18, 100.0 * np.array([_three_digits(error) for error in errors])
    ax.scatter(
        x, values, s=40, marker="D", facecolors="none", edgecolors=MEASURED, linewidths=1.0, zorder=3,
        label=f"records kept aside (noise {100.0 * noise:.2g} %)",
    )  # fmt: skip
    for at, y in zip(x, values, strict=True):
        ax.annotate(
            f"{y:.0f} %" if y >= TWO_DIGITS else f"{y:#.2g} %",
            (at, y),
            (8, 0),
            textcoords="offset points",
            ha="left",
            va="center",
            fontsize=8,
            bbox=CLEAR,
        )
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, values.min() / ROOM), max(high, values.max() * ROOM))


def _three_digits(error: float) -> float:
    """So that the rounding of another run moves no point of a picture that is kept in git."""
    return float(f"{error:.3g}")


ROOM = 1.6
"""Factor that an axis of errors leaves below its least and above its largest value."""


def _percent_axis(ax: Axes) -> None:
    ax.set_yscale("log")
    ax.set_ylabel("error, NRMSE [%]")
    low, high = ax.get_ylim()
    ax.set_ylim(low / ROOM, high * ROOM)
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.yaxis.set_minor_formatter(NullFormatter())
    ax.grid(visible=True, axis="y")
    ax.set_axisbelow(True)
