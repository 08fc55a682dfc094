"""What has fewer numbers is begun where what has more has come to."""

from dataclasses import dataclass

import pytest
from trial_records import REFERENCE, fit_of

from identification.simpler import simpler_ones
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.contact_stiffness import ContactStiffness
from models.effects.hertz_contact import HertzContact
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain


@dataclass
class Seen:
    """A sketch, as far as it matters here."""

    effect: object


def at(share):
    return Place(position=share * REFERENCE.structure.length)


STIFF = Absorber(at(0.6), 0.03, 9000.0, 1.2)


def test_a_mass_is_begun_from_an_absorber_that_has_become_one():
    (found,) = simpler_ones(STIFF, [Seen(STIFF), Seen(PointMass(at(0.55), 0.2)), Seen(PointMass(at(0.1), 0.9))])
    assert found == PointMass(at(0.6), 0.03)  # its place and its mass, which mean the same


def test_a_number_of_another_meaning_stays_its_own():
    (found,) = simpler_ones(STIFF, [Seen(PointDamping(at(0.55), 40.0))])
    assert found == PointDamping(at(0.6), 40.0)


@pytest.mark.parametrize(
    ("leader", "other"),
    [
        (PointMass(at(0.6), 0.03), STIFF),
        (PointMass(at(0.6), 0.03), PointDamping(at(0.6), 3.0)),
        (STIFF, SensorGain(Place(sensor="P3"), 1.1)),
        (HertzContact(Place(sleeve="sleeve 1"), 1e9, 1.5), ContactStiffness(Place(sleeve="sleeve 2"), 2.0)),
        (HertzContact(Place(sleeve="sleeve 1"), 1e9, 1.5), PointMass(at(0.6), 0.03)),
    ],
)
def test_what_is_no_simpler_or_sits_elsewhere_is_not_begun(leader, other):
    assert list(simpler_ones(leader, [Seen(other)])) == []


def test_the_same_sleeve_will_do():
    sleeve = Place(sleeve="sleeve 1")
    (found,) = simpler_ones(HertzContact(sleeve, 1e9, 1.5), [Seen(ContactStiffness(sleeve, 2.0))])
    assert found == ContactStiffness(sleeve, 2.0)
    assert fit_of(found, 1.0).hypothesis.effects == (found,)
