"""A damping over time as a table: how many knots it takes, and that it keeps to the interval."""

import numpy as np
import pytest

from identification.decay.damping_table import MOST_KNOTS, damping_effect
from models.effects.protocol import Place
from models.errors import InputError

PLACE = Place(sleeve="sleeve 2", position=1.0)
TIMES, PLACES = np.linspace(0.5, 20.0, 300), np.arange(300)
COURSES = {
    "constant": (80.0 + 0.0 * TIMES, 1),
    "line": (80.0 - 3.0 * TIMES, 2),
    "kink": (80.0 + 5.0 * np.maximum(TIMES - TIMES[116], 0.0), 3),
    "jump": (np.where(PLACES < 134, 80.0, 30.0), 4),
    "jump up and down": (np.where(PLACES < 75, 80.0, np.where(PLACES < 180, 160.0, 100.0)), 6),
}


def effect_of(values, share, noise=0.0, seed=0, **choices):
    noisy = values * (1.0 + noise * np.random.default_rng(seed).standard_normal(len(values)))
    half = 1.96 * share * values
    return damping_effect(PLACE, TIMES, noisy, noisy - half, noisy + half, **choices), noisy, half


@pytest.mark.parametrize("name", COURSES)
def test_an_exact_course_takes_the_fewest_knots(name):
    values, knots = COURSES[name]
    effect, _, _ = effect_of(values, 0.003)
    assert len(effect.times) == knots
    # Fewest knots within the interval, so that it may leave the course by part of its width; here it has no need to.
    np.testing.assert_allclose(np.interp(TIMES, effect.times, effect.values), values, atol=0.006 * values.max())


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", COURSES)
def test_noise_as_large_as_told_adds_no_knots(name, seed):
    values, knots = COURSES[name]
    effect, noisy, half = effect_of(values, 0.01, noise=0.01, seed=seed)
    assert knots <= len(effect.times) <= knots + 1
    table = np.interp(TIMES, effect.times, effect.values)
    assert np.mean(np.abs(table - noisy) > half) < 0.076  # 5 % and two deviations of that share of 300
    error = np.sqrt(np.mean((table - values) ** 2)) / np.mean(values)
    assert error < 0.004  # 1 % of noise over the root of some 30 times a knot, twice


def test_a_wider_interval_asks_for_fewer_knots():
    values = 80.0 + 60.0 * np.exp(-((TIMES - 8.0) ** 2) / 8.0)
    counts = [len(effect_of(values, share)[0].times) for share in (0.002, 0.01, 0.05, 0.5)]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] == 1
    assert counts[0] > counts[1] > counts[2]


def test_never_more_knots_than_allowed():
    values = 80.0 + 40.0 * np.sin(3.0 * TIMES)
    assert len(effect_of(values, 1e-4)[0].times) == MOST_KNOTS
    assert len(effect_of(values, 1e-4, most=7)[0].times) == 7


def test_a_table_damps():
    values = 10.0 * np.exp(-TIMES / 2.0)  # a straight line through it ends below 0
    effect = damping_effect(PLACE, TIMES, values, values - 1.0, values + 1.0, most=2)
    assert effect.values[-1] == 0.0


def test_one_time_is_a_constant():
    effect = damping_effect(PLACE, TIMES[:1], np.array([7.0]), np.array([6.0]), np.array([8.0]))
    assert (effect.times, effect.values, effect.place) == ((0.5,), (pytest.approx(7.0),), PLACE)


def test_sizes_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match=r"of sizes \(300,\), \(3,\), .*; they are \(n,\) each, .*; leave out"):
        damping_effect(PLACE, TIMES, TIMES[:3], TIMES, TIMES)


@pytest.mark.parametrize("change", [lambda t, v: (t[::-1], v), lambda t, v: (t, v * np.nan), lambda t, v: (t, -v)])
def test_times_and_intervals_that_make_no_course_are_refused(change):
    times, half = change(TIMES, np.ones_like(TIMES))
    with pytest.raises(InputError, match=r"times that do not grow, an empty interval .*; an interval has .*; sort"):
        damping_effect(PLACE, times, TIMES, TIMES - half, TIMES + half)
