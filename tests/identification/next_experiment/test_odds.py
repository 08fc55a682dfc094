"""The probability that is expected after a test: against drawn records, and at its limits."""

import numpy as np
import pytest

from identification.next_experiment.odds import expected_probability, present_probability


def two(separation):
    scatter = np.zeros((2, 2, 2))
    scatter[0, 1, 1] = scatter[1, 0, 0] = separation**2
    return scatter


def drawn(chances, predictions, n=200_000):
    """The mean probability of the right one over records of white noise about its prediction, Bayes' rule each time."""
    rng, shares = np.random.default_rng(1), chances / chances.sum()
    total = 0.0
    for a, share in enumerate(shares):
        seen = predictions[a] + rng.standard_normal((n, predictions.shape[1]))
        log_like = np.log(shares) - 0.5 * np.sum((seen[:, None, :] - predictions) ** 2, axis=2)
        total += share * np.mean(np.exp(log_like[:, a] - np.logaddexp.reduce(log_like, axis=1)))
    return total


@pytest.mark.parametrize("separation", [0.3, 1.0, 3.0, 6.0])
@pytest.mark.parametrize("chance", [0.5, 0.9])
def test_two_rivals_agree_with_bayes_rule_on_drawn_records(separation, chance):
    chances = np.array([chance, 1.0 - chance])
    predictions = np.array([[0.0, 0.0], [0.6, 0.8]]) * separation
    # 200 000 draws scatter by 0.001.
    assert expected_probability(chances, two(separation)) == pytest.approx(drawn(chances, predictions), abs=0.003)


def test_three_rivals_agree_with_bayes_rule_on_drawn_records():
    predictions = np.array([[0.0, 0.0], [2.0, 0.0], [1.5, 1.5]])
    chances = np.array([0.5, 0.3, 0.2])
    gap = predictions - predictions[:, None]
    scatter = np.einsum("abi,aci->abc", gap, gap)
    # 4096 draws each scatter by 0.005.
    assert expected_probability(chances, scatter) == pytest.approx(drawn(chances, predictions), abs=0.015)


def test_a_test_that_shows_nothing_leaves_what_was_known_and_one_that_shows_all_settles_it():
    chances = np.array([0.7, 0.2, 0.1])
    nothing, everything = np.zeros((3, 3, 3)), np.zeros((3, 3, 3))
    for a in range(3):
        for b in range(3):
            everything[a, b, b] = 400.0 * (a != b)
    assert expected_probability(chances, nothing) == pytest.approx(present_probability(chances))
    assert present_probability(chances) == pytest.approx(0.49 + 0.04 + 0.01)
    assert expected_probability(chances, everything) == pytest.approx(1.0)


def test_more_separation_is_never_less_sure():
    found = [expected_probability(np.array([0.6, 0.4]), two(d)) for d in np.linspace(0.0, 12.0, 60)]
    assert np.all(np.diff(found) > -1e-6)
