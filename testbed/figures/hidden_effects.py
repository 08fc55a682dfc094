"""Figures of the hidden-effect benchmark, from the content of its ``summary.json``."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from testbed.hidden_effects.bars import interval_of, threads_of
from testbed.hidden_effects.detection import SIZES
from testbed.hidden_effects.plan import NOTHING, OUTSIDE
from testbed.hidden_effects.scores import STAGES, beliefs_of
from testbed.outputs import Json

PLAIN = FuncFormatter(lambda value, _: f"{value:g}")

VERDICTS = ("complete", "unexplained")

RIGHT, WRONG = "tab:blue", "tab:red"


def figures_of(summary: Json) -> Iterator[tuple[str, Figure]]:
    """Every figure with its file's name; those without a case to show are left out.

    Args:
        summary: content of ``summary.json``.
    """
    if summary["confusion"]:
        rows = len(summary["confusion"])
        figure = Figure(figsize=(11.0, 3.0 + 0.27 * rows), layout="constrained")
        plot_confusion(figure.subplots(), summary["confusion"])
        yield "confusion", figure
    beliefs = {title: rows for title, rows in beliefs_of(summary).items() if rows}
    if beliefs:
        figure = Figure(figsize=(5.0 * len(beliefs), 4.5), layout="constrained")
        for ax, title in zip(figure.subplots(1, len(beliefs), squeeze=False)[0], beliefs, strict=True):
            plot_calibration(ax, beliefs[title], title)
        yield "calibration", figure
    if summary["held_out"]["rows"]:
        figure = Figure(figsize=(11.0, 4.5), layout="constrained")
        plot_held_out(figure.subplots(), summary["held_out"]["rows"])
        yield "held_out", figure
    if summary["detection"]["rows"]:
        figure = Figure(figsize=(8.0, 4.5), layout="constrained")
        plot_detection(figure.subplots(), summary["detection"])
        yield "detection", figure
    if summary["seconds"]["rows"]:
        figure = Figure(figsize=(6.0, 4.0), layout="constrained")
        plot_seconds(figure.subplots(), summary["seconds"])
        yield "seconds", figure


def plot_confusion(ax: Axes, table: Mapping[str, Mapping[str, int]]) -> None:
    """How often each kind was taken for which.

    Args:
        ax: to draw on.
        table: true kind -> named kind or verdict -> count.
    """
    classes = [name for name in (NOTHING, OUTSIDE) if name in table]
    true = [*(name for name in table if name not in classes), *classes]
    kinds = [name for name in true if name not in classes]
    named = {name for row in table.values() for name in row}
    order = [*kinds, *sorted(named - {*kinds, *VERDICTS}), *VERDICTS]
    counts = np.array([[table[kind].get(name, 0) for name in order] for kind in true])
    ax.imshow(counts / counts.sum(axis=1, keepdims=True), cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for (i, j), count in np.ndenumerate(counts):
        if count:
            share = count / counts[i].sum()
            ax.text(j, i, str(count), ha="center", va="center", fontsize=8, color="white" if share > 0.6 else "black")
    ax.set_xticks(range(len(order)), order, rotation=60, ha="right", fontsize=8)
    ax.set_yticks(range(len(true)), true, fontsize=8)
    ax.set(xlabel="named first, or the verdict", ylabel="hidden")
    ax.set_title("cases of one effect, of none, and outside the library", fontsize=10)


def plot_calibration(ax: Axes, rows: Sequence[Json], title: str) -> None:
    """How often the diagnosis is right where it believes so much.

    Args:
        ax: to draw on.
        rows: ``believed``, ``right`` and ``cases`` of each bin.
        title: of which batches.
    """
    place = np.arange(len(rows))
    believed = np.array([row["believed"] for row in rows])
    shares = np.array([row["right"] / row["cases"] for row in rows])
    intervals = np.array([interval_of(row["right"], row["cases"]) for row in rows])
    ax.plot(place, believed, "_", color="black", markersize=22, label="believed, mean")
    ax.errorbar(place, shares, np.abs(intervals.T - shares), fmt="o", color=RIGHT, capsize=3, label="right")
    ticks = [f"{row['believed']:.4g}\n{row['right']} of {row['cases']}" for row in rows]
    ax.set_xticks(place, ticks, fontsize=8)
    ax.set(xlim=(-0.5, len(rows) - 0.5), ylim=(0.0, 1.05), ylabel="share [-]")
    ax.set_xlabel("probability of the first effect, and how often it is there")
    ax.set_title(f"{title}, 95 % intervals", fontsize=10)
    ax.legend(fontsize=8, loc="lower right")


def plot_held_out(ax: Axes, rows: Sequence[Json]) -> None:
    """Errors on the records held out over the true noise, as given, calibrated and with what was added.

    Args:
        ax: to draw on.
        rows: of each case.
    """
    ordered = sorted(rows, key=lambda row: (row["class"], row["calibrated"]))
    place = np.arange(len(ordered))
    for stage, colour, marker in zip(STAGES, ("0.6", "tab:orange", RIGHT), ("_", "x", "."), strict=True):
        ax.plot(place, [row[stage] for row in ordered], marker, color=colour, label=stage)
    ax.axhline(1.0, color="black", linewidth=0.8, label="noise")
    classes = [row["class"] for row in ordered]
    for name in dict.fromkeys(classes):
        first = classes.index(name)
        ax.axvline(first - 0.5, color="0.8", linewidth=0.8)
        middle = first + 0.5 * (classes.count(name) - 1)
        ax.annotate(name.replace(" ", "\n", 1), (middle, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 4),
                    textcoords="offset points", fontsize=8, ha="center", va="bottom")  # fmt: skip
    ax.set_yscale("log")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set(xlabel="case whose truth the library holds", ylabel="error held out / true noise [-]")
    ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def plot_detection(ax: Axes, detection: Json) -> None:
    """Which sizes are found at which SNR, and from which size on nine of ten are.

    Args:
        ax: to draw on.
        detection: ``rows`` and ``limits``.
    """
    for right, colour, label in ((True, RIGHT, "right"), (False, WRONG, "not right")):
        rows = [row for row in detection["rows"] if row["right"] == right]
        ax.plot([row["snr_db"] for row in rows], [row["ratio"] for row in rows], ".", color=colour, label=label)
    for limit in detection["limits"]:
        if limit["ratio"] is not None:
            ax.plot(limit["snr_db"], [limit["ratio"]] * 2, color="black", linewidth=1.2)
            low, high = (end or edge for end, edge in zip(limit["interval"], (SIZES[0], SIZES[-1]), strict=True))
            ax.fill_between(limit["snr_db"], low, high, color="black", alpha=0.1, linewidth=0.0)
    ax.plot([], [], color="black", linewidth=1.2, label="here 90 % are right,\ninterval of 95 %")
    ax.set_yscale("log")
    limits = [limit["ratio"] for limit in detection["limits"] if limit["ratio"] is not None]
    ax.set_ylim(*_about([*(row["ratio"] for row in detection["rows"]), *limits]))
    ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
    ax.yaxis.set_major_formatter(PLAIN)
    ax.yaxis.set_minor_formatter(NullFormatter())
    ax.set(xlabel="SNR of the channels [dB]", ylabel="calibrated error / noise [-]")
    ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _about(values: Sequence[float]) -> tuple[float, float]:
    """A range around values on a logarithmic axis."""
    return 0.8 * min(values), 1.25 * max(values)


def plot_seconds(ax: Axes, seconds: Json) -> None:
    """What a diagnosis takes.

    Args:
        ax: to draw on.
        seconds: ``rows``, ``median`` and ``threads``.
    """
    rows = np.array(seconds["rows"])
    edges = np.geomspace(max(1.0, 0.9 * rows.min()), 1.1 * rows.max(), 21)
    ax.hist(rows, edges.tolist(), color=RIGHT)
    ax.axvline(seconds["median"], color="black", linewidth=1.0, label=f"median {seconds['median']:.3g} s")
    ax.set_xscale("log")
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set(xlabel=f"seconds of a diagnosis, {threads_of(seconds)}", ylabel="cases")
    ax.legend(fontsize=8)
