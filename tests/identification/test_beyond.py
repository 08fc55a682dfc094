"""A kind of the library that stands for a law beyond it is told from one that is right."""

import pytest
from trial_records import REFERENCE, beam_session, found_with

from identification.beyond import is_beyond_library, law_beyond, promised
from identification.hypothesis import Hypothesis
from identification.scene import scenes
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.general_laws import Memory, SpringCurve

THERE = Place(position=0.86)
RELAXING = Memory(THERE, stiffness=3e3, relaxation_time=8e-3)
FRICTION = CoulombFriction(THERE, friction_force=0.4, slip_velocity=5e-3)
HYSTERESIS = BoucWen(THERE, force=1.0, yield_displacement=2e-4, exponent=1.0)
ABSORBER = Absorber(THERE, mass=0.05, frequency=30.0, damping_ratio=0.1)
DASHPOT = PointDamping(THERE, damping=5.0)


def asked(*hidden, named):
    session = beam_session(*hidden)
    return session, law_beyond(session, found_with(session), found_with(session, *named))


STUDY = pytest.mark.study


@pytest.mark.parametrize("named", [HYSTERESIS, pytest.param(ABSORBER, marks=STUDY), pytest.param(DASHPOT, marks=STUDY)])
def test_a_force_that_remembers_is_none_of_the_library(named):
    _, found = asked(RELAXING, named=[named])

    assert found.names.startswith(named.kind)
    assert found.row.effect.kind == "force with a memory"
    assert found.row.effect.relaxation_time == pytest.approx(8e-3, rel=0.05)
    assert found.row.effect.place.position == pytest.approx(0.86, abs=0.01)


@pytest.mark.parametrize("true", [FRICTION, HYSTERESIS, ABSORBER, DASHPOT, PointMass(THERE, mass=0.1)])
def test_what_is_right_explains_what_more_general_laws_would(true):
    _, found = asked(true, named=[true])
    assert found is None


def test_two_effects_that_meet_one_law_together_are_held_against_it():
    session = beam_session(RELAXING)
    pair = found_with(session, HYSTERESIS, PointDamping(Place(position=1.2), damping=1.0))

    assert is_beyond_library(session, found_with(session), pair)

    (told,) = session.decisions
    assert told.startswith("unexplained after all: bouc_wen at 0.8")
    assert "force with a memory at 0.8" in told


def test_two_effects_that_are_there_are_two():
    mass = PointMass(Place(position=1.2), mass=0.1)
    _, found = asked(FRICTION, mass, named=[FRICTION, mass])
    assert found is None


def test_a_linear_step_promises_what_is_there():
    scene = scenes(beam_session().fitting, Hypothesis(REFERENCE), [THERE])[THERE]
    session = beam_session(SpringCurve.with_values(scene, (0.0, 0.1, 1.0, 0.0, 0.0, 0.0)))
    odds = promised(session.fitting, found_with(session, PointMass(THERE, mass=0.01)), THERE)
    assert max(odds, key=odds.__getitem__) == "force over displacement"


def test_where_there_is_no_time_nothing_is_asked():
    session = beam_session(RELAXING)
    session.until = 0.0
    assert law_beyond(session, found_with(session), found_with(session, DASHPOT)) is None
    assert "a look at laws beyond the library was not begun" in session.untried[0]
