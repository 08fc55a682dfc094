"""The search for the scale: its objective, and what every search finds in it."""

import numpy as np
import pytest

from identification.decay.local_fit import operations
from identification.decay.ridge import follow_mode
from identification.decay.scale_search import AS_GOOD, Training, search_scale, try_scale
from identification.decay.verification import MASS, OMEGA, SAMPLING_RATE, noisy, verification_decay
from identification.decay.windows import window_named
from models.errors import InputError

FREQ = OMEGA / (2.0 * np.pi)


def training(case="step", snr_db=60.0, seed=0):
    known = verification_decay(case)
    return Training(noisy(known.signal, snr_db, seed), known.damping, SAMPLING_RATE, FREQ, MASS)


@pytest.fixture(scope="module")
def found():
    return search_scale(training(), 0)


def test_a_trial_is_the_rms_error_of_c_and_the_operations_counted():
    trial = try_scale(training(), 100.0, "operations", past_jumps=False)
    skeleton = follow_mode(training().signal, SAMPLING_RATE, FREQ, 100.0)
    c = 2.0 * MASS * skeleton.damping_ratio * 2.0 * np.pi * skeleton.frequency
    assert trial.error == pytest.approx(np.sqrt(np.mean((c - training().damping) ** 2)), rel=1e-12)
    assert trial.cost == operations(25600, len(window_named("gaussian").taps(100.0)))


def test_the_objective_is_the_sum_of_two_indices_from_0_to_1_over_the_grid(found):
    grid = found.searches["grid"]
    trials = np.array([try_scale(training(), 2.0 ** p.item(), "operations", past_jumps=False) for p in grid.points])
    indices = (trials - trials.min(axis=0)) / np.ptp(trials, axis=0)
    np.testing.assert_allclose(grid.values, indices.sum(axis=1), rtol=1e-9)
    np.testing.assert_allclose(grid.points[:, 0], np.arange(6.0, 9.1, 0.2), rtol=1e-12)


def test_the_optimum_is_the_articles(found):
    """2^6.68 samples there, 2^6.70 here; the objective is flat to 2e-5 within the tolerances."""
    for name, tolerance in (("evolution", 0.01), ("quantum", 0.01), ("golden", 0.02)):
        assert found.searches[name].best[0] == pytest.approx(6.70, abs=tolerance)
        assert found.trials[name].error < 0.0019
        assert found.centre_frequency(name) == pytest.approx(5.14, abs=0.05)
    assert found.scale("quantum") == pytest.approx(2.0**6.7, rel=0.01)


def test_the_winners_are_the_lowest_and_the_quickest_of_the_good(found):
    values = {name: search.value for name, search in found.searches.items()}
    assert values[found.lowest] == min(values.values())
    assert values[found.quickest] <= min(values.values()) + AS_GOOD
    assert found.quickest == "golden"
    assert values["grid"] > values["golden"] + AS_GOOD


def test_a_seed_gives_the_same_answer_again(found):
    again = search_scale(training(), 0)
    for name, search in found.searches.items():
        np.testing.assert_array_equal(again.searches[name].points, search.points)
        np.testing.assert_array_equal(again.searches[name].values, search.values)


def test_past_jumps_the_best_scale_is_longer_and_the_error_less(found):
    past = search_scale(training(), 0, past_jumps=True)
    assert past.scale("golden") > 1.3 * found.scale("golden")
    assert past.trials["golden"].error < 0.0013


def test_seconds_are_charged_on_request():
    timed = search_scale(training(), 0, "seconds", (6.4, 7.0))
    assert timed.cost == "seconds"
    assert all(0.0 < trial.cost < 1.0 for trial in timed.trials.values())


def test_bad_input_is_refused():
    with pytest.raises(InputError, match=r"cost = 'money'; an identification costs operations or seconds; choose"):
        search_scale(training(), 0, "money")
    with pytest.raises(InputError, match=r"scales from 2\^7 to 2\^7.1; the upper bound is 2\^0.2 times .*; widen"):
        search_scale(training(), 0, bounds=(7.0, 7.1))
