from collections import Counter
from dataclasses import replace
from itertools import combinations, cycle, islice

import numpy as np
import pytest

from models.errors import InputError
from testbed.hidden_effects.outside import OUTSIDE_LAWS
from testbed.hidden_effects.plan import KINDS, PATTERN, PATTERN_MORE_OUTSIDE, planned
from testbed.hidden_effects.sets import REPORTED, SETS, TUNING, Batch, Span


def test_each_beginning_has_the_mix():
    for cases in (20, 200):
        counts = Counter("one" if task.kind in KINDS else task.kind for task in planned("tuning", cases))
        assert counts == {"nothing": cases // 4, "one": 11 * cases // 20, "two": cases // 10, "outside": cases // 10}


def test_more_cases_begin_with_the_fewer_and_no_case_comes_twice():
    many = planned("reported", 200)
    assert many[:60] == planned("reported", 60)
    assert len(set(many)) == 200


@pytest.fixture
def every_case_ended(monkeypatch):
    """The reported batches as they were drawn, those cases among them that never ended."""
    batches = {
        seed: replace(batch, cases=batch.cases and batch.cases + len(batch.left_out), left_out=())
        for seed, batch in REPORTED.batches.items()
    }
    monkeypatch.setitem(SETS, "reported", replace(REPORTED, batches=batches))
    return batches


def test_the_batches_follow_each_other():
    *full, (last, _) = REPORTED.batches.items()
    before = sum(batch.cases for _, batch in full)
    tasks = planned("reported", before + 60)
    assert Counter(task.seed for task in tasks) == {seed: batch.cases for seed, batch in full} | {last: 60}
    assert list(dict.fromkeys(task.seed for task in tasks)) == list(REPORTED.batches)


def test_each_batch_begins_with_its_mix(every_case_ended):
    for seed, batch in every_case_ended.items():
        groups = ["one" if task.kind in KINDS else task.kind for task in of_seed(seed)]
        mix = PATTERN_MORE_OUTSIDE if batch.more_outside else PATTERN
        assert groups
        assert groups == list(islice(cycle(mix), len(groups)))


def test_what_never_ended_is_left_out_and_moves_no_other(monkeypatch):
    drawn = []
    for left_out in ((), (("nothing", 0), ("two", 0))):
        batches = {7: Batch("as it is", left_out=left_out)}
        monkeypatch.setitem(SETS, "tuning", replace(TUNING, batches=batches))
        drawn.append([(task.kind, task.number) for task in planned("tuning", 20)])
    whole, without = drawn
    assert [each for each in whole if each not in {("nothing", 0), ("two", 0)}] == without[:18]
    assert len(without) == 20


@pytest.mark.parametrize(("more_outside", "outside"), [(False, 2), (True, 5)])
def test_a_batch_has_the_mix_that_it_says(monkeypatch, more_outside, outside):
    monkeypatch.setitem(SETS, "tuning", replace(TUNING, batches={7: Batch("as it is", more_outside=more_outside)}))
    for cases in (20, 40):
        mix = Counter("one" if task.kind in KINDS else task.kind for task in planned("tuning", cases))
        whole = {"nothing": 5, "one": 13 - outside, "two": 2, "outside": outside}
        assert mix == {group: count * cases // 20 for group, count in whole.items()}


def test_a_batch_begins_with_the_kind_and_the_law_that_it_says(every_case_ended):
    batches = every_case_ended.items()
    turned = [(seed, batch) for seed, batch in batches if batch.first_kind and batch.first_law]
    assert turned
    for seed, batch in turned:
        kinds = [task.kind for task in of_seed(seed) if task.kind in KINDS]
        outside = [task.number for task in of_seed(seed) if task.kind == "outside"]
        laws = [OUTSIDE_LAWS[number % batch.n_laws].kind for number in outside]
        assert kinds[0] == batch.first_kind
        assert len(set(kinds[: len(KINDS)])) == min(len(kinds), len(KINDS))
        assert laws[:1] in ([], [batch.first_law])  # a batch may have been ended before its first law
    assert any(task.kind == "outside" for seed, _ in turned for task in of_seed(seed))


def of_seed(seed):
    before = sum(batch.cases or 0 for batch in REPORTED.batches.values())
    return [task for task in planned("reported", before + 60) if task.seed == seed]


def test_the_kinds_take_turns():
    ones = Counter(task.kind for task in planned("tuning", 400) if task.kind in KINDS)
    assert set(ones) == set(KINDS)
    assert max(ones.values()) - min(ones.values()) <= 1


def test_only_thins_the_order():
    tasks = planned("tuning", 5, ["point_mass", "nothing"])
    assert {task.kind for task in tasks} <= {"point_mass", "nothing"}
    assert [task.number for task in planned("tuning", 3, ["point_mass"])] == [0, 1, 2]
    assert set(planned("tuning", 3, ["nothing"])) <= set(planned("tuning", 20))


def test_an_unknown_kind_is_refused():
    with pytest.raises(
        InputError, match=r"--only squeze_film; .*nothing, two, outside, .*; did you mean squeeze_film\?"
    ):
        planned("tuning", 3, ["squeze_film"])


def test_the_sets_have_other_seeds_and_other_generators():
    assert list(SETS) == ["tuning", "reported", "varied"]
    for one, other in combinations(SETS.values(), 2):
        assert set(one.batches).isdisjoint(other.batches)
        assert set(one.tests).isdisjoint(other.tests)
        assert one.length != other.length
        assert one.clearance != other.clearance
    assert TUNING.shape != REPORTED.shape


def test_a_span_is_even_over_the_logarithm_or_crowds_at_its_ends():
    rng = np.random.default_rng(0)
    draws = np.array([Span(1.0, 100.0, log=True).draw(rng) for _ in range(4000)])
    assert draws.min() >= 1.0
    assert draws.max() <= 100.0
    assert np.mean(draws < 10.0) == pytest.approx(0.5, abs=0.03)  # four standard deviations of 4000 draws
    ends = np.array([Span(0.0, 1.0).draw(rng, 0.5) for _ in range(4000)])
    assert np.mean(np.abs(ends - 0.5) > 0.4) == pytest.approx(0.41, abs=0.03)  # arcsine law: 2 (2/pi) asin(sqrt(0.1))
