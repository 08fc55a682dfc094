"""A law beyond the library that stands for the simple kinds of a support is told from one that is missing."""

from dataclasses import replace

import pytest
from trial_records import REFERENCE, beam_session, found_with

from identification import of_a_support
from identification.hypothesis import Hypothesis
from identification.of_a_support import _support, is_of_a_support
from identification.reached import FAINT
from identification.scene import scenes
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.general_laws import Memory, SpeedCurve

THERE = Place(position=0.86)
FRICTION, DASHPOT = CoulombFriction(THERE, friction_force=0.4, slip_velocity=5e-3), PointDamping(THERE, damping=5.0)
RELAXING = Memory(THERE, stiffness=3e3, relaxation_time=8e-3)


def leaving(law, ratio):
    """The fit as if it left so many times the noise, all else as it is."""
    return replace(law, chi2=ratio**2 * law.n_data, residual=law.residual * ratio / law.ratio)


@pytest.fixture(scope="module")
def support():
    """A session in which a friction and a dashpot are hidden, the model without them, and a curve in their place."""
    session = beam_session(FRICTION, DASHPOT, rms=4.0)
    scene = scenes(session.fitting, Hypothesis(REFERENCE), [THERE])[THERE]
    law = found_with(session, SpeedCurve.with_values(scene, (0.1, 0.1, 0.1, 0.1, 0.1)))
    return session, found_with(session), law


def test_a_curve_may_stand_for_the_kinds_of_a_support(support):
    session, base, law = support
    assert law.ratio > FAINT
    assert is_of_a_support(session, base, law)


def test_so_it_may_where_it_leaves_nothing_beyond_the_noise(support):
    """Which is less than the share of what simple kinds leave that is asked for of other laws."""
    session, base, law = support
    assert is_of_a_support(session, base, leaving(law, 1.0))


def test_so_it_may_where_the_error_is_not_that_of_the_noise(support):
    """A loud line that is missed weighs little among all: then no law is asked for its odds."""
    session, base, law = support
    loud = replace(leaving(law, 1.0), residual=2.0 * law.residual)
    assert is_of_a_support(session, base, loud)


@pytest.fixture(scope="module")
def relaxing():
    """A session in which a spring that relaxes is hidden, the model without it, that law, and what a support leaves."""
    session = beam_session(RELAXING)
    base, law = found_with(session), found_with(session, RELAXING)
    return session, base, law, _support(session, base, law, 0).ratio


def test_a_law_that_leaves_nothing_but_the_noise_is_held_against_a_support_by_the_odds(relaxing):
    session, base, law, left = relaxing
    ratio = 1.0 + 0.2 * (left - 1.0)  # twice the share of what simple kinds leave that is asked for of other laws
    assert ratio < FAINT < left

    assert not is_of_a_support(session, base, leaving(law, ratio))


def test_a_law_that_leaves_room_for_a_second_effect_may_stand_for_a_support(relaxing):
    session, base, law, left = relaxing
    assert left > FAINT + 0.01
    assert is_of_a_support(session, base, leaving(law, FAINT + 0.01))


def test_where_the_support_reaches_the_noise_too_the_law_may_stand_for_it():
    weak = replace(RELAXING, stiffness=1e3)
    session = beam_session(weak)
    base, law = found_with(session), found_with(session, weak)
    assert _support(session, base, law, 0).ratio < FAINT

    assert is_of_a_support(session, base, law)


@pytest.mark.parametrize(("second", "stands"), [(1.0, True), (100.0, False)])
def test_where_the_first_way_to_a_support_is_left_far_behind_a_second_one_is_asked(
    relaxing, monkeypatch, second, stands
):
    session, base, law, _ = relaxing
    ways = [leaving(base, 100.0), leaving(base, second)]
    monkeypatch.setattr(of_a_support, "_support", lambda *asked: ways[asked[-1]])

    assert is_of_a_support(session, base, leaving(law, 2.0)) is stands
