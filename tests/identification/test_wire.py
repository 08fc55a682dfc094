"""What two ends have met is sent once, and nothing else of it than what it was made of."""

from dataclasses import dataclass, fields
from functools import cached_property
from gc import collect
from pickle import PicklingError

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine, oscillator

from identification.hypothesis import Hypothesis
from identification.wire import Shared, _fields_of, packed, sent_once, unpacked
from models.effects import EFFECTS


@sent_once
@dataclass(frozen=True, eq=False)
class Large:
    """Something large of which something is derived."""

    samples: np.ndarray

    @cached_property
    def power(self):
        return self.samples**2


class Line:
    """Two ends in one process."""

    def __init__(self):
        self.near, self.far = Shared(numbering=True), Shared(numbering=False)
        self.size = 0

    def there(self, message):
        return self._sent(message, self.near, self.far)

    def back(self, message):
        return self._sent(message, self.far, self.near)

    def _sent(self, message, giver, taker):
        written = packed(message, giver)
        self.size = len(written)
        return unpacked(written, taker)


def test_what_was_met_is_sent_by_its_number():
    line, large = Line(), Large(np.arange(10_000.0))

    first = line.there([large, large])
    whole = line.size
    again = line.there({"the same": large})

    assert np.array_equal(first[0].samples, large.samples)
    assert first[0] is first[1] is again["the same"]
    assert whole > large.samples.nbytes > 100 * line.size


def test_what_came_from_here_comes_back_as_itself():
    line, large = Line(), Large(np.zeros(100))

    assert line.back((line.there(large), "more"))[0] is large


def test_what_was_made_there_comes_whole():
    line = Line()

    made = line.back(Large(np.arange(3.0)))

    assert made.samples.tolist() == [0.0, 1.0, 2.0]


def test_what_is_no_more_is_forgotten():
    line, large = Line(), Large(np.zeros(10))
    there = line.there(large)
    assert line.near.number_of(large) is not None
    assert line.near.dropped() == []

    del large
    collect()
    line.far.forget(line.near.dropped())

    assert line.far.number_of(there) is None
    assert line.near.dropped() == []


def test_what_did_not_arrive_is_sent_again():
    line, large = Line(), Large(np.arange(3.0))

    with pytest.raises((AttributeError, PicklingError), match="lambda"):
        packed([large, lambda: None], line.near)

    assert line.there(large).samples.tolist() == [0.0, 1.0, 2.0]
    line.far.forget(line.near.dropped())


def test_another_object_in_the_same_memory_is_another():
    line = Line()

    rows = [line.there(Large(np.full(3, float(k)))).samples[0] for k in range(100)]

    assert rows == list(range(100))


def test_what_was_derived_is_not_sent():
    large = Large(np.ones(1000))
    assert large.power.sum() == 1000.0

    line = Line()
    there = line.there(large)

    assert "power" not in vars(there)
    assert there.power.sum() == 1000.0


def test_of_every_effect_what_it_was_made_of_is_sent():
    assert all(_fields_of(kind) == tuple(each.name for each in fields(kind)) for kind in EFFECTS.values())


@pytest.mark.parametrize("rig", [REFERENCE, oscillator()], ids=["beam", "oscillator"])
def test_a_hypothesis_against_records_says_the_same_at_the_other_end(rig):
    truth = Hypothesis(rig)
    evaluator = evaluator_of(measured(truth, multisine()))
    here = evaluator.residuals([(truth, None)])[0]

    there, model = Line().there((evaluator, truth))

    assert np.array_equal(there.residuals([(model, None)])[0], here)
