from made_up_cases import made_up

from testbed.hidden_effects.newest import newest_of
from testbed.hidden_effects.page import page_of
from testbed.hidden_effects.scores import summary_of
from testbed.hidden_effects.sets import Batch

FIRST, SECOND, LAST = 11497, 15101, 18121
BATCHES = {seed: Batch("any") for seed in (FIRST, SECOND, LAST)}


def cases_of(seed, nothing, others):
    return [made_up("nothing", n, seed=seed) for n in range(nothing)] + [
        made_up("point_mass", n, seed=seed) for n in range(others)
    ]


def seeds_of(cases):
    return {case["seed"] for case in cases}


def test_the_last_batch_stands_alone_where_it_is_enough():
    cases = cases_of(FIRST, 50, 150) + cases_of(SECOND, 1, 1) + cases_of(LAST, 50, 150)
    newest = newest_of(cases, BATCHES)
    assert seeds_of(newest) == {LAST}
    assert len(newest) == 200


def test_older_batches_are_taken_whole():
    cases = cases_of(FIRST, 50, 150) + cases_of(SECOND, 30, 90) + cases_of(LAST, 25, 75)
    newest = newest_of(cases, BATCHES)
    assert seeds_of(newest) == {SECOND, LAST}
    assert len(newest) == 220


def test_enough_cases_with_too_few_of_nothing_hidden_are_not_enough():
    cases = cases_of(FIRST, 10, 30) + cases_of(SECOND, 1, 0) + cases_of(LAST, 49, 200)
    assert seeds_of(newest_of(cases, BATCHES)) == {SECOND, LAST}


def test_all_are_told_where_there_never_are_enough():
    cases = cases_of(FIRST, 10, 30) + cases_of(LAST, 2, 3)
    assert len(newest_of(cases, BATCHES)) == len(cases)


def test_the_page_tells_the_newest_apart_where_they_are_not_all():
    told = "## The newest batches"
    page = page_of(summary_of(cases_of(FIRST, 1, 1) + cases_of(LAST, 50, 150), "reported"), {}, "testbed")
    assert f"Seeds {LAST}:" in page.partition(told)[2]
    assert told not in page_of(summary_of(cases_of(FIRST, 1, 1) + cases_of(LAST, 2, 3), "reported"), {}, "testbed")
