"""From which size on effects are found."""

from math import exp, log

import numpy as np
import pytest
from made_up_cases import made_up

from testbed.hidden_effects.detection import SIZES, detection, limit_of
from testbed.hidden_effects.page import page_of
from testbed.hidden_effects.scores import summary_of
from testbed.hidden_effects.sets import Span


def drawn(n, limit, steepness, seed=0):
    """Cases of which nine in ten are right at the limit."""
    rng = np.random.default_rng(seed)
    sizes = np.exp(rng.uniform(log(0.5), log(30.0), n))
    share = 1.0 / (1.0 + exp(-log(9.0)) * (sizes / limit) ** -steepness)
    return [{"ratio": float(s), "right": bool(r)} for s, r in zip(sizes, rng.random(n) < share, strict=True)]


def test_the_limit_is_where_nine_of_ten_are_right():
    found = limit_of(drawn(20000, 3.0, 2.0))
    assert found["ratio"] == pytest.approx(3.0, rel=0.05)
    low, high = found["interval"]
    assert 2.7 < low < 3.0 < high < 3.3


def test_the_interval_holds_the_limit_in_most_draws():
    held = [found["interval"] for seed in range(40) for found in [limit_of(drawn(200, 3.0, 2.0, seed))]]
    inside = sum((low or 0.0) <= 3.0 <= (high or np.inf) for low, high in held)
    assert inside >= 33  # of 40, that 95 % give fewer in one of fourteen hundred tests


@pytest.mark.parametrize("one_in", [6, 12])
def test_misses_that_have_nothing_to_do_with_size_tell_no_limit(one_in):
    sizes = enumerate(np.geomspace(1.1, 20.0, 120).tolist())
    found = limit_of([{"ratio": ratio, "right": n % one_in != 0} for n, ratio in sizes])
    assert None in found["interval"]
    assert one_in == 12 or found["ratio"] is None


@pytest.mark.parametrize("right", [True, False])
def test_where_all_or_none_are_right_there_is_no_limit(right):
    assert limit_of([{"ratio": 2.0 + n, "right": right} for n in range(9)]) == {
        "ratio": None,
        "interval": [None, None],
    }


def test_each_snr_has_its_own_limit():
    rows = [row | {"snr_db": 41.0} for row in drawn(2000, 6.0, 2.0)]
    rows += [row | {"snr_db": 44.0} for row in drawn(2000, 2.0, 2.0)]
    low, high = detection(rows, Span(40.0, 45.0))["limits"]
    assert (low["cases"], high["cases"]) == (2000, 2000)
    assert low["ratio"] == pytest.approx(6.0, rel=0.2)
    assert high["ratio"] == pytest.approx(2.0, rel=0.2)
    assert SIZES[0] < high["interval"][0] < high["interval"][1] < low["interval"][0]


def test_effects_of_each_size_are_counted_by_their_snr():
    cases = [made_up("point_mass", 6 * n, right=n > 0, ratio=1.5 + n) for n in range(3)]  # all at 40 dB
    summary = summary_of(cases, "reported")

    counts = {row["from"]: row["counts"] for row in summary["detection"]["by_size"]}
    assert counts[0.0] == [{"right": 0, "cases": 1}, {"right": 0, "cases": 0}]
    assert counts[2.0][0] == {"right": 1, "cases": 1}
    assert counts[3.0][0] == {"right": 1, "cases": 1}
    page = page_of(summary, {}, "testbed")
    assert "| 2 to 3 | 1 of 1 | 0 of 0 | 1 of 1 | 0.03 to 1.00 |" in page
    assert "At 40 to 42.5 dB nine of ten effects are right that show" in page
