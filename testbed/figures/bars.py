"""The error of each channel beside what the noise alone leaves."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from models.arrays import FloatArray


def plot_errors(ax: Axes, sensors: Sequence[str], errors: FloatArray, noise: FloatArray) -> None:
    """Per-channel NRMSE and noise floor.

    Args:
        ax: to draw on.
        sensors: names.
        errors: (n_sensors,) NRMSE of the model.
        noise: (n_sensors,) NRMSE of a perfect model.
    """
    place = np.arange(len(sensors))
    ax.bar(place - 0.2, errors, 0.4, color="tab:red", label="model")
    ax.bar(place + 0.2, noise, 0.4, color="0.6", label="noise floor")
    ax.set_yscale("log")
    ax.set_xticks(place, list(sensors))
    ax.set_ylabel("NRMSE [-]")
