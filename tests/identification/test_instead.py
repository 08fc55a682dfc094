"""A law that is not established gives its place to another of its round that explains the records as well."""

from dataclasses import replace
from math import log

import pytest
from trial_records import REFERENCE, beam_session, found_with

from identification.evidence import SIMPLER, Ranked
from identification.hypothesis import rig_unknowns
from identification.in_all_sleeves import InAllSleeves
from identification.instead import instead_of, within_tolerances
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.axial_load import AxialLoad
from models.effects.contact_stiffness import ContactStiffness
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


def test_how_far_a_refused_law_is_followed_is_not_kept(session, calibrated, monkeypatch):
    ranked = round_of(session, STIFF, MASS)
    ended, limits, told = session.to_the_end(ranked[0].fit), [*session.limits], [*session.decisions]

    def shortened(found):
        session.limits[0] = replace(limits[0], seconds=0.1)
        session.decide("followed for 0.1 s")
        return replace(found, n_data=ended.n_data // 2)

    monkeypatch.setattr(session, "to_the_end", lambda found: ended if found is ranked[0].fit else shortened(found))

    assert instead_of(session, calibrated, ranked[0].fit, 1, ranked, ["absorber"]) is None
    assert (session.limits, session.decisions) == (limits, told)


def test_what_says_why_a_number_leaves_its_tolerance_takes_the_place_of_what_only_stood_beside_it():
    sleeve = REFERENCE.sleeves[1]
    stiffer = ContactStiffness(Place(sleeve=sleeve.name, position=sleeve.position), ratio=2.0)
    session = beam_session(stiffer)
    calibrated, load = found_with(session), Ranked.of(found_with(session, AxialLoad(Place(), force=1.0)))
    right = Ranked.of(found_with(session, stiffer))
    stiffness = next(u for u in rig_unknowns(REFERENCE) if u.parameter.path == "sleeves[1].stiffness")
    far = replace(load, fit=replace(load.fit, hypothesis=stiffness.set(load.fit.hypothesis, 4.0)))

    other = within_tolerances(session, calibrated, far.fit, 0, [far, right], ["axial_load"])

    assert other.fit.hypothesis.effects[0].ratio == pytest.approx(2.0, rel=0.02)
    assert [row.effect.kind for row in other.ranked] == ["contact_stiffness", "axial_load"]
    near = replace(load, fit=right.fit)
    assert within_tolerances(session, calibrated, near.fit, 0, [near, right], ["axial_load"]) is None
    assert within_tolerances(session, calibrated, far.fit, 0, [far, right], ["axial_load", "contact_stiffness"]) is None
    everywhere = replace(right, effect=InAllSleeves(stiffer.place, members=(stiffer, stiffer)))
    assert within_tolerances(session, calibrated, far.fit, 0, [far, everywhere], ["axial_load"]) is None
    bent = replace(right, fit=far.fit)
    assert within_tolerances(session, calibrated, far.fit, 0, [far, bent], ["axial_load"]) is None
