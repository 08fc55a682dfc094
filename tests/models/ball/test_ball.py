"""The ball: every simulator gives back what the closed form says, and the force it felt took the speed it lost."""

import numpy as np
import pytest

from models.ball import STRIKES, Ball, striker
from models.ball.restitution import exact_dissipation, hardness
from models.contact.dissipating import Dissipating
from models.contact.hertz import Hertz
from models.contact.kelvin_voigt import KelvinVoigt

SPEED, STIFFNESS = 0.5, 1e9
DEPTH, FORCE, LASTS = hardness(1.0, SPEED, STIFFNESS, 1.5)


def ball(law):
    return Ball(1.0, SPEED, law, 1e-3 * DEPTH, LASTS)


@pytest.mark.parametrize("simulator", STRIKES)
@pytest.mark.parametrize("e", [0.2, 0.9])
def test_the_restitution_that_is_set_exactly_is_obtained(simulator, e):
    strike = striker(simulator)(ball(Dissipating(STIFFNESS, exact_dissipation(e) / SPEED)))

    assert strike.restitution == pytest.approx(e, abs=1e-4)
    assert strike.energy_lost == pytest.approx(1.0 - e**2, abs=2e-4)


@pytest.mark.parametrize("simulator", STRIKES)
def test_a_lossless_strike_has_its_force_and_its_time(simulator):
    strike = striker(simulator)(ball(Hertz(STIFFNESS)))

    assert strike.restitution == pytest.approx(1.0, abs=1e-5)
    assert strike.peak_force == pytest.approx(FORCE, rel=1e-4)
    assert strike.contact_time == pytest.approx(LASTS, rel=5e-3)


@pytest.mark.parametrize("simulator", STRIKES)
def test_the_impulse_of_the_stop_is_the_change_of_speed(simulator):
    strike = striker(simulator)(ball(Dissipating(STIFFNESS, 1.0)))

    impulse = np.trapezoid(strike.force, strike.time)
    assert impulse == pytest.approx(SPEED * (1.0 + strike.restitution), rel=1e-3)


def test_a_ball_that_a_heavy_dashpot_holds_hardly_comes_back():
    strike = striker("modal")(ball(KelvinVoigt(1e6, 2e4)))

    assert 0.0 <= strike.restitution < 0.05
