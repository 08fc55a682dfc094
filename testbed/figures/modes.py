"""The figure of a rig's modes."""

import numpy as np
from matplotlib.figure import Figure

from testbed.figures.shapes import plot_shape
from testbed.modes import RigModes, sleeves_at_rest


def modes_figure(found: RigModes) -> Figure:
    """Real part of every mode shape along the beam, with sensors and sleeves, those filled that touch at rest.

    Args:
        found: of a beam.
    """
    assert found.x is not None
    n = len(found.modes.natural_freqs)
    figure = Figure(figsize=(7.0, 1.5 * n), layout="constrained")
    axes = figure.subplots(n, 1, squeeze=False, sharex=True)[:, 0]
    sleeves = [(row["position"], row["touches"]) for row in sleeves_at_rest(found)]
    at = [sensor.position for sensor in found.linear.model.plant.sensors if sensor.position is not None]
    for i, ax in enumerate(axes):
        title = f"{found.modes.natural_freqs[i]:.2f} Hz, damping ratio {100 * found.modes.damping_ratios[i]:.3g} %"
        plot_shape(ax, found.x, found.shapes[i].real, sleeves, title)
        ax.plot(at, np.interp(at, found.x, found.shapes[i].real), ".", color="black", label="sensor")
        ax.set_ylabel("shape [-]", fontsize=8)
    axes[-1].set_xlabel("position [m]")
    handles, labels = axes[0].get_legend_handles_labels()
    marks = dict(zip(labels, handles, strict=True))
    if marks:
        figure.legend(list(marks.values()), list(marks), loc="outside upper right", ncols=len(marks), fontsize=8)
    return figure
