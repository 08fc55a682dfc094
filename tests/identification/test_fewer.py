"""Three effects that two could replace, if one of them sat elsewhere, and three that are needed."""

import pytest
from trial_records import beam_session, found_with

from identification.evidence import Ranked
from identification.fewer import with_fewer
from models.effects import Place
from models.effects.axial_load import AxialLoad
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain

MASS, GAIN = PointMass(Place(position=0.86), mass=0.1), SensorGain(Place(sensor="P4"), gain=0.8)
SPRING = PointStiffness(Place(position=1.2), stiffness=1500.0)
ASTRAY, LOAD = PointStiffness(Place(position=0.4), stiffness=9000.0), AxialLoad(Place(), force=20.0)


def rounds_of(session, *effects):
    fits = [found_with(session, effect, iterations=0) for effect in effects]
    pairs = zip(effects, fits, strict=True)
    return [[Ranked(effect, found, refitted=True, log_evidence=0.0)] for effect, found in pairs]


def test_a_spring_at_its_place_replaces_one_astray_and_what_that_left():
    session = beam_session(MASS, SPRING)
    found = found_with(session, MASS, LOAD, ASTRAY, iterations=0)
    assert found.ratio > 1.3

    fewer = with_fewer(session, found_with(session), found, rounds_of(session, MASS, LOAD, ASTRAY))

    mass, spring = fewer.fit.hypothesis.effects
    assert (mass.kind, spring.kind) == ("point_mass", "point_stiffness")
    assert mass.mass == pytest.approx(0.1, rel=0.05)
    assert spring.place.position == pytest.approx(1.2, abs=0.03)
    assert fewer.fit.ratio == pytest.approx(1.0, abs=0.1)
    assert [rows[0].effect.kind for rows in fewer.rounds] == ["point_mass", "point_stiffness"]
    assert fewer.label == "axial_load and point_stiffness at 0.400 m replaced by point_stiffness at 1.200 m alone"
    assert "explains the records as well" in session.decisions[-1]


def test_three_that_are_needed_stay():
    session = beam_session(MASS, SPRING, GAIN)
    found = found_with(session, MASS, SPRING, GAIN)

    assert with_fewer(session, found_with(session), found, rounds_of(session, MASS, SPRING, GAIN)) is None
    assert session.decisions == []


def test_two_are_not_asked():
    session = beam_session(MASS, GAIN)
    found = found_with(session, MASS, GAIN, iterations=0)

    assert with_fewer(session, found, found, rounds_of(session, MASS, GAIN)) is None
