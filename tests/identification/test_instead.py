"""A law that is not established gives its place to another of its round that explains the records as well."""

from dataclasses import replace
from math import log

import pytest
from trial_records import beam_session, found_with

from identification.evidence import SIMPLER, Ranked
from identification.instead import instead_of
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain

MASS, GAIN = PointMass(Place(position=0.86), mass=0.1), SensorGain(Place(sensor="P4"), gain=0.8)
STIFF = Absorber(Place(position=0.86), mass=0.1, frequency=2000.0, damping_ratio=0.1)
SPRING = PointStiffness(Place(position=0.86), stiffness=1e3)


@pytest.fixture(scope="module")
def session():
    return beam_session(MASS, GAIN)


@pytest.fixture(scope="module")
def calibrated(session):
    return found_with(session)


def round_of(session, *effects):
    """Effects with the sensor's gain before them, the first one ahead by a little."""
    rows = [Ranked.of(found_with(session, GAIN, effect)) for effect in effects]
    return [replace(row, log_evidence=-0.1 * i) for i, row in enumerate(rows)]


def test_the_law_that_it_imitated_takes_its_place_and_the_better_odds(session, calibrated):
    ranked = round_of(session, STIFF, SPRING, MASS)
    other = instead_of(session, calibrated, ranked[0].fit, 1, ranked, ["absorber"])

    gain, mass = other.fit.hypothesis.effects
    assert (gain.kind, mass.kind) == ("sensor_gain", "point_mass")
    assert mass.mass == pytest.approx(0.1, rel=0.02)
    first, second, third = other.ranked
    assert first.fit is other.fit
    assert (first.effect, second.effect.kind, third.effect.kind) == (mass, "point_stiffness", "absorber")
    assert third.log_evidence == pytest.approx(first.log_evidence - log(SIMPLER))


def test_it_is_fitted_beside_what_was_found_after_it(session, calibrated):
    alone = [Ranked.of(found_with(session, effect)) for effect in (STIFF, MASS)]
    other = instead_of(session, calibrated, found_with(session, STIFF, GAIN), 0, alone, ["absorber"])

    mass, gain = other.fit.hypothesis.effects
    assert mass.mass == pytest.approx(0.1, rel=0.02)
    assert gain.gain == pytest.approx(0.8, rel=0.01)


def test_what_explains_less_or_was_asked_already_takes_no_place(session, calibrated):
    ranked = round_of(session, STIFF, SPRING, MASS)
    found = ranked[0].fit
    assert instead_of(session, calibrated, found, 1, ranked[:2], ["absorber"]) is None
    assert instead_of(session, calibrated, found, 1, ranked, ["absorber", "point_mass"]) is None
    beaten = [ranked[0], replace(ranked[2], refitted=False)]
    assert instead_of(session, calibrated, found, 1, beaten, ["absorber"]) is None
