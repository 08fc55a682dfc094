"""An effect whose size its honest interval does not tell from none is found as such, and no other is."""

from dataclasses import replace
from math import log

import numpy as np
import pytest
from trial_records import REFERENCE, fit_of

from identification.established import (
    NO_LAW,
    NO_LAW_OF_ALL,
    NO_NUMBER,
    NO_PLACE,
    NO_SIZE,
    NOWHERE,
    TOLD,
    TOLD_BY_PARTS,
    TWO_PLACES,
    UNTOLD,
    UNTOLD_ABOVE,
    UNTOLD_UP_TO,
    of_one_law,
    unestablished,
)
from identification.hypothesis import PlaceUnknown, effect_unknowns
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.bouc_wen import BoucWen
from models.effects.clamp_compliance import ClampCompliance
from models.effects.coulomb_friction import CoulombFriction
from models.effects.gap_offset import GapOffset
from models.effects.hertz_contact import HertzContact
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain

LENGTH = REFERENCE.structure.length
AT = Place(position=0.6 * LENGTH)
SLEEVE = Place(sleeve="sleeve 1")


def with_log_std(effect, spreads):
    """A fit whose numbers are known to this share of their prior's spread."""
    return fit_of(effect, 1000.0, std=spreads)


@pytest.mark.parametrize("effect", [PointMass(AT, 0.05), ClampCompliance(Place(), 1e5)])
def test_a_size_known_to_a_factor_is_established_or_not(effect):
    spread = effect.fitted_parameters()[0][1].spread
    assert unestablished(with_log_std(effect, 0.9 * log(3.0) / spread)) is None
    assert unestablished(with_log_std(effect, 1.1 * log(3.0) / spread)) == (0, NO_SIZE)


def test_a_factor_is_measured_from_one():
    spread = SensorGain.parameters()["gain"].spread
    std = 0.03 / spread if SensorGain.parameters()["gain"].scale == "log" else 0.03
    known = fit_of(SensorGain(Place(sensor="P3"), 1.1), 1000.0)
    unit = known.unknowns[0].unit if SensorGain.parameters()["gain"].scale == "linear" else 1.0
    assert unestablished(replace(known, covariance=np.array([[(std / unit) ** 2]]))) is None
    near = replace(known, hypothesis=replace(known.hypothesis, effects=(SensorGain(Place(sensor="P3"), 1.01),)))
    assert unestablished(replace(near, covariance=np.array([[(std / unit) ** 2]]))) == (0, NO_SIZE)


def test_an_offset_is_measured_from_none_whatever_its_sign():
    for sign in (-1.0, 1.0):
        found = fit_of(GapOffset(SLEEVE, sign * 1e-4), 1000.0)
        unit = found.unknowns[0].unit
        assert unestablished(replace(found, covariance=np.array([[(1.9e-4 / unit) ** 2]]))) is None
        assert unestablished(replace(found, covariance=np.array([[(2.1e-4 / unit) ** 2]]))) == (0, NO_SIZE)


TURN = np.array([[1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(2.0)


def known_together(effect, apart, together):
    """A fit of an effect with two numbers, of which the ratio is known otherwise than the product."""
    return replace(fit_of(effect, 1000.0), covariance=TURN.T @ np.diag([together, apart]) @ TURN)


def test_of_two_numbers_the_records_have_to_tell_one():
    """A friction that never sticks is known by its force over its slip velocity: that is a dashpot's one number."""
    friction = CoulombFriction(AT, 5.0, 1.0)
    apart = 2.0 * TOLD_BY_PARTS**2
    assert unestablished(known_together(friction, 0.8 * apart, 1e-4)) is None
    assert unestablished(known_together(friction, 1.3 * apart, 1e-4)) == (0, NO_LAW_OF_ALL)
    assert unestablished(known_together(friction, 1.3 * 2.0 * TOLD**2, 1e-4)) == (0, NO_LAW)
    assert unestablished(known_together(friction, 25.0, 25.0)) == (0, NO_SIZE)


def test_what_parts_of_the_data_disagree_about_is_a_doubt_of_the_law_where_the_noise_is_reached():
    widely = replace(
        known_together(CoulombFriction(AT, 5.0, 1.0), 1.3 * 2.0 * TOLD_BY_PARTS**2, 1e-4), widened=np.array([3.0, 3.0])
    )
    assert unestablished(widely) == (0, NO_LAW_OF_ALL)
    assert unestablished(widely, predicted=True) is None
    assert unestablished(replace(widely, chi2=1.2**2 * widely.n_data)) is None


def test_a_law_of_which_parts_leave_no_number_known_is_doubted_whatever_it_predicts():
    for share, why in ((0.9, None), (1.1, (0, NO_NUMBER))):
        found = known_together(CoulombFriction(AT, 5.0, 1.0), share**2 * 2.0 * UNTOLD**2, 1e-4)
        found = replace(found, widened=np.array([10.0, 10.0]))
        assert unestablished(found, predicted=True) == why
        assert unestablished(found) == (why or (0, NO_LAW_OF_ALL))


def test_above_the_noise_a_law_is_doubted_of_which_parts_leave_half_as_much_known():
    for share, why in ((0.9, None), (1.1, (0, NO_NUMBER))):
        found = known_together(CoulombFriction(AT, 5.0, 1.0), share**2 * 2.0 * UNTOLD_ABOVE**2, 1e-4)
        found = replace(found, widened=np.array([10.0, 10.0]))
        assert unestablished(found, predicted=True) is None
        for ratio, told in ((1.2, why), (0.95 * UNTOLD_UP_TO, why), (1.05 * UNTOLD_UP_TO, None)):
            assert unestablished(replace(found, chi2=ratio**2 * found.n_data), predicted=True) == told


def test_what_all_laws_miss_is_no_doubt_of_the_law():
    """A fit three times above the noise: its numbers are known a third as well, and the law as well as before."""
    missed = replace(known_together(CoulombFriction(AT, 5.0, 1.0), 0.8 * 2.0 * TOLD**2, 1e-4), chi2=9000.0)
    assert missed.ratio == pytest.approx(3.0)
    assert unestablished(missed) is None
    beyond = replace(known_together(CoulombFriction(AT, 5.0, 1.0), 1.3 * 2.0 * TOLD**2, 1e-4), chi2=9000.0)
    assert unestablished(beyond) == (0, NO_LAW)


def test_at_rest_the_law_is_not_asked_for():
    found = known_together(CoulombFriction(AT, 5.0, 1.0), 1.3 * 2.0 * TOLD**2, 1e-4)
    assert unestablished(found, in_motion=False) is None


def test_a_law_of_one_number_is_established_by_its_size_alone():
    spread = PointMass.parameters()["mass"].spread
    assert unestablished(with_log_std(PointMass(AT, 0.05), log(2.0) / spread)) is None


def test_beside_another_effect_what_may_sit_anywhere_along_the_beam_has_no_place():
    alone = fit_of(PointMass(AT, 0.05), 1000.0, places=True)
    model = replace(alone.hypothesis, effects=(PointMass(AT, 0.05), ClampCompliance(Place(), 1e5)))
    both = replace(alone, hypothesis=model, unknowns=effect_unknowns(model))
    for share, why in ((0.9, None), (1.1, (0, NO_PLACE))):
        std = share * NOWHERE * LENGTH / alone.unknowns[-1].unit
        assert unestablished(replace(alone, covariance=np.diag([1e-4, std**2]))) is None
        assert unestablished(replace(both, covariance=np.diag([1e-4, std**2, 1e-4]))) == why


def fit_of_two(one, other, std=1e-4):
    """A fit of two effects whose places are known to this share of the length."""
    alone = fit_of(one, 1000.0)
    model = replace(alone.hypothesis, effects=(one, other))
    unknowns = effect_unknowns(model, places=True)
    size = [20.0 * std if isinstance(unknown, PlaceUnknown) else 0.01 for unknown in unknowns]
    return replace(alone, hypothesis=model, unknowns=unknowns, covariance=np.diag(np.square(size)))


def at(share):
    return Place(position=share * LENGTH)


HYSTERESIS, FRICTION = BoucWen(at(0.6), 5.0, 1e-4, 1.5), CoulombFriction(at(0.6), 5.0, 0.01)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (FRICTION, CoulombFriction(at(0.61), 1.0, 0.1)),
        (FRICTION, CoulombFriction(SLEEVE, 1.0, 0.1)),
        (HYSTERESIS, PointDamping(at(0.61), 1.0)),
        (Absorber(at(0.6), 0.1, 20.0, 0.02), PointStiffness(at(0.59), 1e4)),
    ],
)
def test_two_laws_at_one_place_may_be_one_that_the_library_does_not_hold(one, other):
    sleeve = next(sleeve for sleeve in REFERENCE.sleeves if sleeve.name == SLEEVE.sleeve).position
    if other.place == SLEEVE:
        one = replace(one, place=Place(position=sleeve + 0.01 * LENGTH))
        other = replace(other, place=replace(SLEEVE, position=sleeve))
    assert of_one_law(fit_of_two(one, other)) == (0, 1)
    assert of_one_law(fit_of_two(one, replace(other, place=at(0.8)))) is None


@pytest.mark.parametrize(
    "other",
    [
        PointDamping(at(0.6), 1.0),  # a seal rubs and drags
        PointStiffness(at(0.6), 1e4),
        GapOffset(SLEEVE, 1e-4),  # acts in a contact
        ClampCompliance(Place(), 1e5),
    ],
)
def test_what_a_support_or_a_contact_has_together_is_two_laws(other):
    assert of_one_law(fit_of_two(FRICTION, other)) is None


def test_two_absorbers_at_one_place_are_two():
    one = Absorber(at(0.6), 0.1, 20.0, 0.02)
    assert of_one_law(fit_of_two(one, replace(one, frequency=60.0))) is None


@pytest.mark.parametrize(("apart", "share", "found"), [(0.06, 1.1, (0, 1)), (0.06, 0.9, None), (0.1, 5.0, None)])
def test_places_are_one_where_the_records_do_not_tell_them_apart(apart, share, found):
    std = share * apart / TWO_PLACES / np.sqrt(2.0)
    both = fit_of_two(HYSTERESIS, PointDamping(at(0.6 + apart), 1.0), std)
    assert of_one_law(both) == found
    assert of_one_law(replace(both, chi2=1.2**2 * both.n_data)) is None  # there parts widen all places


def test_another_law_in_a_contact_has_no_size():
    assert unestablished(with_log_std(HertzContact(SLEEVE, 1e9, 1.5), 100.0)) is None


def test_the_misfit_counts():
    spread = PointMass.parameters()["mass"].spread
    found = with_log_std(PointMass(AT, 0.05), 0.9 * log(3.0) / spread)
    assert unestablished(replace(found, chi2=4000.0)) == (0, NO_SIZE)
