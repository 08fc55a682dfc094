"""What else may stand where the best effect has come to."""

from dataclasses import replace
from math import exp

import pytest
from trial_records import OSCILLATOR, REFERENCE, beam_session, evaluator_of, found_with, measured, multisine

from identification import in_its_place
from identification.calibrate import strained
from identification.evidence import Ranked, with_evidence
from identification.fit import fit
from identification.hypothesis import LARGEST_SIGMA, Hypothesis, effect_unknowns, rig_unknowns
from identification.in_all_sleeves import in_all_sleeves
from identification.in_its_place import EXPLAINED, against, settled_apart, with_others_there
from models.effects import EFFECTS, Place
from models.effects.absorber import Absorber
from models.effects.axial_load import AxialLoad
from models.effects.bouc_wen import BoucWen
from models.effects.clamp_compliance import ClampCompliance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.coulomb_friction import CoulombFriction
from models.effects.force_gain import ForceGain
from models.effects.hertz_contact import HertzContact
from models.effects.hunt_crossley import HuntCrossley
from models.effects.local_damage import LocalDamage
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm
from models.effects.time_varying_damping import TimeVaryingDamping

SLEEVE = REFERENCE.sleeves[1]
IN_SLEEVE = Place(sleeve=SLEEVE.name, position=SLEEVE.position)


def at(position):
    return Place(position=position)


def rows_after(session, leader, *kinds):
    found = found_with(session, leader)
    first = Ranked.of(found)
    rows = with_others_there(
        session.fitting, found_with(session), [first], {kind: EFFECTS[kind] for kind in kinds}, lambda _: None
    )
    return found, rows


def test_the_simpler_law_is_fitted_where_the_larger_one_has_come_to_above_the_noise_too():
    """An absorber so stiff that it is a mass, while a sensor's gain is wrong besides."""
    session = beam_session(PointMass(at(0.86), mass=0.1), SensorGain(Place(sensor="P4"), gain=0.8))
    stiff = Absorber(at(0.86), mass=0.1, frequency=2000.0, damping_ratio=0.1)

    found, rows = rows_after(session, stiff, "point_mass", "absorber")

    assert found.ratio > EXPLAINED
    (mass,) = [row for row in rows if row.effect.kind == "point_mass"]
    assert mass.refitted
    assert mass.effect.mass == pytest.approx(0.1, rel=0.3)  # beside a gain that nothing explains


def test_hysteresis_that_yields_at_once_is_friction_and_at_a_sleeve_the_sleeves_own():
    session = beam_session(CoulombFriction(IN_SLEEVE, friction_force=0.3, slip_velocity=2e-3))
    kinds = ("coulomb_friction", "point_damping", "point_mass", "bouc_wen")

    found, rows = rows_after(session, BoucWen(at(SLEEVE.position), 0.3, 1e-9, 1.0), *kinds)

    assert rows[0].effect.label() == f"coulomb_friction against base at {SLEEVE.name}"
    assert rows[0].effect.friction_force == pytest.approx(0.3, rel=0.05)
    assert rows[0].fit.ratio < found.ratio
    assert [row.effect.kind for row in rows].count("coulomb_friction") == 1


def test_a_law_that_may_vary_in_time_gives_way_to_a_constant_one_and_far_numbers_are_read_from_that(monkeypatch):
    """Both have one number to fit, but of one it is a table."""
    read_from = []
    monkeypatch.setattr(in_its_place, "said_of_far_numbers", lambda leader, _: read_from.append(leader) or ())
    session = beam_session(HuntCrossley(IN_SLEEVE, dissipation=1.0))
    table = TimeVaryingDamping(IN_SLEEVE, times=(0.0, 1.0, 2.0), values=(5.0, 5.0, 5.0))

    found, rows = rows_after(session, table, "hunt_crossley", "time_varying_damping")

    assert rows[0].effect.kind == "hunt_crossley"
    assert rows[0].effect.dissipation == pytest.approx(1.0, rel=0.2)
    assert rows[0].fit.ratio <= found.ratio
    assert [leader.hypothesis.effects[-1].kind for leader in read_from] == ["hunt_crossley"]


@pytest.mark.parametrize(("position", "stands"), [(0.02, "clamp_compliance"), (0.5, "local_damage")])
def test_a_clamp_that_turns_stands_for_damage_beside_it_which_has_a_place_to_fit(position, stands):
    clamp = ClampCompliance(Place(), rotational_stiffness=8e4)
    damage = LocalDamage(at(position), loss=0.5)
    session = beam_session(clamp if stands == clamp.kind else damage, n=4096)

    found, rows = rows_after(session, damage, "clamp_compliance", "local_damage", "axial_load")

    assert rows[0].effect.kind == stands
    assert rows[0].fit.ratio < 1.05 * found.ratio


def test_on_an_oscillator_the_simpler_law_is_tried_too():
    friction = CoulombFriction(Place(), friction_force=5.0, slip_velocity=2e-3)
    evaluator = evaluator_of(measured(Hypothesis(OSCILLATOR, effects=(friction,)), multisine(4096)))
    base = fit(evaluator, Hypothesis(OSCILLATOR), rig_unknowns(OSCILLATOR), precise=True)
    stiff = Hypothesis(OSCILLATOR, effects=(BoucWen(Place(), 5.0, 1e-9, 1.0),))
    leader = fit(evaluator, stiff, (*base.unknowns, *effect_unknowns(stiff)), precise=True)

    kinds = {kind: EFFECTS[kind] for kind in ("coulomb_friction", "point_damping")}
    rows = with_others_there(evaluator, base, [Ranked.of(leader)], kinds, lambda _: None)

    assert rows[0].effect.kind == "coulomb_friction"
    assert rows[0].effect.friction_force == pytest.approx(5.0, rel=0.05)


def test_what_is_in_all_sleeves_is_no_simpler_law():
    session = beam_session(HertzContact(IN_SLEEVE, stiffness=3e8, exponent=1.8))
    registry = {**in_all_sleeves(EFFECTS, REFERENCE), "contact_stiffness": EFFECTS["contact_stiffness"]}
    found = Ranked.of(found_with(session, HertzContact(IN_SLEEVE, stiffness=3e8, exponent=1.8)))

    rows = with_others_there(session.fitting, found_with(session), [found], registry, lambda _: None)

    assert {row.effect.label() for row in rows} <= {"hertz_contact at sleeve 2", "contact_stiffness at sleeve 2"}


def test_a_law_beside_a_sleeve_keeps_its_place_where_the_records_tell_it():
    place = at(SLEEVE.position + 0.025)
    session = beam_session(CoulombFriction(place, friction_force=0.5, slip_velocity=2e-3), n=4096)

    _, rows = rows_after(session, CoulombFriction(place, friction_force=0.5, slip_velocity=2e-3))

    assert rows[0].effect.place.sleeve is None
    assert rows[0].effect.place.position == pytest.approx(place.position, abs=5e-3)
    assert [row.effect.place.sleeve for row in rows[1:]] == [SLEEVE.name]


@pytest.mark.parametrize("away", [0.01, 0.2])
def test_a_dashpot_that_came_to_a_sleeve_is_held_against_what_sits_in_it(away):
    """Grease in a sleeve whose wall is never left is a dashpot; a dashpot elsewhere is asked nothing."""
    session = beam_session(SqueezeFilm(IN_SLEEVE, damping=1.0), n=4096, rms=0.3)

    _, rows = rows_after(session, PointDamping(at(SLEEVE.position - away), damping=28.0), "squeeze_film", "point_mass")

    found = [(row.effect.kind, row.effect.place.sleeve) for row in rows]
    assert (("squeeze_film", SLEEVE.name) in found) == (away < 0.1)


def test_the_simpler_law_begins_beside_the_other_effects_of_the_first_and_at_its_own_size(monkeypatch):
    """A friction that never sticks is a dashpot; before it stood, the gain had taken up some of what it does."""
    gain, dashpot = ForceGain(Place(), gain=1.36), PointDamping(at(0.86), damping=13.6)
    session = beam_session(gain, dashpot)
    friction = CoulombFriction(at(0.86), friction_force=8.2, slip_velocity=0.6)
    found, before = Ranked.of(found_with(session, gain, friction)), found_with(session, replace(gain, gain=1.5))
    begun = []
    monkeypatch.setattr(in_its_place, "against", lambda *args: (begun.append(args[-1]), against(*args))[1])

    rows = with_others_there(
        session.fitting, before, [found], {"point_damping": EFFECTS["point_damping"]}, lambda _: None
    )

    (start,) = begun
    assert start.effects[0].gain == pytest.approx(1.36, rel=3e-4)
    assert start.effects[1].damping == pytest.approx(13.6, rel=0.02)
    assert rows[0].effect.kind == "point_damping"


FIRST_SLEEVE = Place(sleeve=REFERENCE.sleeves[0].name, position=REFERENCE.sleeves[0].position)


@pytest.mark.parametrize("stood", [AxialLoad(Place(), force=0.1), ContactStiffness(FIRST_SLEEVE, ratio=1.001)])
def test_what_a_sleeve_needs_a_number_at_the_end_of_its_tolerance_for_is_tried_as_an_effect(stood):
    """Beside a stiffness that has gone as far as it may nothing shows that the contact is stiffer still."""
    stiffness = next(each for each in rig_unknowns(REFERENCE) if each.parameter.path == "sleeves[1].stiffness")
    ratio = 1.02 * exp(LARGEST_SIGMA * stiffness.parameter.tolerance)
    session = beam_session(ContactStiffness(IN_SLEEVE, ratio=ratio))
    begun = stiffness.set(Hypothesis(REFERENCE, effects=(stood,)), LARGEST_SIGMA)
    load = fit(session.fitting, begun, (*rig_unknowns(REFERENCE), *effect_unknowns(begun)), max_iterations=0)
    kinds = {kind: EFFECTS[kind] for kind in ("contact_stiffness", "clearance", "gap_offset")}

    rows = with_others_there(session.fitting, found_with(session), [Ranked.of(load)], kinds, lambda _: None)

    assert rows[0].effect.label() == "contact_stiffness at sleeve 2"
    assert rows[0].effect.ratio == pytest.approx(ratio, rel=0.02)
    assert not strained(rows[0].fit)


@pytest.mark.parametrize("iterations", [1, 12])
def test_of_fits_that_have_met_one_is_left(iterations):
    session = beam_session(PointMass(at(0.86), mass=0.1))
    best, other = (
        Ranked.of(found_with(session, PointMass(at(place), mass=mass), iterations=n))
        for place, mass, n in ((0.86, 0.1, 12), (0.87, 0.105, iterations))
    )

    rows = settled_apart(session.fitting, with_evidence([best, other]), lambda _: None)

    assert [row.effect.mass for row in rows] == [pytest.approx(0.1, rel=0.01)]


def test_above_the_noise_one_kind_in_one_valley_is_not_fitted_to_the_end(monkeypatch):
    session = beam_session(PointMass(at(0.86), mass=0.1), SensorGain(Place(sensor="P4"), gain=0.8))
    best = Ranked.of(found_with(session, PointMass(at(0.86), mass=0.1)))
    near = replace(best, effect=replace(best.effect, mass=1.2 * best.effect.mass), log_evidence=-0.1)
    assert best.fit.ratio > EXPLAINED
    monkeypatch.setattr(in_its_place, "fit", lambda *_, **__: pytest.fail("fitted"))

    assert settled_apart(session.fitting, [best, near], lambda _: None) == [best, near]


def test_fits_that_have_not_met_are_two():
    session = beam_session(PointMass(at(0.86), mass=0.1))
    alone = Ranked.of(found_with(session, PointMass(at(0.86), mass=0.1)))
    damped = Ranked.of(found_with(session, PointDamping(at(0.86), damping=5.0)))

    rows = settled_apart(session.fitting, with_evidence([alone, damped]), lambda _: None)

    assert [row.effect.kind for row in rows] == ["point_mass", "point_damping"]
