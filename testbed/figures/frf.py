"""FRF magnitudes and coherence over frequency."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from models.arrays import ComplexArray, FloatArray

STYLES = ({"color": "0.35"}, {"color": "tab:red", "linestyle": "--"}, {"color": "tab:blue", "linestyle": ":"})


def plot_frf(ax: Axes, frequency: FloatArray, curves: Mapping[str, ComplexArray], label: str) -> None:
    """Magnitudes of several FRFs of one sensor.

    Args:
        ax: to draw on.
        frequency: (n_freq,) Hz.
        curves: legend -> (n_freq,) FRF.
        label: of the vertical axis.
    """
    for (name, values), style in zip(curves.items(), STYLES * len(curves), strict=False):
        ax.semilogy(frequency, np.abs(values), linewidth=0.9, label=name, **style)
    ax.set_ylabel(label, fontsize=8)


ONE = 1e-9
"""By which a coherence may differ from 1 and still be that of a single average."""


def tells(coherence: FloatArray | None) -> bool:
    """Whether a coherence tells anything: of one average it is 1 everywhere, whatever the noise.

    Args:
        coherence: (..., n_freq), or None where there is none.
    """
    return coherence is not None and bool((coherence < 1.0 - ONE).any())


def plot_coherence(ax: Axes, frequency: FloatArray, coherence: FloatArray) -> None:
    """Coherence of one sensor with the excitation.

    Args:
        ax: to draw on.
        frequency: (n_freq,) Hz.
        coherence: (n_freq,) from 0 to 1.
    """
    ax.plot(frequency, coherence, color="tab:green", linewidth=0.8)
    ax.set_ylim(0.0, 1.05)
    ax.set_ylabel("coherence", fontsize=8)
