"""Restitution: closed forms against the motion itself, the published rules against the literature's own tables."""

from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.ball.restitution import (
    RULES,
    damping_ratio,
    exact_dissipation,
    hardness,
    obtained,
    restitution_of,
)


def released(law, speed, *, mass=1.0, depth=1.0):
    """Speed, over that of the strike, with which a mass leaves a stop of this law; integrated."""

    def motion(t, y):
        return y[1], -max(0.0, law(y[0], y[1])) / mass

    def free(t, y):
        return y[0] if t > 0.0 else 1.0

    free.terminal, free.direction = True, -1.0
    found = solve_ivp(motion, (0.0, 100.0), (1e-9 * depth, speed), events=free, rtol=1e-10, atol=1e-14)
    return -found.y[1, -1] / speed


@pytest.mark.parametrize("exponent", [1.0, 1.5])
@pytest.mark.parametrize("d", [0.05, 0.7, 4.0])
def test_the_closed_form_is_what_the_motion_does_whatever_the_exponent(d, exponent):
    speed = 2.0

    def law(p, rate):
        return max(p, 0.0) ** exponent * (1.0 + d / speed * rate)

    assert released(law, speed) == pytest.approx(obtained(d), abs=2e-5)


@pytest.mark.parametrize("e", [0.02, 0.1, 0.5, 0.95, 1.0 - 1e-5, 1.0])
def test_dissipation_and_restitution_are_inverse(e):
    assert obtained(exact_dissipation(e)) == pytest.approx(e, abs=1e-9)


def test_a_slight_loss_is_two_thirds_of_the_dissipation():
    # Hunt and Crossley (1975): e = 1 - alpha v with d = 3/2 alpha v.
    assert 1.0 - obtained(1e-3) == pytest.approx(1e-3 / 1.5, rel=2e-3)
    assert obtained(0.0) == 1.0


@pytest.mark.parametrize(("rule", "e"), [("hunt_crossley", 0.1), ("lee_wang", 0.1), ("lankarani_nikravesh", 0.1)])
def test_rules_for_slight_losses_give_back_half_and_more_of_the_speed_where_a_tenth_is_wanted(rule, e):
    assert obtained(RULES[rule].dissipation(e)) > 0.5


@pytest.mark.parametrize("rule", ["gonthier", "flores", "exact"])
def test_rules_for_all_losses_stay_close(rule):
    for e in np.linspace(0.1, 0.95, 18):
        assert obtained(RULES[rule].dissipation(e)) == pytest.approx(e, abs=0.05)


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_is_right_where_little_is_lost(rule):
    assert 1.0 - obtained(RULES[rule].dissipation(0.999)) == pytest.approx(0.001, rel=0.55)


@pytest.mark.parametrize("zeta", [0.05, 0.6, 1.0, 2.0])
def test_a_dashpot_that_never_pulls_gives_back_what_schwager_and_poeschel_say(zeta):
    def law(p, rate):
        return p + 2.0 * zeta * rate if p > 0.0 else 0.0

    # The force ends before the mass is back: it parts with the speed it has there, which its energy no longer changes.
    def parted(t, y):
        return law(y[0], y[1]) if t > 0.0 else 1.0

    parted.terminal, parted.direction = True, -1.0
    found = solve_ivp(lambda t, y: (y[1], -law(*y)), (0.0, 50.0), (1e-12, 1.0), events=parted, rtol=1e-11, atol=1e-14)

    assert -found.y[1, -1] == pytest.approx(restitution_of(zeta), rel=1e-4)
    assert damping_ratio(restitution_of(zeta)) == pytest.approx(zeta, rel=1e-9)


def test_a_light_dashpot_loses_what_half_a_period_does():
    assert restitution_of(1e-3) == pytest.approx(exp(-pi * 1e-3), rel=1e-5)
    assert damping_ratio(1.0) == 0.0


def test_a_lossless_strike_on_a_spring_is_half_a_period():
    depth, force, lasts = hardness(2.0, 0.3, 5e4, 1.0)

    assert depth == pytest.approx(0.3 * sqrt(2.0 / 5e4))
    assert force == pytest.approx(5e4 * depth)
    assert lasts == pytest.approx(pi * sqrt(2.0 / 5e4))


def test_a_lossless_strike_of_hertz_lasts_as_johnson_says():
    # Contact Mechanics (1985), eq. (11.24): 2.94 depths over the speed.
    depth, _, lasts = hardness(1.0, 0.5, 1e9, 1.5)

    assert lasts == pytest.approx(2.9432 * depth / 0.5, rel=1e-4)
