import numpy as np
import pytest

from identification.decay.course import NORMAL_95, Told, integral_of, quantiles, weigh
from identification.decay.walk import Points

SPAN = (0.0, 100.0)


def points_of(level, std, seed=0, n=200):
    """Means of a level over n blocks of 100 s, with noise; what lies within a block is averaged over 50 pieces."""
    edges = np.linspace(*SPAN, n + 1)
    fine = edges[:-1, None] + (np.arange(50) + 0.5) / 50 * (edges[1] - edges[0])
    noise = std * np.random.default_rng(seed).standard_normal(n)
    return Points(edges, 0.5 * (edges[1:] + edges[:-1]), level(fine).mean(axis=1) + noise, np.full(n, std**2))


def course_of(level, std=1e-3, seed=0, scale=0.01, told=Told()):  # noqa: B008
    return weigh(points_of(level, std, seed), SPAN, scale, np.zeros_like, told).average()


def test_a_steady_rate_is_called_constant_and_known_as_well_as_a_straight_line_can_be():
    course = course_of(lambda t: -0.01 * t)
    slope_std = 1e-3 * np.sqrt(12.0 / 200) / 100.0
    assert course.forms["constant"] > 0.9
    assert course.jumps == ()
    assert course.at(np.array([50.0]))[0] == pytest.approx(-0.01, abs=4.0 * slope_std)
    # other forms keep a few per cent, which widen the interval
    assert np.median(course.std) == pytest.approx(slope_std, rel=0.2)


def test_a_straight_rate_is_called_a_line():
    course = course_of(lambda t: -0.01 * t + 5e-5 * t**2)
    assert course.forms["line"] > 0.8
    assert course.at(np.array([20.0, 80.0])) == pytest.approx([-0.008, -0.002], abs=1e-4)


def test_a_jump_is_found_with_its_time_and_size():
    course = course_of(lambda t: -0.01 * np.minimum(t, 37.3) - 0.002 * np.maximum(t - 37.3, 0.0))
    (jump,) = course.jumps
    assert jump.probability > 0.99
    assert jump.size == pytest.approx(0.008, abs=2e-4)
    assert jump.time == pytest.approx(37.3, abs=4.0 * jump.std)
    assert jump.std < 0.2


def test_a_wave_is_followed():
    course = course_of(lambda t: 0.05 * np.sin(2.0 * np.pi * t / 50.0), std=1e-4)
    rate = 0.05 * 2.0 * np.pi / 50.0 * np.cos(2.0 * np.pi * course.times / 50.0)
    assert course.rate == pytest.approx(rate, abs=0.1 * rate.max())


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Over records the share of time at which a wandering rate lies in its 95 % interval."""
    inside = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        steps = np.concatenate([[0.0], np.cumsum(2e-4 * rng.standard_normal(10000))])
        level = np.concatenate([[0.0], np.cumsum(0.5 * (steps[1:] + steps[:-1]) * 0.01)])
        grid = np.linspace(*SPAN, 10001)
        course = course_of(lambda t, level=level, grid=grid: np.interp(t, grid, level), seed=seed + 1000)
        truth = np.interp(course.times, grid, steps)
        inside.append(np.mean((course.low <= truth) & (truth <= course.high)))
    # 40 records with about ten independent stretches each: 1 % for the mean; forms and sizes are not those of the prior
    assert np.mean(inside) == pytest.approx(0.95, abs=0.035)


def test_a_told_form_is_kept_to():
    course = course_of(lambda t: -0.01 * t, told=Told(("line",), 0))
    assert course.forms["line"] == pytest.approx(1.0)
    assert course.jumps == ()


def test_the_quantiles_of_one_normal_law_are_its_own():
    found = quantiles(np.array([1.0]), np.array([[2.0]]), np.array([[0.5]]), np.array([0.025, 0.5, 0.975]))
    assert found[:, 0] == pytest.approx([2.0 - NORMAL_95 * 0.5, 2.0, 2.0 + NORMAL_95 * 0.5], abs=1e-6)


def test_quantiles_of_a_mixture_divide_its_mass():
    weights, means, stds = np.array([0.3, 0.7]), np.array([[0.0], [4.0]]), np.array([[1.0], [0.2]])
    low, high = quantiles(weights, means, stds, np.array([0.1, 0.9]))[:, 0]
    draws = np.random.default_rng(0)
    which = draws.random(200_000) < 0.3
    sample = np.where(which, draws.standard_normal(200_000), 4.0 + 0.2 * draws.standard_normal(200_000))
    # 200,000 draws know a share to 0.0007
    assert np.mean(sample < low) == pytest.approx(0.1, abs=0.003)
    assert np.mean(sample < high) == pytest.approx(0.9, abs=0.003)


def test_the_integral_of_straight_pieces_is_exact_inside_and_goes_on_outside():
    times, rate = np.array([1.0, 2.0, 4.0]), np.array([0.0, 2.0, 2.0])
    at = np.array([0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0])
    assert integral_of(times, rate, at) == pytest.approx([0.0, 0.0, 0.25, 1.0, 3.0, 5.0, 7.0])
