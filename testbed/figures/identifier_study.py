"""Figures of the identifier's study: the article's verification, its scale search, and the distance to the bound."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from identification.decay.scale_search import ScaleSearch
from models.arrays import FloatArray
from testbed.identifier_study.bound_table import DAMPINGS, ESTIMATORS, SNRS, SPACINGS, Cell
from testbed.identifier_study.verification import Trace

WORST = 100.0
"""Ratios from here on have one colour."""

QUANTITIES = ("natural frequency", "damping ratio")


def verification_figure(traces: Sequence[Trace]) -> Figure:
    """The damping identified beside the true one, and its error, for every case of one noise level."""
    figure = Figure(figsize=(12.0, 4.0 * len(traces)), layout="constrained")
    axes = figure.subplots(len(traces), 2, squeeze=False)
    for (course, error), trace in zip(axes, traces, strict=True):
        course.plot(trace.time, trace.multiscale, color="0.75", linewidth=0.6, label="plain ridge at 2^6.8")
        course.plot(trace.time, trace.past_jumps, color="tab:orange", linewidth=0.9, label="ridge past jumps")
        course.fill_between(trace.time, trace.low, trace.high, color="tab:blue", alpha=0.3, linewidth=0.0, label="95 %")
        course.plot(trace.time, trace.smoother, color="tab:blue", linewidth=1.4, label="smoother, form not told")
        course.plot(trace.time, trace.truth, color="black", linestyle="--", linewidth=1.0, label="truth")
        course.set(xlabel="time [s]", ylabel="c [N s/m]", title=f"{trace.case}, {trace.snr_db:g} dB")
        course.set_ylim(trace.truth.min() - 0.01, trace.truth.max() + 0.03)
        course.legend(fontsize=8, ncols=2, loc="upper right")
        for c, style in (
            (trace.multiscale, {"color": "0.75", "linewidth": 0.6, "label": "plain ridge at 2^6.8"}),
            (trace.past_jumps, {"color": "tab:orange", "linewidth": 0.9, "label": "ridge past jumps"}),
            (trace.smoother, {"color": "tab:blue", "linewidth": 1.2, "label": "smoother"}),
        ):
            error.plot(trace.time, c - trace.truth, **style)
        error.set(xlabel="time [s]", ylabel="error of c [N s/m]", title="residual")
        error.legend(fontsize=8)
    return figure


def objective_figure(search: ScaleSearch, shares: Sequence[tuple[float, float, float]]) -> Figure:
    """The objective where each search evaluated it, and its two shares on the grid.

    Args:
        search: of the plain ridge on the step.
        shares: log2 scale, normalised error and normalised cost on the grid.
    """
    figure = Figure(figsize=(12.0, 4.5), layout="constrained")
    bars, curve = figure.subplots(1, 2)
    quantum = search.searches["quantum"]
    places, errors, costs = np.array(shares).T
    width = 0.8 * float(np.diff(places).min())
    bars.bar(places, errors, width, color="tab:blue", label="rms error, normalised")
    bars.bar(places, costs, width, bottom=errors, color="tab:red", label="operations, normalised")
    bars.set(xlabel="log2 of the scale in samples", ylabel="objective", title="the grid's evaluations")
    bars.legend(fontsize=8)
    order = np.argsort(quantum.points[:, 0])
    curve.plot(quantum.points[order, 0], quantum.values[order], color="0.5", marker=".", markersize=3, linewidth=0.7)
    for name, colour in (("grid", "tab:green"), ("golden", "tab:orange"), ("quantum", "tab:blue")):
        found = search.searches[name]
        curve.plot(found.best, [found.value], "o", color=colour, fillstyle="none", label=f"{name}: best")
    curve.set(xlabel="log2 of the scale in samples", ylabel="objective", title="where the quantum search looked")
    curve.legend(fontsize=8)
    return figure


def bound_figure(cells: Sequence[Cell], *, two_modes: bool) -> Figure:
    """Rms error over the Cramer-Rao bound, a map for each estimator and quantity.

    Args:
        cells: of the table.
        two_modes: over the distance to a second mode instead of over noise.
    """
    figure = Figure(figsize=(13.0, 7.5), layout="constrained")
    figure.suptitle("rms error over the Cramer-Rao bound" + (", two modes at 40 dB" if two_modes else ", one mode"))
    axes = figure.subplots(2, len(ESTIMATORS))
    across = SPACINGS if two_modes else SNRS
    for row, quantity in enumerate(QUANTITIES):
        for column, name in enumerate(ESTIMATORS):
            values = np.full((len(DAMPINGS), len(across)), np.nan)
            for cell in cells:
                if (cell.spacing is None) == two_modes:
                    continue
                at = SPACINGS.index(cell.spacing) if cell.spacing is not None else SNRS.index(cell.snr_db)
                value = cell.ratios[name][row]
                values[DAMPINGS.index(cell.damping_ratio), at] = np.nan if value is None else value
            labels = [f"{100 * x:g} %" for x in across] if two_modes else [f"{x:g} dB" for x in across]
            plot_ratios(axes[row, column], values, labels, f"{name}: {quantity}")
    return figure


def plot_ratios(ax: Axes, values: FloatArray, labels: Sequence[str], title: str) -> None:
    """A map of ratios with their numbers.

    Args:
        ax: to draw on.
        values: (n_dampings, n_across); nan where nothing was found.
        labels: of the columns.
        title: above.
    """
    ax.imshow(values, norm=LogNorm(1.0, WORST), cmap="viridis_r", aspect="auto", origin="lower")
    for (i, j), value in np.ndenumerate(values):
        text = "lost" if np.isnan(value) else f"{value:.3g}"
        ax.text(j, i, text, ha="center", va="center", fontsize=8, color="white" if value > 10.0 else "black")
    ax.set_xticks(range(len(labels)), labels, fontsize=8)
    ax.set_yticks(range(len(DAMPINGS)), [f"{100 * x:g} %" for x in DAMPINGS], fontsize=8)
    ax.set_ylabel("damping ratio", fontsize=8)
    ax.set_title(title, fontsize=9)
