"""The picture of a co-simulation: the sleeve's damping, and the twin's error."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from testbed.cosim.lockstep import Exchanges, Run
from testbed.cosim.measures import Measures
from testbed.cosim.plan import Plan
from testbed.figures.report_style import literal

TRUTH, FOUND, FED_BACK, ALONE = "0.75", "#2b6cb0", "#d1491b", "0.55"


BEYOND = 1.5
"""The axis of errors runs straight up to this many times what most of them reach, and by decades to the largest."""

STRAIGHT = 2.0
"""Length of that straight part, on either side, in decades."""

ROOM = 1.3
"""Times the largest error, where its axis ends."""

LEAST_ERROR = 1e-5
"""NRMSE below which twins are alike."""


def cosim_figure(plan: Plan, run: Run, measures: Measures) -> Figure:
    """Damping over time, true, identified with its interval and fed back; its errors; the twin's error.

    Args:
        plan: what was run.
        run: finished.
        measures: of the run.
    """
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 2))
    plot_damping(top, run.exchanges, measures)
    plot_errors(middle, run.exchanges, measures)
    plot_twin(bottom, measures)
    bottom.set_xlim(0.0, float(measures.truth_times[-1]))
    bottom.set_xlabel("time [s]")
    top.set_title(
        literal(
            f"{plan.sleeve}: identified to {measures.identified:.2%}, fed back to {measures.fed_back:.2%} from "
            f"{measures.first_exchange:.2g} s on, {1e3 * measures.lag:.0f} ms late, "
            f"{measures.real_time_factor:.1f} times as fast as it happens"
        ),
        loc="left",
        fontsize=10,
    )
    return figure


def plot_damping(ax: Axes, got: Exchanges, measures: Measures) -> None:
    """The sleeve's damping: true, identified with 95 % intervals, and as the twin moved with it.

    Args:
        ax: to draw on.
        got: what was identified.
        measures: with the truth.
    """
    ax.plot(measures.truth_times, measures.truth, color=TRUTH, linewidth=2.5, label="truth")
    ax.vlines(got.times, *got.bounds.T, color=FOUND, linewidth=1.0, alpha=0.5, label="identified, 95 % interval")
    ax.plot(got.times, got.values, ".", color=FOUND, markersize=2.5)
    acts, values = [0.0, *got.acts, measures.truth_times[-1]], [measures.start, *got.values, got.values[-1]]
    label = "what the twin moves with: its start, then fed back"
    ax.step(acts, values, where="post", color=FED_BACK, linewidth=0.9, label=label)
    ax.set_ylabel("contact damping [N s/m]")
    ax.grid(color="0.93")
    ax.legend(loc="best", fontsize=8)


def plot_errors(ax: Axes, got: Exchanges, measures: Measures) -> None:
    """What was identified, each at the time for which it speaks, and what the twin moves with, minus the truth.

    Args:
        ax: to draw on.
        got: what was identified.
        measures: with the errors.
    """
    low, high = measures.identified_error + (got.bounds - got.values[:, None]).T
    ax.axhline(0.0, color=TRUTH, linewidth=0.8)
    ax.vlines(got.times, low, high, color=FOUND, linewidth=1.0, alpha=0.35)
    ax.plot(got.times, measures.identified_error, ".", color=FOUND, markersize=2.5)
    ax.plot(measures.moved_times, measures.moved_error, color=FED_BACK, linewidth=0.9)
    straight = BEYOND * measures.typical_error
    largest = max(float(np.abs(errors).max()) for errors in (low, high, measures.moved_error))
    limit = max(straight, ROOM * largest)
    inside = MaxNLocator(4, symmetric=True).tick_values(-straight, straight)
    decades = 10.0 ** np.arange(np.ceil(np.log10(2.0 * straight)), np.log10(limit))
    ax.set_yscale("symlog", linthresh=straight, linscale=STRAIGHT)
    ax.set_yticks([*(tick for tick in inside if abs(tick) <= straight), *decades, *-decades])
    ax.yaxis.set_major_formatter("{x:g}")
    ax.minorticks_off()
    ax.set_ylim(-limit, limit)
    ax.set_ylabel(f"minus the truth [N s/m],\nby decades beyond {straight:.2g}")
    ax.grid(color="0.93")


def plot_twin(ax: Axes, measures: Measures) -> None:
    """NRMSE of the twin's channels over time, with feedback and without.

    Args:
        ax: to draw on.
        measures: of the run.
    """
    ax.plot(measures.times, measures.alone_over_time, color=ALONE, label=f"told nothing: {measures.alone:.2%}")
    ax.plot(measures.times, measures.told_over_time, color=FED_BACK, label=f"told: {measures.told:.2%}")
    ax.set_yscale("log")
    ax.set_ylim(bottom=LEAST_ERROR)
    ax.set_ylabel("NRMSE of the twin [-]")
    ax.grid(color="0.93")
    ax.legend(loc="best", fontsize=8)
