"""Equilibrium under gravity, contacts and laws, against closed forms to 1e-10 m."""

from dataclasses import replace

import numpy as np
import pytest
from model_scenes import EI, GRAVITY, LENGTH, REFERENCE, STRUCTURE, rig_with, sleeve

from models.effects import EFFECTS, Place
from models.errors import InputError
from models.modal import build_modal
from models.plant import build_plant
from models.ports import PointLaw, Port
from models.rest import contact_force, is_bilateral

POSITION = 1e-10  # m
WEIGHT = STRUCTURE.line_mass * GRAVITY


def sag(x):
    return -WEIGHT * x**2 * (6.0 * LENGTH**2 - 4.0 * LENGTH * x + x**2) / (24.0 * EI)


def flexibility(x, a):
    near, far = min(x, a), max(x, a)
    return near**2 * (3.0 * far - near) / (6.0 * EI)


def rest_of(plant):
    return build_modal(plant, 400.0).rest


def test_without_contact_the_beam_hangs_in_its_own_sag():
    plant = build_plant(rig_with(sleeve(0.6, clearance=1.0), sleeve(1.2, clearance=1.0)))
    rest = rest_of(plant)
    np.testing.assert_allclose(rest.position, [sag(0.6), sag(1.2)], atol=POSITION)
    assert not rest.contact_forces.any()
    np.testing.assert_allclose(rest.penetration, np.abs(rest.position) - 1.0)


@pytest.mark.parametrize("gravity", [9.81, -9.81])
@pytest.mark.parametrize("place", [0.5, 1.0, 1.4])
def test_one_sleeve_carries_what_its_spring_takes_from_the_sag(place, gravity):
    gap, k = 1e-4, 3e4
    rig = rig_with(sleeve(place, gap, stiffness=k), gravity=gravity)
    rest = rest_of(build_plant(rig))
    side = np.sign(gravity)
    force = k * (-sag(place) - gap) / (1.0 + k * flexibility(place, place))
    assert rest.contact_forces[0] == pytest.approx(side * force, rel=1e-9)
    assert rest.position[0] == pytest.approx(side * (sag(place) + flexibility(place, place) * force), abs=POSITION)
    assert rest.penetration[0] == pytest.approx(force / k, abs=POSITION)


def test_two_sleeves_share_the_weight_as_the_flexibility_matrix_says():
    rest = rest_of(build_plant(REFERENCE))
    places = [s.position for s in REFERENCE.sleeves]
    bend = np.array([[flexibility(x, a) for a in places] for x in places])
    k, gap = 1e5, 1.5e-4
    touching = rest.penetration > 0
    assert touching.any()
    balance = np.array([sag(x) for x in places]) + bend @ rest.contact_forces
    np.testing.assert_allclose(rest.position, balance, atol=POSITION)
    expected = np.where(touching, -np.sign(rest.position) * k * (np.abs(rest.position) - gap), 0.0)
    np.testing.assert_allclose(rest.contact_forces, expected, atol=k * POSITION)


def test_an_offset_moves_the_sleeve_against_the_beam():
    offset = EFFECTS["gap_offset"](Place(sleeve="at 1.0", position=1.0), offset=5e-4)
    rig = rig_with(sleeve(1.0, 1e-4, stiffness=1e4), gravity=0.0)
    rest = rest_of(build_plant(rig, extra=[offset]))
    force = 1e4 * (5e-4 - 1e-4) / (1.0 + 1e4 * flexibility(1.0, 1.0))
    assert rest.contact_forces[0] == pytest.approx(force, rel=1e-9)
    assert rest.position[0] == pytest.approx(flexibility(1.0, 1.0) * force, abs=POSITION)


def test_a_sleeve_without_clearance_is_a_spring_that_is_relaxed_on_the_axis():
    rest = rest_of(build_plant(rig_with(sleeve(1.0, clearance=0.0, stiffness=1e4))))
    expected = sag(1.0) / (1.0 + 1e4 * flexibility(1.0, 1.0))
    assert rest.position[0] == pytest.approx(expected, abs=POSITION)


def test_without_gravity_nothing_moves():
    rest = rest_of(build_plant(rig_with(sleeve(0.5), sleeve(1.0), gravity=0.0)))
    assert not rest.position.any()
    assert not rest.contact_forces.any()


def test_a_cubic_spring_at_rest_solves_its_cubic():
    cubic = EFFECTS["cubic_stiffness"](Place(position=1.3), stiffness=1e9)
    rest = rest_of(build_plant(rig_with(), extra=[cubic]))
    q = rest.position[0]
    assert q == pytest.approx(sag(1.3) - flexibility(1.3, 1.3) * 1e9 * q**3, abs=POSITION)
    assert rest.law_forces[0] == pytest.approx(-1e9 * q**3)


def test_a_law_that_pushes_away_has_no_rest():
    def repulsion(t, q, v, z, p):
        return p[0] * (1.0 + q * q)

    pushed = replace(build_plant(rig_with()), laws=(PointLaw(Port(1.0), repulsion, (1e9,)),))
    with pytest.raises(InputError) as caught:
        rest_of(pushed)
    assert caught.value.given == "the state at rest: no equilibrium was found"
    assert "balance" in caught.value.expected
    assert "negative" in caught.value.mend


@pytest.mark.parametrize("q", [-4e-4, -1.6e-4, -1e-4, 0.0, 1e-4, 1.6e-4, 4e-4])
@pytest.mark.parametrize("v", [-5.0, 0.0, 5.0])
def test_a_contact_pushes_towards_the_centre_or_not_at_all(q, v):
    contact = build_plant(rig_with(sleeve(1.0))).contacts[0]
    force = contact_force(contact, q, v)
    assert force * q <= 0.0
    if abs(q) < contact.clearance:
        assert force == 0.0


@pytest.mark.parametrize(("q", "v"), [(1e-4, 0.0), (-1e-4, 0.0), (1e-4, -2.0), (0.0, 1.0)])
def test_without_clearance_it_also_pulls(q, v):
    contact = build_plant(rig_with(sleeve(1.0, clearance=0.0))).contacts[0]
    assert is_bilateral(contact)
    assert contact_force(contact, q, v) == pytest.approx(-1e5 * q - 80.0 * v)


def test_a_clearance_that_grows_is_a_clearance():
    contact = build_plant(rig_with(sleeve(1.0, clearance=0.0))).contacts[0]
    assert not is_bilateral(replace(contact, clearance_rate=1e-6))
