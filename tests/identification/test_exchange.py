"""An effect that was found while another was missing is judged again beside it."""

import numpy as np
import pytest
from trial_records import beam_session, found_with

from identification.evidence import Ranked
from identification.exchange import exchanged
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.local_damage import LocalDamage
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

MASS, GAIN = PointMass(Place(position=0.86), mass=0.1), SensorGain(Place(sensor="P4"), gain=0.8)
STIFF = Absorber(Place(position=0.86), mass=0.1, frequency=2000.0, damping_ratio=0.1)
DAMAGE = LocalDamage(Place(position=0.5), loss=0.1, width=0.06)


@pytest.fixture(scope="module")
def session():
    return beam_session(MASS, GAIN)


def round_of(session, *effects, beaten=()):
    """A round before the others were there, with wrong odds."""
    rows = [Ranked(e, found_with(session, e), refitted=True, log_evidence=-100.0 * i) for i, e in enumerate(effects)]
    return [*rows, *(Ranked(e, rows[0].fit, refitted=False, log_evidence=-500.0) for e in beaten)]


def after(session, first):
    calibrated = found_with(session)
    others = [e for e in (STIFF, MASS) if e is not first]
    rounds = [round_of(session, first, *others, beaten=(DAMAGE,)), round_of(session, GAIN)]
    session.decisions.clear()
    return exchanged(session, calibrated, found_with(session, first, GAIN), rounds, [0])


def test_what_only_imitated_a_law_with_fewer_numbers_is_exchanged_for_it(session):
    ended = after(session, STIFF)

    mass, gain = ended.fit.hypothesis.effects
    assert (mass.kind, gain.kind) == ("point_mass", "sensor_gain")
    assert mass.mass == pytest.approx(0.1, rel=0.02)
    assert gain.gain == pytest.approx(0.8, rel=0.01)
    assert ended.newest == 0
    assert ended.labels == ("absorber at 0.860 m exchanged for point_mass at 0.860 m",)
    assert "judged" not in session.decisions[0]
    assert "beside sensor_gain on P4" in session.decisions[0]


def test_what_is_right_stays_and_its_rivals_are_weighed_beside_the_other(session):
    ended = after(session, MASS)

    assert ended.newest is None
    assert ended.labels == ()
    assert session.decisions == []
    first, *rest = ended.rounds[0]
    assert first.effect.kind == "point_mass"
    assert [e.kind for e in first.fit.hypothesis.effects] == ["sensor_gain", "point_mass"]
    assert {row.effect.kind for row in rest} >= {"local_damage"}
    assert np.all(np.diff([row.log_evidence for row in ended.rounds[0]]) <= 0)


def test_a_single_effect_is_left_alone(session):
    found = found_with(session, MASS)
    rounds = [round_of(session, MASS)]

    ended = exchanged(session, found_with(session), found, rounds, [])

    assert ended.fit is found
    assert ended.rounds is rounds
