"""Legends stand where they hide nothing, and every panel that needs one has it."""

import numpy as np
import pytest

from identification.decay.identify import identify
from models.effects.protocol import Place
from models.effects.time_varying_damping import TimeVaryingDamping
from testbed.figures.identify import Scalogram, mode_figure, sleeve_figure, spectrum_figure
from testbed.identify.sleeve import TIMES, SleeveDamping, stretches_of

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
    level = np.full(20, 20.0)
    damping = SleeveDamping(times, level, level - 1.0, level + 1.0, table, 81.0, 0.0, ((0.0, 1.0),))
    figure = sleeve_figure(damping, "collar")
    (ax,) = figure.axes
    (line,) = (line for line in ax.get_lines() if "time_varying_damping" in str(line.get_label()))
    assert line.get_xdata()[-1] == 1.0
    assert all(line.get_zorder() > other.get_zorder() for other in ax.get_children() if other in ax.collections)
    assert ax.get_legend() is None


def test_the_axis_of_a_sleeve_is_that_of_its_intervals_and_lines_end_at_gaps():
    times = np.concatenate([np.linspace(0.1, 1.0, 10), np.linspace(2.0, 3.0, 10)])
    table = TimeVaryingDamping(Place(sleeve="collar"), times=(0.1, 3.0), values=(80.0, 80.01))
    value, half = np.full(20, 80.0), np.full(20, 0.003)
    half[-1] = 50.0  # a mode's last breath
    damping = SleeveDamping(times, value, value - half, value + half, table, 81.0, 0.0, ((0.1, 1.0), (2.0, 3.0)))
    (ax,) = sleeve_figure(damping, "collar").axes
    low, high = ax.get_ylim()
    assert 79.98 < low < 79.997
    assert 80.01 < high < 80.03
    drawn = [line.get_xdata() for line in ax.get_lines() if line.get_linestyle() == "-"]
    assert [(x[0], x[-1]) for x in drawn] == [(0.1, 1.0), (2.0, 3.0)]


def test_a_stretch_ends_where_nothing_is_known_and_with_its_decay():
    times = np.concatenate([np.linspace(0.0, 1.0, TIMES), np.linspace(1.5, 9.0, TIMES)])
    known = np.ones(2 * TIMES, bool)
    assert stretches_of(times, known) == ((0.0, 1.0), (1.5, 9.0))
    known[[0, 50, 2 * TIMES - 1]] = False
    assert stretches_of(times, known) == ((times[1], times[49]), (times[51], 1.0), (1.5, times[-2]))
