"""Figures of the article's case study on what is uncertain, and on what a prediction is good for."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from testbed.outputs import Json

MILLI = 1e3


def coincidence_figure(found: Json) -> Figure:
    """Figure 11: distributions of the computed and of the measured natural frequencies, one panel an order."""
    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    for order, ax in enumerate(figure.subplots(2, 2).ravel()):
        curves = found["densities"][order]
        freq = np.array(curves["frequency"])
        for key, colour, label in (
            ("tests", "tab:red", "test, tap by tap"),
            ("posterior", "0.1", "computed, posterior"),
            ("assumed", "tab:blue", "computed, assumed normals"),
        ):
            ax.fill_between(freq, curves[key], color=colour, alpha=0.2)
            ax.plot(freq, curves[key], color=colour, linewidth=1.0, label=label)
        share, within = found["coincidence"]["posterior"][order]
        ax.set_title(f"order {order + 1}: {share:.2f} +- {within:.2f} in common with the posterior", fontsize=9)
        ax.set(ylim=(0.0, None), xlabel="natural frequency [Hz]", yticks=[])
    figure.axes[0].legend(fontsize=7)
    return figure


def shares_figure(found: Json) -> Figure:
    """Shares of the variance of four frequencies and of the struck response, first order and total, with intervals."""
    figure = Figure(figsize=(10.0, 3.4), layout="constrained")
    shares, emulator = found["shares"], found["emulator"]
    columns = [
        *(
            (f"f{order + 1}", *(shares[key][order] for key in ("first", "first_within", "total", "total_within")))
            for order in range(4)
        ),
        ("struck response", *(emulator[key] for key in ("shares", "shares_within", "totals", "totals_within"))),
    ]
    at = np.arange(len(shares["names"]))
    for ax, (title, first, first_within, total, total_within) in zip(
        figure.subplots(1, len(columns), sharey=True), columns, strict=True
    ):
        ax.barh(at + 0.18, first, 0.36, xerr=first_within, color="tab:blue", label="alone", error_kw={"lw": 0.8})
        ax.barh(at - 0.18, total, 0.36, xerr=total_within, color="0.7", label="in all", error_kw={"lw": 0.8})
        ax.set(title=title, xlim=(0.0, 1.1), yticks=at, yticklabels=shares["names"])
    figure.axes[0].invert_yaxis()
    figure.axes[0].legend(fontsize=7)
    figure.supxlabel("share of the variance", fontsize=9)
    return figure


def emulator_figure(found: Json) -> Figure:
    """The emulator against direct simulation at points that it has not seen."""
    emulator = found["emulator"]
    figure = Figure(figsize=(4.6, 4.2), layout="constrained")
    ax = figure.subplots()
    simulated = np.array(emulator["simulated"])
    ax.plot([simulated.min(), simulated.max()], [simulated.min(), simulated.max()], color="0.7", linewidth=0.8)
    ax.errorbar(
        simulated, emulator["predicted"], yerr=1.96 * np.array(emulator["stds"]), fmt="o", markersize=3, linewidth=0.7
    )
    ax.set(xlabel="simulated, rms of the tip [m/s^2]", ylabel="emulated, with 95 % interval [m/s^2]")
    return figure


def slews_figure(rows: Sequence[Json], engine: str) -> Figure:
    """The tip's error over time for the base's course of every model, one panel a clearance."""
    columns = min(3, len(rows))
    lines = -(-len(rows) // columns)
    figure = Figure(figsize=(3.6 * columns + 0.6, 2.7 * lines), layout="constrained")
    panels = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for ax, row in zip(panels, rows, strict=False):
        wanted = np.array(row["wanted"])
        time = np.arange(len(wanted)) / row["rate"]
        for number, (name, course) in enumerate(row["courses"].items()):
            error = np.abs(np.array(course["engines"][engine]["tip"]) - wanted)
            ax.semilogy(time, MILLI * np.maximum(error, 1e-9), color=f"C{number}", linewidth=0.8, label=name)
        ax.set_title(f"{MILLI * row['clearance']:g} mm", fontsize=9)
        ax.set(ylim=(1e-5, 10.0), xlim=(0.6, 2.0))
        ax.grid(visible=True, color="0.93")
    for ax in panels[-columns:]:
        ax.set_xlabel("time [s]")
    panels[0].set_ylabel("tip's error [mm]")
    panels[0].legend(fontsize=7)
    return figure
