"""The quantum genetic algorithm against closed-form minima, its gates against their algebra, its rule for stopping."""

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from identification.decay.quantum import (
    MARGIN,
    QuantumSettings,
    cross,
    decode,
    even_qubits,
    iterations_without_gain,
    mutate,
    observe,
    quantum_search,
    rotate,
)
from models.errors import InputError

SETTINGS = QuantumSettings()
SEEDS = range(10)
ROUNDING = 1e-12  # of some hundred products of numbers near 1
# A parabola of lowest value 1 gains less than the settings' 1e-4 once it is nearer than sqrt(1e-4) to its minimum.
NO_GAIN = 0.01


def parabola(x):
    return 1.0 + float(np.sum((x - 0.3) ** 2))


def rastrigin(x):
    """Its lowest value is 0 at 0.37, with one more minimum in every interval of 1."""
    return float(np.sum(10.0 + (x - 0.37) ** 2 - 10.0 * np.cos(2.0 * np.pi * (x - 0.37))))


def steps(x):
    """0 on an interval of 1/4 about 0.3, growing by whole numbers beyond."""
    return float(np.sum(np.floor(8.0 * np.abs(x - 0.3))))


def look(objective, seed, n_var=1, **settings):
    return quantum_search(objective, np.full(n_var, -5.0), np.full(n_var, 5.0), replace(SETTINGS, **settings), seed)


def random_qubits(seed, population=7, length=12):
    angle = np.random.default_rng(seed).uniform(MARGIN, 0.5 * np.pi - MARGIN, (population, length))
    return np.stack((np.cos(angle), np.sin(angle)))


def norm(qubits):
    return qubits[0] ** 2 + qubits[1] ** 2


@pytest.mark.parametrize(("n_var", "population"), [(1, 10), (2, 40)])
def test_a_parabola_is_found_as_far_as_a_gain_counts(n_var, population):
    found = [look(parabola, seed, n_var, population=population) for seed in SEEDS]
    np.testing.assert_allclose([f.best for f in found], 0.3, atol=NO_GAIN)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_multimodal_minimum_of_one_variable_is_found_to_the_resolution(seed):
    found = look(rastrigin, seed, population=40)
    assert found.best == pytest.approx(0.37, abs=10.0 / (2**12 - 1))


def test_a_multimodal_minimum_of_two_variables_is_found_by_most_seeds():
    """121 minima; a seed that misses the lowest ends in one beside it, whose value is 1 higher for each variable."""
    found = [look(rastrigin, seed, 2, population=40) for seed in SEEDS]
    right = [np.abs(f.best - 0.37).max() < 0.5 for f in found]
    assert sum(right) >= 6
    assert all(f.value < 2.1 for f in found)


@pytest.mark.parametrize("n_var", [1, 2])
def test_a_stepwise_constant_objective_is_brought_to_its_lowest_step(n_var):
    found = [look(steps, seed, n_var, population=20) for seed in SEEDS]
    assert [f.value for f in found] == [0.0] * len(found)


def test_the_same_seed_gives_the_same_bits():
    first, again = look(rastrigin, 3, 2), look(rastrigin, 3, 2)
    np.testing.assert_array_equal(first.points, again.points)
    np.testing.assert_array_equal(first.history, again.history)


def test_different_seeds_take_different_ways_to_the_same_place():
    found = [look(parabola, seed) for seed in SEEDS]
    assert len({f.points[:5].tobytes() for f in found}) == len(SEEDS)
    assert np.ptp([f.best for f in found]) < 2.0 * NO_GAIN


@pytest.mark.parametrize("bits", [2, 5, 10])
def test_the_minimum_between_two_positions_is_missed_by_no_more_than_the_resolution_allows(bits):
    found = look(parabola, 0, bits=bits, population=40, tolerance=0.0, mutation_rate=0.2)
    spacing = 10.0 / (2**bits - 1)
    assert abs(found.best.item() - 0.3) <= 0.5 * spacing * (1.0 + ROUNDING)


def test_the_history_falls_and_ends_at_the_lowest_of_all_values():
    found = look(rastrigin, 0, 2)
    assert np.all(np.diff(found.history) <= 0.0)
    assert found.value == found.history[-1] == found.values.min() == rastrigin(found.best)


def test_each_position_is_evaluated_once_and_remembered():
    calls = Counter()

    def counted(x):
        calls[x.item()] += 1
        return parabola(x)

    found = look(counted, 0, bits=3, population=20)
    assert set(calls.values()) == {1}
    assert found.evaluations == len(calls) == len(found.points) == 8  # 2^3, though 20 strings were observed each time
    assert list(calls) == found.points[:, 0].tolist()


def test_an_objective_without_gain_stops_after_the_catastrophe_and_the_memory():
    found = look(lambda _: 7.0, 0, catastrophe_after=4, memory=6)
    assert len(found.history) == 1 + 4 + 6
    assert found.reason == "no gain above 0.0001 of the best value in 6 iterations after a catastrophe"


@pytest.mark.parametrize("value", [0.0, -3.0, math.inf])
def test_a_best_value_of_zero_below_it_or_infinite_stops_too(value):
    assert len(look(lambda _: value, 0).history) == 1 + 10 + 10


@pytest.mark.parametrize("seed", SEEDS)
def test_a_search_that_stops_by_itself_obeys_the_rule_of_ten_iterations(seed):
    found = look(parabola, seed)
    assert "catastrophe" in found.reason
    assert found.history[-11] - found.history[-1] < 1e-4 * abs(found.history[-1])


def test_an_objective_that_always_falls_ends_at_the_hundredth_iteration():
    calls = iter(range(10_000))
    found = look(lambda _: -float(next(calls)), 0, bits=40)
    assert len(found.history) == 100
    assert found.reason == "the limit of 100 iterations was reached"


def test_nothing_turns_towards_a_string_that_is_no_better():
    """So strings stay random where nothing changes: 1000 of 2^20 hold 1000^2 / 2^21 = 0.5 repetitions."""
    found = look(lambda _: 7.0, 0, bits=20, catastrophe_after=100)
    assert found.evaluations >= 997


def test_a_catastrophe_scatters_a_population_that_had_settled():
    """The same seed repeats the same search, so longer limits show which new positions each iteration adds."""
    settings = {"population": 50, "mutation_rate": 0.0, "bits": 20, "catastrophe_after": 30}
    struck = len(look(parabola, 0, **settings).history) - SETTINGS.memory
    before, at, after = (look(parabola, 0, max_iterations=struck + k, **settings).points for k in (-1, 0, 1))
    np.testing.assert_array_equal(after[: len(at)], at)
    assert len(at) - len(before) < 10  # a settled population mostly observes what it knows,
    scattered = after[len(at) :]
    assert len(scattered) == 50  # a scattered one hardly ever repeats one of a million positions
    # Uniform over the box: 10 / sqrt(12) = 2.89, whose estimate from 50 has a standard error of 6 %.
    assert scattered.std() == pytest.approx(10.0 / math.sqrt(12.0), rel=0.2)


@pytest.mark.parametrize(
    ("history", "quiet"),
    [
        ([5.0], 0),
        ([5.0, 5.0, 5.0], 2),
        ([5.0, 4.0, 4.0], 1),
        ([100.0, 99.6, 99.2, 98.8], 0),  # falls of 0.4 % each: 0.4, 0.8, and 1.2 % is a gain
        ([100.0, 99.6, 99.2], 2),
        ([1.0, 0.0, 0.0, -1e-9], 0),
        ([math.inf, math.inf], 1),
        ([math.inf, 1.0, 1.0], 1),
    ],
)
def test_iterations_without_a_gain_of_one_per_cent(history, quiet):
    assert iterations_without_gain(history, 0.01) == quiet


def test_every_operator_keeps_the_norm_of_every_qubit():
    rng = np.random.default_rng(0)
    qubits = even_qubits(8, 24)
    for _ in range(200):
        string = rng.random(24) < 0.5
        qubits = rotate(qubits, string, rng.uniform(0.0, 1.0, (8, 24)))
        np.testing.assert_allclose(norm(qubits), 1.0, rtol=ROUNDING)
        qubits = cross(qubits, 0.7, rng)
        np.testing.assert_allclose(norm(qubits), 1.0, rtol=ROUNDING)
        qubits = mutate(qubits, 0.1, rng)
        np.testing.assert_allclose(norm(qubits), 1.0, rtol=ROUNDING)
        assert qubits.min() > math.sin(MARGIN) * (1.0 - ROUNDING)


@pytest.mark.parametrize(("bit", "sign"), [(True, 1.0), (False, -1.0)])
def test_an_even_qubit_turned_by_an_angle_has_the_closed_form_probability(bit, sign):
    """sin^2(pi/4 + d) = (1 + sin 2d) / 2."""
    turned = rotate(even_qubits(1, 1), np.array([bit]), np.full((1, 1), 0.2))
    assert turned[1].item() ** 2 == pytest.approx(0.5 * (1.0 + sign * math.sin(0.4)), rel=ROUNDING)


def test_a_qubit_turns_no_further_than_its_margin_and_not_at_all_by_no_angle():
    qubits = random_qubits(1, 1, 2)
    turned = rotate(qubits, np.array([True, False]), np.full((1, 2), 3.0))
    np.testing.assert_allclose(turned[1, 0], [math.cos(MARGIN), math.sin(MARGIN)], rtol=ROUNDING)
    np.testing.assert_allclose(rotate(qubits, np.array([True, False]), np.zeros((1, 2))), qubits, rtol=ROUNDING)


def test_a_bit_is_observed_as_often_as_the_square_of_its_amplitude():
    qubits = np.repeat(random_qubits(2, 1, 5), 40_000, axis=1)
    often = observe(qubits, np.random.default_rng(0)).mean(axis=0)
    np.testing.assert_allclose(often, qubits[1, 0] ** 2, atol=0.01)  # four standard errors of 40 000 draws


def test_crossing_exchanges_tails_and_loses_no_qubit():
    qubits = random_qubits(3)
    crossed = cross(qubits, 1.0, np.random.default_rng(0))
    np.testing.assert_array_equal(np.sort(crossed, axis=1), np.sort(qubits, axis=1))
    np.testing.assert_array_equal(crossed[:, :, 0], qubits[:, :, 0])  # a head stays
    moved = (crossed != qubits).any(axis=0)
    assert moved[:, -1].sum() == 6  # three pairs of seven chromosomes
    assert np.all(np.diff(moved.astype(int), axis=1) >= 0)


def test_a_mutation_exchanges_the_amplitudes():
    qubits = random_qubits(4)
    np.testing.assert_array_equal(mutate(qubits, 1.0, np.random.default_rng(0)), qubits[::-1])


@pytest.mark.parametrize("operator", [cross, mutate])
def test_a_rate_of_zero_changes_nothing(operator):
    qubits = random_qubits(5)
    np.testing.assert_array_equal(operator(qubits, 0.0, np.random.default_rng(0)), qubits)


def test_all_strings_together_are_the_evenly_spaced_positions_and_neighbours_differ_by_one_bit():
    strings = (np.arange(32)[:, np.newaxis] >> np.arange(5)) % 2 == 1
    positions = decode(strings, np.array([-1.0]), np.array([3.0]))[:, 0]
    order = np.argsort(positions)
    np.testing.assert_allclose(positions[order], np.linspace(-1.0, 3.0, 32), atol=ROUNDING)
    assert np.all(np.count_nonzero(np.diff(strings[order], axis=0), axis=1) == 1)


def test_each_variable_has_its_own_bits_and_reaches_its_bounds():
    string = np.array([[False, False, False, True, False, False]])  # Gray 000 is 0 and 100 is 7
    np.testing.assert_array_equal(decode(string, np.array([2.0, 0.1]), np.array([3.0, 0.7])), [[2.0, 0.7]])


@pytest.mark.parametrize(
    ("name", "value", "rule"),
    [
        ("population", 1, "2 or more"),
        ("bits", 53, "from 2 to 52"),
        ("rotation_angle", 0.0, r"from 1e-06 to 1\.5708"),
        ("crossover_rate", 1.1, "from 0 to 1"),
        ("mutation_rate", -0.1, "from 0 to 1"),
        ("catastrophe_after", 0, "1 or more"),
        ("max_iterations", 0, "1 or more"),
        ("tolerance", math.nan, "from 0 to 1"),
        ("memory", 0, "1 or more"),
    ],
)
def test_a_setting_out_of_range_is_refused(name, value, rule):
    with pytest.raises(InputError, match=rf"QuantumSettings\.{name} = {value:g}; it is {rule}; change it"):
        QuantumSettings(**{name: value})
