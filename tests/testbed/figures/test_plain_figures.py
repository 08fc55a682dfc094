"""What a reader sees in the commands' pictures: axes that hold something, ticks that are read, names that are told."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from models.rig import Beam, Excitation, Rig, Sensor
from testbed.compare import FrfPair
from testbed.figures.bars import plot_errors
from testbed.figures.comparison import frf_figure
from testbed.figures.frf import tells
from testbed.figures.report_errors import plot_error_steps
from testbed.figures.report_maps import frequency_ticks, time_ticks
from testbed.figures.sweep import sweep_figure

NAMES = ("P1", "P2", "P3")
RIG = Rig(
    structure=Beam(kind="beam", length=1.0, diameter=0.02, youngs_modulus=2e11, density=7850.0),
    excitation=Excitation(position=0.5),
    sensors=tuple(Sensor(name=name, position=0.3 * i) for i, name in enumerate(NAMES, start=1)),
)


def a_pair(coherence):
    frequency = np.arange(10.0, 20.0)
    frfs = np.ones((3, 10), complex)
    return FrfPair("sweep", NAMES, frequency, frfs, 1.1 * frfs, coherence)


@pytest.mark.parametrize(("coherence", "axes"), [(None, 3), (np.full((3, 10), 0.9), 6), (np.ones((3, 10)), 3)])
def test_three_sensors_leave_no_empty_axes_and_one_average_no_coherence(coherence, axes):
    figure = frf_figure(a_pair(coherence), RIG)
    assert len(figure.axes) == axes
    assert all(ax.lines for ax in figure.axes)
    assert sum(ax.get_xlabel() == "frequency [Hz]" for ax in figure.axes) == 2


def test_a_coherence_of_one_average_tells_nothing():
    assert not tells(None)
    assert not tells(np.ones((2, 5)))
    assert tells(np.array([[1.0, 0.99]]))


@pytest.mark.parametrize(
    ("errors", "noise"), [((0.385, 0.6, 0.5), (0.3, 0.3, 0.3)), ((0.4, 0.5, 1.1), (0.01, 9e-3, 8e-3))]
)
def test_errors_are_points_on_an_axis_with_numbers_that_are_read(errors, noise):
    figure = Figure()
    FigureCanvasAgg(figure)
    ax = figure.subplots()
    plot_errors(ax, NAMES, np.array(errors), np.array(noise))
    figure.canvas.draw()
    assert not ax.patches  # a bar has no beginning on a logarithmic axis
    low, high = ax.get_ylim()
    ticks = [
        label.get_text() for label, at in zip(ax.get_yticklabels(), ax.get_yticks(), strict=True) if low <= at <= high
    ]
    assert len(ticks) >= 3
    assert all("times" not in text and float(text) > 0.0 for text in ticks)
    assert not any(label.get_text() for label in ax.get_yticklabels(minor=True))


def test_the_ticks_of_a_map_of_bands_are_round_and_where_they_belong():
    centres = np.geomspace(5.16, 645.0, 20)
    places, labels = frequency_ticks(centres)
    assert labels == ["10", "20", "50", "100", "200", "500"]
    back = np.exp(np.interp(places, np.arange(20) + 0.5, np.log(centres)))
    np.testing.assert_allclose(back, [float(label) for label in labels], rtol=1e-12)
    assert frequency_ticks(np.array([31.0, 33.0]))[1] == ["31", "33"]


def test_the_first_picture_does_not_move_by_rounding():
    def drawn(error):
        ax = Figure().subplots()
        plot_error_steps(ax, ["given", "calibrated"], np.array([error, 0.1]), error / 10.0, ["k", "b"])
        return ax.collections[0].get_offsets().tolist(), [line.get_ydata() for line in ax.lines][-1]

    assert str(drawn(0.27123)) == str(drawn(0.27123 + 1e-9))


def test_unstable_motion_is_told_once_without_a_colour_and_the_axis_says_what_it_is():
    def curve(level, stable):
        peaks = level * np.array([[1.0], [2.0], [1.0]])
        return SimpleNamespace(
            amplitudes=np.full(3, level),
            freqs=np.array([10.0, 11.0, 12.0]),
            is_stable=np.array(stable),
            peaks=lambda _: peaks,
        )

    curves = (curve(1.0, [True, False, True]), curve(5.0, [True, False, True]))
    found = SimpleNamespace(
        curves=curves, spine=None, sensor="P3", unit="m/s^2", level_unit="N", band=(10.0, 12.0), rig=RIG
    )
    (ax,) = sweep_figure(found).axes
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["1 N", "5 N", "dotted: unstable"]
    grey = ax.get_legend().get_lines()[-1].get_color()
    assert grey not in {line.get_color() for line in ax.lines[:4]}
    assert ax.get_ylabel() == "half the swing of P3 [m/s^2]"


@pytest.mark.parametrize("n", [2, 5, 11, 28, 40])
def test_the_times_of_a_map_are_round_and_evenly_apart(n):
    width = 0.37
    time = width * (np.arange(n) + 0.5)
    places, labels = time_ticks(time)
    read = np.array([float(label) for label in labels])
    assert 2 <= len(labels) <= 8
    assert np.diff(places) == pytest.approx(np.diff(places)[0])
    # A label of four digits stands within their last half from where it says.
    assert width * places == pytest.approx(read, abs=5e-4 * read.max())


def test_a_map_of_one_window_tells_its_time():
    places, labels = time_ticks(np.array([0.25]))
    assert (places.tolist(), labels) == ([0.5], ["0.25"])
