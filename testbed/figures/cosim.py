"""The picture of a co-simulation: the sleeve's damping, and the twin's error."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from testbed.cosim.lockstep import Exchanges, Run
from testbed.cosim.measures import Measures
from testbed.cosim.plan import Plan
from testbed.figures.report_style import literal

TRUTH, FOUND, FED_BACK, ALONE = "0.75", "#2b6cb0", "#d1491b", "0.55"


BEYOND = 1.5
"""The errors are drawn as far as this many times what most of them reach; a step shows larger ones."""

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
            f"{plan.sleeve}: identified to {measures.identified:.2%}, fed back to {measures.fed_back:.2%}, "
            f"{1e3 * measures.lag:.0f} ms late, {measures.real_time_factor:.1f} times as fast as it happens"
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
    ax.step(got.acts, got.values, where="post", color=FED_BACK, linewidth=0.9, label="fed back")
    ax.set_ylabel("contact damping [N s/m]")
    ax.grid(color="0.93")
    ax.legend(loc="best", fontsize=8)


def plot_errors(ax: Axes, got: Exchanges, measures: Measures) -> None:
    """What was identified, each at the time for which it speaks, and fed back, minus the truth.

    Args:
        ax: to draw on.
        got: what was identified.
        measures: with the errors.
    """
    low, high = measures.identified_error + (got.bounds - got.values[:, None]).T
    ax.axhline(0.0, color=TRUTH, linewidth=0.8)
    ax.vlines(got.times, low, high, color=FOUND, linewidth=1.0, alpha=0.35)
    ax.plot(got.times, measures.identified_error, ".", color=FOUND, markersize=2.5)
    ax.plot(measures.fed_back_times, measures.fed_back_error, color=FED_BACK, linewidth=0.9)
    ax.set_ylim(-BEYOND * measures.typical_error, BEYOND * measures.typical_error)
    ax.set_ylabel("minus the truth [N s/m]")
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
