"""Figures of the article's case study."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from testbed.article.study import AtRest


def frequencies_figure(rests: Sequence[AtRest]) -> Figure:
    """Four natural frequencies against the clearance: of the linearised model, and as the article measured them."""
    figure = Figure(figsize=(9.0, 5.6), layout="constrained")
    clearances = [1e3 * rest.clearance for rest in rests]
    for order, ax in enumerate(figure.subplots(2, 2, sharex=True).ravel()):
        ours = [rest.natural_freqs[order] for rest in rests]
        theirs = [rest.measured_freqs[order] for rest in rests]
        ax.plot(clearances, theirs, "s", color="0.5", label="the article's test")
        ax.plot(clearances, ours, "o", color="tab:blue", label="linearised about rest")
        ax.set(ylabel=f"f{order + 1} [Hz]", ylim=(0.93 * min(ours + theirs), 1.03 * max(ours + theirs)))
        if order >= 2:
            ax.set_xlabel("clearance [mm]")
    figure.axes[0].legend(fontsize=8, loc="lower left")
    return figure
