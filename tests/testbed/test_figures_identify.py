"""Legends stand where they hide nothing, and every panel that needs one has it."""

import numpy as np
import pytest

from identification.decay.identify import identify
from models.effects.protocol import Place
from models.effects.time_varying_damping import TimeVaryingDamping
from testbed.figures.identify import Scalogram, mode_figure, sleeve_figure, spectrum_figure
from testbed.identify.sleeve import SleeveDamping

FS = 512.0


@pytest.fixture(scope="module")
def found():
    """A light mode that is a peak and a heavy one that is none."""
    t = np.arange(4096) / FS
    heavy = 0.5 * np.exp(-2.0 * np.pi * 90.0 * 0.12 * t) * np.cos(2.0 * np.pi * 90.0 * t)
    signal = np.exp(-1.0 * t) * np.cos(2.0 * np.pi * 20.0 * t) + heavy
    noisy = signal + 1e-4 * np.random.default_rng(0).standard_normal(t.size)
    return identify([noisy[None]], [0.0], FS, np.ones(1))


def test_the_spectrum_names_modes_by_how_they_were_found_beside_the_axes(found):
    figure = spectrum_figure(found, found.decays[0], "a.csv", "m/s^2")
    assert all(ax.get_legend() is None for ax in figure.axes)
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert "mode, a peak" in labels
    assert "mode, found in what the others leave" in labels


def test_every_panel_of_a_mode_has_a_legend(found):
    mode = found.decays[0].modes[0]
    lines = np.array([18.0, 20.0, 22.0])
    shown = Scalogram(mode.skeleton.time, lines, np.ones((3, len(mode.signal)), complex), mode.ridge_freq)
    figure = mode_figure(mode, shown, "a mode", "m/s^2")
    panels = [ax for ax in figure.axes if ax.get_xlabel()]
    assert len(panels) == 6
    assert all(ax.get_legend() is not None for ax in panels)
    colours = {}
    for line in (line for ax in panels for line in ax.get_lines()):
        colours.setdefault(line.get_label(), set()).add(line.get_color())
    assert all(len(drawn) == 1 for drawn in colours.values())  # one name is one curve
    assert {"crest of this map", "ridge", "identified", "smoother"} <= set(colours)


def test_the_table_is_drawn_over_the_modes_and_to_the_end():
    times = np.linspace(0.0, 1.0, 20)
    table = TimeVaryingDamping(Place(sleeve="collar"), times=(0.0,), values=(20.0,))
    damping = SleeveDamping(times, np.full(20, 20.0), np.full(20, 19.0), np.full(20, 21.0), table, 81.0, 0.0)
    figure = sleeve_figure(damping, "collar")
    (ax,) = figure.axes
    (line,) = (line for line in ax.get_lines() if line.get_label() == "time_varying_damping")
    assert line.get_xdata()[-1] == 1.0
    assert all(line.get_zorder() > other.get_zorder() for other in ax.get_children() if other in ax.collections)
    assert ax.get_legend() is None
