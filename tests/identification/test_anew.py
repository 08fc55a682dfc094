"""An effect that imitated two is found to be another, at another place, beside the one that made up for it."""

import pytest
from trial_records import beam_session, found_with

from identification.anew import NEAR_THE_TRUTH, looked_for_anew
from identification.evidence import Ranked
from identification.exchange import MOST_TRIALS, Exchange
from identification.reached import NOISE_REACHED
from models.effects import EFFECTS, Place
from models.effects.absorber import Absorber
from models.effects.axial_load import AxialLoad
from models.effects.local_damage import LocalDamage
from models.effects.point_damping import PointDamping
from models.effects.sensor_gain import SensorGain

DAMAGE, GAIN = LocalDamage(Place(position=0.64), loss=0.04, width=0.1), SensorGain(Place(sensor="P4"), gain=0.9)
LOAD = AxialLoad(Place(), force=-5.0)


@pytest.fixture(scope="module")
def session():
    session = beam_session(DAMAGE, GAIN)
    names = ("local_damage", "point_mass", "axial_load", "sensor_gain", "point_damping")
    session.registry = {kind: EFFECTS[kind] for kind in names}
    return session


def stood(session, *effects):
    """The model with these effects, each alone in its round."""
    found = found_with(session, *effects)
    return Exchange(found, [[Ranked(effect, found, refitted=True, log_evidence=0.0)] for effect in effects])


def test_what_imitated_the_rest_is_exchanged_for_what_is_there(session):
    now = stood(session, LOAD, GAIN)
    assert NOISE_REACHED < now.fit.ratio < NEAR_THE_TRUTH

    ended = looked_for_anew(session, found_with(session), now)

    damage, gain = ended.fit.hypothesis.effects
    assert (damage.kind, gain.kind) == ("local_damage", "sensor_gain")
    assert damage.place.position == pytest.approx(0.64, abs=0.03)
    assert ended.fit.ratio < NOISE_REACHED
    assert ended.newest == 0
    assert ended.rounds[0][0].effect.kind == "local_damage"
    assert "axial_load exchanged for local_damage" in ended.labels[0]
    assert "looked for anew beside sensor_gain on P4" in session.decisions[-1]


def test_what_stood_beside_an_imitation_is_judged_again():
    dashpot = PointDamping(Place(position=1.1), damping=2.0)
    swinging = Absorber(Place(position=1.1), mass=0.35, frequency=1.15, damping_ratio=0.4)
    session = beam_session(DAMAGE, dashpot)
    session.registry = {kind: EFFECTS[kind] for kind in ("local_damage", "axial_load", "point_damping", "absorber")}
    now = stood(session, LOAD, swinging)
    assert now.fit.ratio < NEAR_THE_TRUTH

    ended = looked_for_anew(session, found_with(session), now)

    assert [effect.kind for effect in ended.fit.hypothesis.effects] == ["local_damage", "point_damping"]
    assert len(ended.labels) == 2
    assert ended.newest == 1


def test_what_reaches_the_noise_is_not_asked(session):
    now = stood(session, DAMAGE, GAIN)

    assert looked_for_anew(session, found_with(session), now) is now


def test_a_single_effect_is_not_asked(session):
    now = stood(session, LOAD)

    assert looked_for_anew(session, found_with(session), now) is now


def test_where_nothing_explains_more_all_stays_as_it_was(session):
    session.registry = {"axial_load": EFFECTS["axial_load"], "sensor_gain": EFFECTS["sensor_gain"]}
    now = stood(session, LOAD, GAIN)
    said = []
    session.progress = said.append

    assert looked_for_anew(session, found_with(session), now) is now
    assert 0 < sum("anew" in words for words in said) <= MOST_TRIALS
