"""A figure as a part of a page."""

import re

from matplotlib.figure import Figure

from testbed.report.picture import picture


def drawn(width):
    figure = Figure(figsize=(3.0, 2.0))
    ax = figure.add_axes((0.1, 0.1, width, 0.8))
    ax.plot([0.0, 1.0], [0.0, 1.0], "o-")
    return picture(figure, "a line", "", "svg").data


def test_a_drawing_names_its_parts_by_number_so_that_round_off_moves_none_of_them():
    one, other = drawn(0.8), drawn(0.8 + 1e-12)
    assert one == other
    parts = re.findall(rb'id="(part\d+)"', one)
    assert parts
    assert len(parts) == len(set(parts))
    used = {name for pair in re.findall(rb"url\(#(\w+)\)|href=\"#(\w+)\"", one) for name in pair if name}
    assert used
    assert used <= set(parts)
