"""A property that is kept, and that two objects compute at the same time."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

from models.computed_once import computed_once

MET = Barrier(2, timeout=5.0)


class Slow:
    """Counts how often it is asked to compute."""

    times = 0

    @computed_once
    def value(self) -> int:
        """What it is."""
        self.times += 1
        MET.wait()
        return self.times


def test_two_objects_are_computed_at_the_same_time_and_each_once():
    one, other = Slow(), Slow()

    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(lambda each: each.value, (one, other))) == [1, 1]

    assert (one.value, other.value, one.times, other.times) == (1, 1, 1, 1)


def test_asked_of_the_class_it_is_itself_with_its_words():
    assert isinstance(Slow.value, computed_once)
    assert Slow.value.__doc__ == "What it is."
