"""Effects that change a sleeve's contact."""

from dataclasses import replace

import numpy as np
import pytest
from effect_scenes import CONTACT, PLACES, scene_at

from models.contact.hunt_crossley import HuntCrossley as HuntCrossleyLaw
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact_forces import penetration_of
from models.effects.clearance import Clearance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.gap_offset import GapOffset
from models.effects.hertz_contact import HertzContact
from models.effects.hunt_crossley import HuntCrossley
from models.effects.time_varying_damping import TimeVaryingDamping
from models.effects.wear import Wear
from models.rest import contact_force

SLEEVE = PLACES["sleeve"]


def changed(*effects):
    contact = CONTACT
    for effect in effects:
        contact = effect.change_contact(contact)
    return contact


def test_a_wider_clearance_starts_the_contact_later():
    """K (|q| - d) at q = 5e-4 m: 1e5 (5e-4 - 3e-4) = 20 N back to the centre, nothing within the gap."""
    wide = changed(Clearance(SLEEVE, clearance=3e-4))
    assert contact_force(wide, 5e-4) == pytest.approx(-20.0)
    assert contact_force(wide, -5e-4) == pytest.approx(20.0)
    assert contact_force(wide, 2.9e-4) == 0.0


def test_without_clearance_the_sleeve_is_a_spring_both_ways():
    assert contact_force(changed(Clearance(SLEEVE, clearance=0.0)), -1e-5) == pytest.approx(1.0)


def test_an_offset_moves_the_gap():
    """Centre 1e-4 m up, clearance 2e-4 m: walls at 3e-4 and -1e-4 m."""
    lopsided = changed(GapOffset(SLEEVE, offset=1e-4))
    assert contact_force(lopsided, 2.9e-4) == 0.0
    assert contact_force(lopsided, 4e-4) == pytest.approx(-10.0)
    assert contact_force(lopsided, -2e-4) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("offset", "words"), [(1e-4, "the upper gap is 0.1 mm wider"), (-1e-4, "the lower gap is 0.1 mm")]
)
def test_words_name_the_wider_gap(offset, words):
    effect = GapOffset(SLEEVE, offset=offset)
    wall = offset + CONTACT.clearance * (1 if offset > 0 else -1)
    assert contact_force(changed(effect), 0.999 * wall) == 0.0
    assert words in effect.in_words()


def test_an_offset_and_its_mirror_image_push_alike():
    up, down = (changed(GapOffset(SLEEVE, offset=side * 1e-4)) for side in (1.0, -1.0))
    for q in (-5e-4, -1.5e-4, 0.0, 2.5e-4, 5e-4):
        assert contact_force(up, q) == -contact_force(down, -q)


def test_a_stiffer_contact_keeps_its_damping():
    law = changed(ContactStiffness(SLEEVE, ratio=1.5)).law
    assert law.elastic(1e-4) == pytest.approx(1.5 * CONTACT.law.elastic(1e-4))
    assert law.damping_at(1e-4, 0.1) == pytest.approx(80.0)


def test_hunt_crossley_takes_the_place_of_the_dashpot():
    """K p (1 + 3/2 alpha dp/dt) at p = 1e-4 m, 0.1 m/s: 10 (1 + 0.15 alpha)."""
    law = changed(HuntCrossley(SLEEVE, dissipation=2.0)).law
    assert law.normal_force(0.0, 1e-4, 0.1, 0.0, law.values) == pytest.approx(13.0)
    assert law.normal_force(0.0, 0.0, 0.1, 0.0, law.values) == 0.0


def test_hunt_crossley_keeps_the_present_spring_whatever_the_order():
    effects = (ContactStiffness(SLEEVE, ratio=1.5), HuntCrossley(SLEEVE, dissipation=2.0))
    assert changed(*effects).law == changed(*reversed(effects)).law == HuntCrossleyLaw(1.5e5, 2.0)


def test_the_middle_trial_of_hunt_crossley_damps_like_the_given_dashpot_at_the_largest_penetration():
    scene = scene_at(SLEEVE)
    _, same, _ = HuntCrossley.trials(scene)
    assert changed(same).law.damping_at(scene.penetration, 0.01) == pytest.approx(80.0)
    assert same.dissipation == pytest.approx(80.0 / (1.5 * 1e5 * 2e-5))


@pytest.mark.parametrize("kind", [Clearance, GapOffset])
@pytest.mark.parametrize("rest", [5e-5, -5e-5, 0.0])
def test_a_wall_that_the_motion_does_not_come_to_is_tried_where_it_does(kind, rest):
    """Of a gap of 0.2 mm no share brings a wall into a motion of 0.015 mm about a rest 0.05 mm off the axis."""
    scene = scene_at(SLEEVE, displacement=1.5e-5, rest=rest)
    contacts = [changed(effect) for effect in kind.trials(scene)]
    walls = {
        side: [side * (contact.offset + side * contact.clearance - rest) / scene.displacement for contact in contacts]
        for side in (1.0, -1.0)
    }
    met = {side: sorted(round(each, 6) for each in reached if 0.0 < each < 1.0) for side, reached in walls.items()}
    sides = (1.0, -1.0) if kind is GapOffset or rest == 0.0 else (float(np.sign(rest)),)
    assert {side: reached for side, reached in met.items() if reached} == {side: [0.3, 0.6, 0.9] for side in sides}


def test_a_gap_of_a_sleeve_off_its_axis_is_tried_where_the_nearer_wall_comes_into_the_motion():
    contact = replace(CONTACT, offset=1e-4)
    scene = scene_at(SLEEVE, contact=contact, displacement=1.5e-5, rest=5e-5)
    lower = [contact.offset - effect.clearance for effect in Clearance.trials(scene)]
    met = sorted(round((scene.rest - wall) / scene.displacement, 6) for wall in lower)
    assert {0.3, 0.6, 0.9} <= set(met)


@pytest.mark.parametrize(("t", "damping"), [(0.0, 90.0), (1.0, 90.0), (2.0, 60.0), (3.0, 30.0), (9.0, 30.0)])
def test_the_damping_follows_the_table_and_is_constant_outside(t, damping):
    law = changed(TimeVaryingDamping(SLEEVE, times=(1.0, 3.0), values=(90.0, 30.0))).law
    assert law.normal_force(t, 1e-4, 0.1, 0.0, law.values) == pytest.approx(10.0 + 0.1 * damping)


def test_a_table_that_stands_still_is_kelvin_voigt():
    law = changed(TimeVaryingDamping(SLEEVE, times=(0.0, 1.0), values=(80.0, 80.0))).law
    for t in (0.0, 0.3, 2.0):
        assert law.normal_force(t, 1e-4, -0.1, 0.0, law.values) == pytest.approx(
            KelvinVoigt.normal_force(t, 1e-4, -0.1, 0.0, CONTACT.law.values)
        )


def test_a_table_keeps_the_spring_that_another_effect_changed():
    effects = (ContactStiffness(SLEEVE, ratio=2.0), TimeVaryingDamping(SLEEVE, times=(0.0,), values=(5.0,)))
    assert changed(*effects).law.elastic(1e-4) == changed(*reversed(effects)).law.elastic(1e-4) == pytest.approx(20.0)


@pytest.mark.parametrize(
    "effect",
    [
        Clearance(SLEEVE, clearance=3e-4),
        GapOffset(SLEEVE, offset=5e-5),
        ContactStiffness(SLEEVE, ratio=2.0),
        HuntCrossley(SLEEVE, dissipation=3.0),
        TimeVaryingDamping(SLEEVE, times=(0.0, 1.0), values=(1.0, 2.0)),
    ],
)
def test_only_what_it_names_changes(effect):
    contact = changed(effect)
    field = {"clearance": "clearance", "gap_offset": "offset"}.get(effect.kind, "law")
    assert contact != CONTACT
    assert replace(contact, **{field: getattr(CONTACT, field)}) == CONTACT


def test_a_hertz_contact_keeps_the_dashpot_and_grows_with_its_exponent():
    pressed = changed(HertzContact(SLEEVE, stiffness=1e7, exponent=1.5))
    assert contact_force(pressed, 3e-4) == pytest.approx(-1e7 * 1e-4**1.5)
    assert contact_force(pressed, 3e-4, 0.1) == pytest.approx(-1e7 * 1e-4**1.5 - 8.0)


def test_a_hertz_contact_of_exponent_one_is_the_contact_as_it_was():
    assert contact_force(changed(HertzContact(SLEEVE, 1e5, 1.0)), 3.3e-4, 0.02) == contact_force(CONTACT, 3.3e-4, 0.02)


def test_a_hertz_contact_loses_energy_as_the_law_before_did():
    dissipating = changed(HuntCrossley(SLEEVE, dissipation=2.0), HertzContact(SLEEVE, 1e7, 1.5))
    assert contact_force(dissipating, 3e-4, 0.1) == pytest.approx(-1e7 * 1e-4**1.5 * (1.0 + 1.5 * 2.0 * 0.1))


def test_a_table_of_dampings_and_a_hertz_contact_come_in_any_order():
    hertz, table = HertzContact(SLEEVE, 1e7, 1.5), TimeVaryingDamping(SLEEVE, times=(0.0, 1.0), values=(20.0, 40.0))
    one, other = changed(hertz, table), changed(table, hertz)
    assert one == other
    assert one.law.normal_force(0.5, 1e-4, 0.1, 0.0, one.law.values) == pytest.approx(1e7 * 1e-4**1.5 + 3.0)


def test_a_sleeve_without_gap_presses_both_ways():
    held = changed(Clearance(SLEEVE, clearance=0.0), HertzContact(SLEEVE, 1e7, 1.5))
    assert contact_force(held, 1e-4) == -contact_force(held, -1e-4) == pytest.approx(-1e7 * 1e-4**1.5)


def test_wear_widens_the_gap_from_the_records_start():
    worn = changed(Wear(SLEEVE, rate=1e-5))
    assert (worn.clearance, worn.clearance_rate) == (CONTACT.clearance, 1e-5)
    assert contact_force(worn, 3e-4) == contact_force(CONTACT, 3e-4)


@pytest.mark.parametrize("later", [0.5, 2.0])
def test_a_worn_sleeve_is_touched_as_a_wider_one(later):
    """The compiled stepper's penetration after a while: |q| - (clearance + rate t), closing slower by the rate."""
    row = np.array([[CONTACT.clearance, 0.0, 1e-5, 0.0]])
    p, rate, _ = penetration_of(row, 0, later, 3e-4, 0.02)
    assert p == pytest.approx(1e-4 - 1e-5 * later)
    assert rate == pytest.approx(0.02 - 1e-5)
