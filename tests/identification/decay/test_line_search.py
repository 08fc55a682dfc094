"""Golden section, evolution and grid against closed-form minima, and what every search owes its caller."""

import math
from collections import Counter

import numpy as np
import pytest

from identification.decay.line_search import evolution_search, golden_search, grid_search
from identification.decay.quantum import QuantumSettings, quantum_search
from models.errors import InputError

LOWER, UPPER = np.array([-5.0]), np.array([5.0])
IN_A_BOX = {
    "golden section": lambda f, lower, upper: golden_search(f, lower, upper, 1e-3),
    "differential evolution": lambda f, lower, upper: evolution_search(f, lower, upper, 0),
    "quantum genetic algorithm": lambda f, lower, upper: quantum_search(f, lower, upper, QuantumSettings(), 0),
}
EVERY = {**IN_A_BOX, "grid": lambda f, lower, upper: grid_search(f, np.linspace(lower, upper, 9))}
by_name = pytest.mark.parametrize("name", EVERY)


def parabola(x):
    return 1.0 + float(np.sum((x - 0.3) ** 2))


def rastrigin(x):
    """Its lowest value is 0 at 0.37, with one more minimum in every interval of 1."""
    return float(np.sum(10.0 + (x - 0.37) ** 2 - 10.0 * np.cos(2.0 * np.pi * (x - 0.37))))


def steps(x):
    """0 on an interval of 1/4 about 0.3, growing by whole numbers beyond."""
    return float(np.sum(np.floor(8.0 * np.abs(x - 0.3))))


def kink(x):
    return abs(x.item())


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-6])
def test_golden_section_finds_a_kink_within_its_tolerance(tolerance):
    found = golden_search(lambda x: abs(x.item() - math.sqrt(2.0)), LOWER, UPPER, tolerance)
    assert found.best.item() == pytest.approx(math.sqrt(2.0), abs=tolerance)
    assert found.reason == f"a minimum lies within {tolerance:g} of the best position"


def test_golden_section_alone_shrinks_the_bracket_by_the_golden_ratio():
    """On a falling line no parabola fits; a bracket of 10 is below 1e-3 after log(1e4) / log(1.618) = 19.1 sections."""
    found = golden_search(lambda x: -x.item(), LOWER, UPPER, 1e-3)
    distance = 5.0 - found.points[:, 0]
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    np.testing.assert_allclose(distance[1:6] / distance[:5], golden, rtol=1e-6)  # the least step of 1e-8 |x|
    assert found.evaluations == 20


def test_golden_section_steps_to_the_minimum_of_a_parabola_at_once():
    found = golden_search(parabola, LOWER, UPPER, 1e-6)
    assert found.best.item() == pytest.approx(0.3, abs=1e-6)
    assert found.evaluations < 10


def test_golden_section_ends_in_some_minimum_where_there_are_several():
    found = golden_search(rastrigin, LOWER, UPPER, 1e-6)
    assert abs(found.best.item() - 0.37) > 0.5
    slope = 2.0 * (found.best.item() - 0.37) + 20.0 * math.pi * math.sin(2.0 * math.pi * (found.best.item() - 0.37))
    assert abs(slope) < 400.0 * 1e-6  # the curvature of 2 + 40 pi^2 times the tolerance


def test_golden_section_says_how_fine_it_got_where_rounding_stopped_it():
    found = golden_search(lambda x: (x.item() - 1.0) ** 2, np.array([0.0]), np.array([3.0]), 1e-12)
    assert found.reason == "a minimum lies within 4.47035e-08 of the best position"  # 3 sqrt(2^-52)


def test_golden_section_gives_up_after_500_evaluations():
    found = golden_search(kink, np.array([-1.0]), np.array([1.5]), 1e-300)
    assert found.reason == "the limit of 500 evaluations was reached"


def test_golden_section_refuses_two_variables_and_no_tolerance():
    with pytest.raises(InputError, match="a box of 2 variables; golden section has one; use evolution_search"):
        golden_search(parabola, np.zeros(2), np.ones(2), 1e-3)
    with pytest.raises(InputError, match="a tolerance of 0; it is above 0; ask for"):
        golden_search(parabola, LOWER, UPPER, 0.0)


@pytest.mark.parametrize("n_var", [1, 2])
@pytest.mark.parametrize("seed", range(3))
def test_evolution_finds_the_lowest_of_many_minima(n_var, seed):
    found = evolution_search(rastrigin, np.full(n_var, -5.0), np.full(n_var, 5.0), seed)
    # All values of the last generation are equal to 1e-4, and 200 d^2 is Rastrigin near its minimum: d < 1e-3.
    np.testing.assert_allclose(found.best, 0.37, atol=1e-3)
    assert found.reason == "the values of a generation spread by less than 0.0001 of their mean"


def test_evolution_brings_steps_to_their_lowest_and_repeats_itself_bit_by_bit():
    first, again, other = (evolution_search(steps, LOWER, UPPER, seed) for seed in (1, 1, 2))
    assert first.value == 0.0
    assert np.diff(np.sort(first.points[:, 0])).min() > 1e-7  # the differences of a polish are 1.5e-8 apart
    np.testing.assert_array_equal(first.points, again.points)
    assert not np.array_equal(first.points[:5], other.points[:5])


def test_evolution_that_cannot_settle_stops_at_a_hundred_generations():
    calls = iter(range(100_000))
    found = evolution_search(lambda _: -(float(next(calls)) ** 3), LOWER, UPPER, 0)
    assert len(found.history) == 100
    assert found.reason == "the limit of 100 generations was reached"


def test_a_grid_of_powers_of_two_takes_the_one_nearest_on_a_log_scale():
    scales = 2.0 ** np.arange(0, 13)
    found = grid_search(lambda a: (math.log2(a.item()) - 6.68) ** 2, scales[:, np.newaxis])
    assert found.best.item() == 2.0**7
    np.testing.assert_array_equal(found.points[:, 0], scales)
    assert found.reason == "all 13 points of the grid were evaluated"
    np.testing.assert_allclose(found.history, [(6.68 - min(k, 7)) ** 2 for k in range(13)], rtol=1e-12)  # rounding


def test_a_grid_takes_the_first_of_equals_and_a_repeated_point_once():
    found = grid_search(kink, np.array([[3], [-2], [2], [-2], [3]]))
    assert (found.best.item(), found.evaluations) == (-2.0, 3)
    assert found.points.dtype == float


@pytest.mark.parametrize("points", [np.zeros(3), np.zeros((0, 1)), np.array([[1.0], [np.nan]])])
def test_a_grid_that_is_none_is_refused(points):
    with pytest.raises(InputError, match=r"points of size \(.*; a grid is \(n, n_var\) finite positions, one or more;"):
        grid_search(parabola, points)


@by_name
def test_every_search_counts_and_keeps_each_evaluation_once(name):
    calls = Counter()

    def counted(x):
        calls[tuple(x)] += 1
        return parabola(x)

    found = EVERY[name](counted, LOWER, UPPER)
    assert found.method == name
    assert set(calls.values()) == {1}
    assert found.evaluations == len(calls)
    np.testing.assert_array_equal(found.points, list(calls))
    np.testing.assert_array_equal(found.values, [parabola(x) for x in found.points])


@by_name
def test_every_search_stays_in_the_box_and_returns_the_lowest_of_what_it_saw(name):
    found = EVERY[name](rastrigin, LOWER, UPPER)
    assert found.points.shape == (found.evaluations, 1)
    assert np.all((found.points >= LOWER) & (found.points <= UPPER))
    assert found.value == found.values.min() == found.history[-1] == rastrigin(found.best)
    assert np.all(np.diff(found.history) <= 0.0)


@by_name
def test_every_search_goes_round_positions_that_cannot_be_used(name):
    found = EVERY[name](lambda x: math.inf if x.item() < 0.0 else parabola(x), LOWER, UPPER)
    assert found.value < 2.0  # the parabola is 1 at its minimum, 1.1 at the edge of what can be used


def test_an_objective_that_writes_into_its_argument_does_not_reach_the_caller():
    points = np.array([[1.0], [2.0]])
    grid_search(lambda x: x.fill(99.0) or 0.0, points)
    assert points.tolist() == [[1.0], [2.0]]


@by_name
def test_an_objective_of_nan_is_refused_with_its_position(name):
    with pytest.raises(InputError, match=r"an objective of nan at \[.*\]; a search compares numbers; return inf where"):
        EVERY[name](lambda _: math.nan, LOWER, UPPER)


def test_a_fault_of_the_objective_that_is_no_bad_input_is_not_hidden():
    def faulty(_):
        raise TypeError

    with pytest.raises(RuntimeError) as caught:
        evolution_search(faulty, LOWER, UPPER, 0)
    assert isinstance(caught.value.__cause__, TypeError)


@pytest.mark.parametrize("name", IN_A_BOX)
@pytest.mark.parametrize(
    ("lower", "upper", "message"),
    [
        ([1.0], [1.0], "variable 0 from 1 to 1; the lower bound is below the upper; exchange them"),
        ([0.0], [math.inf], "variable 0 from 0 to inf; a search needs finite bounds; bound the variable"),
        ([math.nan], [1.0], "variable 0 from nan to 1; a search needs finite bounds"),
        ([], [], r"size \(0,\) and upper bounds of size \(0,\); both are \(n_var,\)"),
        ([0.0], [1.0, 2.0], r"size \(1,\) and upper bounds of size \(2,\); both are"),
    ],
)
def test_a_box_that_is_none_is_refused(name, lower, upper, message):
    with pytest.raises(InputError, match=message):
        IN_A_BOX[name](parabola, np.array(lower), np.array(upper))
