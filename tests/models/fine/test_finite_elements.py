from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from scipy.linalg import eigh

from models.beam.clamped_free import wave_numbers
from models.errors import InputError
from models.fine.finite_elements import assemble
from models.fine.mesh import SHORTEST, place_nodes
from models.fine.system import build_system
from models.plant import Plant
from models.structure import Absorber, Hinge, Structure

BEAM = Structure(
    length=1.469, diameter=0.02, bending_stiffness=1649.3, line_mass=2.466, rayleigh=(1.2, 6e-6), gravity=9.81
)


def plant_of(structure):
    return Plant(structure, (), (), None, (), ())


def omegas(structure, n_elements=40):
    return build_system(plant_of(structure), n_elements).omega


def exact_omegas(n, roots=None):
    roots = wave_numbers(n) if roots is None else roots
    return (roots / BEAM.length) ** 2 * sqrt(BEAM.bending_stiffness / BEAM.line_mass)


def tip_stiffness():
    return 3.0 * BEAM.bending_stiffness / BEAM.length**3


def test_the_first_four_frequencies_of_a_clamped_free_beam():
    # The cubic elements' own error is (beta h)^4 / 1440, 4e-6 for mode 4 on 40 elements.
    np.testing.assert_allclose(omegas(BEAM)[:4], exact_omegas(4), rtol=5e-6)


def test_the_frequencies_converge_with_the_fourth_power_of_the_element():
    errors = [omegas(BEAM, n)[3] / exact_omegas(4)[3] - 1.0 for n in (16, 32)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


def test_the_mesh_has_nodes_on_named_places_and_no_needlessly_short_elements():
    nodes = place_nodes(1.469, [0.45, 1.0, 0.4501, 1.469], 40)
    assert set(nodes) >= {0.0, 0.45, 1.0, 1.469}
    assert 0.4501 not in nodes
    assert np.diff(nodes).min() / 1.469 >= SHORTEST / 40
    assert np.diff(nodes).max() / 1.469 <= 1.0000001 / 40


def test_a_heavy_mass_at_the_tip_sits_on_a_massless_spring():
    mass = 50.0 * BEAM.line_mass * BEAM.length
    heavy = omegas(BEAM.with_mass(BEAM.length, mass))[0]
    moving = mass + 33.0 / 140.0 * BEAM.line_mass * BEAM.length  # Rayleigh's share of the beam, exact to 1e-5 here
    assert heavy == pytest.approx(sqrt(tip_stiffness() / moving), rel=2e-5)


def test_a_stiff_spring_at_the_tip_is_a_pin():
    system = build_system(plant_of(BEAM.with_spring(BEAM.length, 1e11)), 40)
    row = system.row(BEAM.length)
    omega = np.sqrt(eigh(np.diag(system.omega**2) + 1e11 * np.outer(row, row), eigvals_only=True))
    pinned = exact_omegas(3, np.array([3.926602, 7.068583, 10.210176]))  # roots of tan b = tanh b
    np.testing.assert_allclose(omega[:3], pinned, rtol=1e-5)


def test_a_soft_clamp_makes_a_rigid_pendulum_and_a_stiff_one_a_clamp():
    soft = 1e-4 * BEAM.bending_stiffness / BEAM.length
    inertia = BEAM.line_mass * BEAM.length**3 / 3.0
    assert omegas(replace(BEAM, clamp_stiffness=soft))[0] == pytest.approx(sqrt(soft / inertia), rel=1e-4)
    stiff = 1e7 * BEAM.bending_stiffness / BEAM.length
    np.testing.assert_allclose(omegas(replace(BEAM, clamp_stiffness=stiff))[:4], omegas(BEAM)[:4], rtol=1e-6)


def test_compression_softens_to_nothing_at_eulers_load_and_more_is_refused():
    critical = pi**2 * BEAM.bending_stiffness / (4.0 * BEAM.length**2)
    almost = omegas(replace(BEAM, axial_force=-0.9999 * critical))[0]
    assert almost / omegas(BEAM)[0] < 0.011  # the square falls linearly, and is not 0 only by 1e-4
    assert omegas(replace(BEAM, axial_force=critical))[0] > omegas(BEAM)[0]
    with pytest.raises(InputError, match=r"axial_load: force = -\d+\.?\d* N; .*buckling load; take a smaller"):
        omegas(replace(BEAM, axial_force=-1.01 * critical))


@pytest.mark.parametrize("position", [0.4, 0.7345])
def test_a_hinge_adds_its_rotation_to_the_deflection_under_a_load(position):
    hinge = Hinge(position, 2e-4)
    elements = assemble(replace(BEAM, hinges=(hinge,)), place_nodes(BEAM.length, [position], 40))
    tip = elements.row(BEAM.length)
    arm = BEAM.length - position
    deflection = tip @ np.linalg.solve(elements.stiffness, tip)
    assert deflection == pytest.approx(1.0 / tip_stiffness() + arm**2 * hinge.flexibility, rel=1e-9)


def test_the_sag_under_gravity_is_that_of_the_closed_form():
    system = build_system(plant_of(BEAM), 40)
    x = np.array([0.3, 0.9, BEAM.length])
    load, length = BEAM.line_mass * BEAM.gravity, BEAM.length
    exact = -load * x**2 * (6 * length**2 - 4 * length * x + x**2) / (24 * BEAM.bending_stiffness)
    sag = np.array([system.row(place) @ system.rest for place in x])
    np.testing.assert_allclose(sag, exact, rtol=1e-6)  # exact on nodes, h^4 between


def test_a_spring_at_the_tip_shares_the_weight():
    stiffness = 2.0 * tip_stiffness()
    free = -BEAM.line_mass * BEAM.gravity * BEAM.length**4 / (8 * BEAM.bending_stiffness)
    system = build_system(plant_of(BEAM.with_spring(BEAM.length, stiffness)), 40)
    assert system.row(BEAM.length) @ system.rest == pytest.approx(free / 3.0, rel=1e-9)


def test_an_absorber_hangs_on_the_beam_with_its_weight():
    absorber = Absorber(BEAM.length, 0.5, 12.0, 0.02)
    system = build_system(plant_of(replace(BEAM, absorbers=(absorber,))), 40)
    free = BEAM.line_mass * BEAM.gravity * BEAM.length**4 / (8 * BEAM.bending_stiffness)
    tip, own = system.row(BEAM.length) @ system.rest, system.rest[-1] / sqrt(absorber.mass)
    assert tip == pytest.approx(-free - absorber.mass * BEAM.gravity / tip_stiffness(), rel=1e-9)
    assert own - tip == pytest.approx(-BEAM.gravity / (2 * pi * absorber.frequency) ** 2, rel=1e-9)


def test_damping_of_the_modes():
    omega = omegas(BEAM)
    elements = build_system(plant_of(BEAM), 40).elements
    np.testing.assert_allclose(elements.damping(), 1.2 + 6e-6 * omega**2)
    scaled = replace(elements, structure=replace(BEAM, damping_scale=3.0))
    np.testing.assert_allclose(scaled.damping(), 3.0 * elements.damping())
    loss = replace(elements, structure=replace(BEAM, loss_factor=0.004))
    np.testing.assert_allclose(loss.damping() / (2 * omega), 0.002)


def test_modes_are_orthonormal_and_all_there():
    elements = assemble(BEAM, place_nodes(BEAM.length, [], 40))
    omega, shapes = elements.modes
    assert len(omega) == 80
    np.testing.assert_allclose(shapes.T @ elements.mass @ shapes, np.eye(80), atol=1e-6)


def test_slope_and_curvature_follow_the_deflection():
    system = build_system(plant_of(BEAM), 40)
    tip_load = system.row(BEAM.length) / system.omega**2  # coordinates under 1 N at the tip
    x, length, ei = 0.6, BEAM.length, BEAM.bending_stiffness
    assert system.row(x, 1) @ tip_load == pytest.approx(x * (2 * length - x) / (2 * ei), rel=1e-9)
    assert system.row(x, 2) @ tip_load == pytest.approx((length - x) / ei, rel=1e-9)


def test_the_base_carries_the_whole_mass():
    loaded = BEAM.with_mass(0.9, 0.7)
    system = build_system(plant_of(loaded), 80)
    whole = BEAM.line_mass * BEAM.length + 0.7
    # What the clamped half element keeps: about 13/35 of an element's mass, less what its slope takes up.
    assert system.carried @ system.carried == pytest.approx(whole, rel=0.01)
    assert system.carried @ system.carried < whole
