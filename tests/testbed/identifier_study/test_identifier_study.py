"""The study in small: few records, every row made, the page and the figures written from them."""

import json
from itertools import pairwise

import numpy as np
import pytest

from testbed.figures.identifier_study import bound_figure, objective_figure, verification_figure
from testbed.identifier_study.bound_table import cell_of
from testbed.identifier_study.page import page_of, study_json
from testbed.identifier_study.searches import (
    MULTISCALE,
    AblationRow,
    RunRow,
    grid_shares,
    search_of,
    search_rows,
    tracking_time,
)
from testbed.identifier_study.study import Study
from testbed.identifier_study.verification import Scales, floor_of, trace_of, verification_rows
from testbed.outputs import json_text

SCALES = Scales(MULTISCALE, 2.0**6.7, 2.0**7.2)


class Serial:
    """A pool of one: this process."""

    def map(self, function, *columns):
        return map(function, *columns)


@pytest.fixture(scope="module")
def study():
    keys = [("step", 60.0), ("line", 60.0)]
    rows = list(verification_rows(dict.fromkeys(keys, SCALES), 2, Serial()))
    search = search_of("step", 60.0, False, 0)
    found = {("step", 60.0, False): search}
    cells = [cell_of(40.0, 0.005, None, 6), cell_of(40.0, 0.005, 0.1, 4)]
    runs = [RunRow(n, 6.7, 0.06, 0.01, 250) for n in range(1, 11)]
    ablation = [AblationRow("step", 60.0, "gaussian", "fitted", 0.0018)]
    traces = [trace_of(*key, SCALES, 0) for key in keys]
    shares = grid_shares(search, "step", 60.0)
    return Study(rows, list(search_rows(found)), search, shares, runs, ablation, cells, traces, {"ridge": 0.9}, 2)


def test_the_smoother_meets_its_bars_and_the_ridge_the_articles(study):
    step, line = study.rows
    assert study.missed == []
    assert step.smoother < step.past_jumps < step.multiscale
    assert step.past_jumps < 0.0017
    assert line.ridge < 0.0037
    assert step.floor == pytest.approx(0.00032, rel=0.03)


def test_poles_reach_the_bound_and_nothing_goes_far_below(study):
    for cell in study.cells:
        for value in cell.ratios["poles"]:
            # a handful of records know an rms error to a third
            assert 0.2 < value < 2.5
        assert cell.lost == {"poles": 0, "smoother": 0, "ridge": 0}


def test_a_missed_bar_is_told(study):
    row = study.rows[0]
    worse = Study(**{**vars(study), "rows": [type(row)(**{**vars(row), "smoother": 0.01, "told": 0.01})]})
    assert len(worse.missed) == 2
    assert "0.01 against 0.0006" in worse.missed[0]


def test_the_page_holds_every_row_and_the_json_is_json(study):
    page = page_of(study, "testbed study identifier --out here")
    assert "All bars were met" in page
    assert page.count("| step | 60 |") >= 1 + len(study.searches)
    assert all(len(line.split("|")) == len(page_line.split("|")) for line, page_line in pairs_of_table_lines(page))
    assert json.loads(json_text(study_json(study)))["seeds"] == 2


def pairs_of_table_lines(page):
    """Neighbouring lines of each table: all have the same number of columns."""
    lines = page.splitlines()
    return [(a, b) for a, b in pairwise(lines) if a.startswith("|") and b.startswith("|")]


def test_the_figures_show_what_was_computed(study):
    figure = verification_figure(study.traces)
    assert len(figure.axes) == 2 * len(study.traces)
    assert len(bound_figure(study.cells, two_modes=True).axes) == 6
    bars, _ = objective_figure(study.step_search, study.shares).axes
    assert len(bars.patches) == 2 * len(study.shares)


def test_tracking_is_the_time_from_one_level_to_the_other():
    time = np.linspace(0.0, 100.0, 10001)
    ramp = np.interp(time, [0.0, 49.0, 51.0, 100.0], [0.06, 0.06, 0.01, 0.01])
    assert tracking_time(time, ramp, 0.06, 0.01, 50.0) == pytest.approx(0.8 * 2.0, abs=0.03)


def test_a_floor_is_lower_with_less_noise():
    assert floor_of("line", 60.0).rms == pytest.approx(0.1 * floor_of("line", 40.0).rms, rel=1e-6)
