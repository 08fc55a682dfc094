"""A fit that has slid into the wrong valley along the beam is tried in the others."""

import pytest
from trial_records import beam_session, found_with

from identification.elsewhere import elsewhere
from models.effects import EFFECTS, Place
from models.effects.local_damage import LocalDamage
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

GAIN = SensorGain(Place(sensor="P4"), gain=0.8)
DAMAGE = LocalDamage(Place(position=0.5), loss=0.3, width=0.06)
ASTRAY = LocalDamage(Place(position=1.5), loss=0.3, width=0.06)


@pytest.fixture(scope="module")
def session():
    return beam_session(GAIN, DAMAGE)


def test_damage_in_a_wrong_valley_is_found_in_the_right_one(session):
    base, stuck = found_with(session, GAIN), found_with(session, GAIN, ASTRAY)
    assert stuck.ratio > 1.3
    assert abs(stuck.hypothesis.effects[-1].place.position - 0.5) > 0.1

    best = min(elsewhere(session.fitting, base, stuck, EFFECTS), key=lambda each: each.cost)

    gain, damage = best.hypothesis.effects
    assert gain.gain == pytest.approx(0.8, rel=0.02)
    assert damage.place.position == pytest.approx(0.5, abs=0.02)
    assert best.ratio == pytest.approx(1.0, abs=0.1)


def test_what_is_in_the_right_valley_is_better_nowhere_else(session):
    right = found_with(session, GAIN, DAMAGE)

    others = elsewhere(session.fitting, found_with(session, GAIN), right, EFFECTS)

    assert all(other.cost > right.cost for other in others)


def test_what_has_no_free_place_is_left_alone(session):
    mass = found_with(session, PointMass(Place(position=0.86), mass=0.1), GAIN)

    assert elsewhere(session.fitting, mass, mass, EFFECTS) == []
