"""The figure of one sensor's FRFs at each level."""

from matplotlib.figure import Figure

from testbed.figures.frf import plot_coherence, plot_frf, tells
from testbed.frf_record import Levels


def levels_figure(levels: Levels, sensor: int) -> Figure:
    """H1 and H2 of every level above their coherence where that tells something, one column a level.

    Args:
        levels: finished.
        sensor: index of the sensor.
    """
    channels, n = levels.channels, len(levels.estimates)
    figure = Figure(figsize=(max(7.0, 4.0 * n), 5.0), layout="constrained")
    told = any(tells(estimate.coherence[sensor]) for estimate in levels.estimates)
    ratios = (2, 1) if told else (1,)
    axes = figure.subplots(len(ratios), n, squeeze=False, sharex=True, sharey="row", height_ratios=ratios)
    for column, estimate in enumerate(levels.estimates):
        curves = {"H1": estimate.h1[sensor], "H2": estimate.h2[sensor]}
        label = f"{channels.sensors[sensor]} [{levels.units[sensor]}]"
        plot_frf(axes[0, column], estimate.frequency, curves, label)
        if told:
            plot_coherence(axes[1, column], estimate.frequency, estimate.coherence[sensor])
        axes[-1, column].set_xlabel("frequency [Hz]")
        axes[0, column].set_title(f"rms {estimate.level:.3g} {levels.excitation_unit}", fontsize=9)
    axes[0, 0].legend(fontsize=8)
    return figure
