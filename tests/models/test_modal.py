"""The reduced model: exact flexibility where forces act, textbook systems, and what is kept between calls."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from model_scenes import EI, LENGTH, MASS, RADIUS, REFERENCE, STRUCTURE, rig_with, sleeve

from models.beam.clamped_free import wave_numbers
from models.effects import EFFECTS, Place
from models.errors import InputError
from models.modal import MIN_MODES, build_modal, modes_below
from models.plant import build_plant
from models.ports import Port
from models.rig import Excitation, Oscillator, Rig
from models.structure import Absorber, Structure

BAND = 880.0
OSCILLATOR = Rig(
    structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=0.6, gravity=9.81),
    excitation=Excitation(),
)


def flexibility(x, a):
    near, far = min(x, a), max(x, a)
    return near**2 * (3.0 * far - near) / (6.0 * EI)


def oscillator(**changes):
    plant = build_plant(OSCILLATOR)
    return build_modal(replace(plant, structure=replace(plant.structure, **changes)), BAND)


@pytest.mark.parametrize("n_modes", [1, 4, 8, 20])
def test_the_static_flexibility_between_ports_is_exact_however_few_the_modes(n_modes):
    model = build_modal(build_plant(REFERENCE), BAND, n_modes)
    places = [0.45, 1.0, 1.3]
    rows = np.stack([model.rows(x) for x in places])
    expected = np.array([[flexibility(x, a) for a in places] for x in places])
    np.testing.assert_allclose((rows / model.omega**2) @ rows.T, expected, rtol=1e-8)  # residuals are 1e-5 of the whole


def test_plain_truncation_is_too_stiff_by_what_the_higher_modes_hold():
    model = build_modal(build_plant(REFERENCE), BAND, 8)
    row = model.rows(0.45)[:8]
    missing = 1.0 - np.sum((row / model.omega[:8]) ** 2) / flexibility(0.45, 0.45)
    assert 1e-4 < missing < 1e-2


def test_the_dynamic_modes_are_the_beams_whatever_is_appended():
    model = build_modal(build_plant(REFERENCE), BAND, 8)
    np.testing.assert_allclose(model.omega[:8], wave_numbers(8) ** 2 * RADIUS, rtol=1e-9)
    assert model.n == 8 + 3
    assert model.omega[8:].min() > model.omega[7]


@pytest.mark.parametrize("n_modes", [4, 12, 48])
@pytest.mark.parametrize("extra", [(), (EFFECTS["point_mass"](Place(position=0.7), 0.4),)], ids=["bare", "loaded"])
def test_every_mode_bends_upwards_at_the_clamp(n_modes, extra):
    """So that a state of some modes is the same in another number of them and beside an effect."""
    for length in (0.95, 1.2, LENGTH):
        rig = REFERENCE.model_copy(
            update={
                "structure": REFERENCE.structure.model_copy(update={"length": length}),
                "sleeves": (),
                "sensors": (),
            }
        )
        drive = Excitation(quantity="force", position=0.8)
        model = build_modal(build_plant(rig.model_copy(update={"excitation": drive}), extra), 500.0, n_modes)
        assert np.all(model.rows(0.0, 2)[:n_modes] > 0.0)


def test_rayleigh_damping_stays_diagonal_and_a_dashpot_couples():
    model = build_modal(build_plant(REFERENCE), BAND)
    np.testing.assert_allclose(np.diag(model.damping), 1.2 + 6e-6 * model.omega**2, rtol=1e-6)
    assert np.count_nonzero(model.damping - np.diag(np.diag(model.damping))) == 0
    dashpot = EFFECTS["point_damping"](Place(position=1.2), damping=5.0)
    with_dashpot = build_modal(build_plant(REFERENCE, extra=[dashpot]), BAND)
    row = with_dashpot.rows(1.2)
    added = with_dashpot.damping - np.diag(1.2 + 6e-6 * with_dashpot.omega**2)
    np.testing.assert_allclose(added, 5.0 * np.outer(row, row), atol=1e-6 * 5.0 * row @ row)


@pytest.mark.parametrize("freq", [100.0, 800.0, 3000.0])
def test_as_many_modes_as_lie_below_a_frequency(freq):
    n = modes_below(STRUCTURE, freq)
    natural = wave_numbers(60) ** 2 * RADIUS / (2.0 * pi)
    assert n == max(MIN_MODES, int(np.sum(natural < freq)))


def test_ports_come_once_laws_first():
    film = EFFECTS["squeeze_film"](Place(sleeve="at 1.0", position=1.0), damping=5.0)
    friction = EFFECTS["coulomb_friction"](Place(position=0.8), 1.0, 1e-3, "ground")
    plant = build_plant(rig_with(sleeve(0.5), sleeve(1.0)), extra=[friction, film])
    model = build_modal(plant, BAND)
    assert model.ports == (Port(0.8, frame="ground"), Port(1.0), Port(0.5))
    np.testing.assert_array_equal(model.port_rows[1], model.rows(1.0))


def test_the_shape_of_a_slope_is_the_slope_of_the_shape():
    model, h = build_modal(build_plant(REFERENCE), BAND), 3e-5
    slope = (model.rows(0.7 + h) - model.rows(0.7 - h)) / (2.0 * h)
    np.testing.assert_allclose(model.rows(0.7, 1), slope, rtol=1e-6, atol=1e-5 * np.abs(slope).max())


def test_the_mass_carried_by_the_modes_is_the_beams():
    model = build_modal(build_plant(rig_with(sleeve(1.0))), BAND, 40)
    assert np.sum(model.carried**2) == pytest.approx(MASS, rel=0.02)  # 40 clamped modes hold 99 % of a translation


def test_the_linear_beam_is_kept_while_only_contacts_change():
    one = build_modal(build_plant(rig_with(sleeve(1.0))), BAND)
    other = build_modal(build_plant(rig_with(sleeve(1.0, 3e-4, stiffness=2e5))), BAND)
    assert one.omega is other.omega
    assert one.rest.position[0] != other.rest.position[0]
    assert build_modal(build_plant(rig_with(sleeve(1.0), youngs_modulus=2e11)), BAND).omega is not one.omega


def test_an_oscillator_is_its_own_mode():
    model = oscillator()
    assert model.omega == pytest.approx([20.0])
    assert model.damping == pytest.approx(np.array([[0.2]]))
    assert model.rows(None) == pytest.approx([3.0**-0.5])
    assert model.carried == pytest.approx([3.0**0.5])


def test_an_oscillator_with_a_loss_factor_has_half_of_it_for_damping_ratio():
    model = oscillator(loss_factor=0.04, damping_scale=1.5, masses=((None, 1.0),))
    assert model.omega[0] == pytest.approx((1200.0 / 4.0) ** 0.5)
    assert model.damping[0, 0] / (2.0 * model.omega[0]) == pytest.approx(0.03)


@pytest.mark.parametrize("freq", [1.0, 20.0 / (2.0 * pi), 9.0])
def test_an_absorber_on_an_oscillator_makes_two_degrees_of_freedom(freq):
    """Den Hartog: the roots of (1 - g^2)(f^2 - g^2) = mu f^2 g^2."""
    mu, f = 0.1, freq * 2.0 * pi / 20.0
    model = oscillator(absorbers=(Absorber(None, 0.3, freq, 0.0),))
    expected = np.sort(np.roots([1.0, -(1.0 + f**2 + mu * f**2), f**2]).real) ** 0.5 * 20.0
    np.testing.assert_allclose(model.omega, expected, rtol=1e-12)
    assert np.sum(model.carried**2) == pytest.approx(3.3)
    assert np.sum(model.rows(None) ** 2) == pytest.approx(1.0 / 3.0)


def test_an_absorber_damps_the_stretch_between_the_masses():
    model = oscillator(absorbers=(Absorber(None, 0.3, 3.0, 0.05),))
    omega = 2.0 * pi * 3.0
    damping = np.array([[0.6, 0.0], [0.0, 0.0]]) + 2.0 * 0.05 * omega * 0.3 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    inertia, held = np.diag([3.0, 0.3]), 0.3 * omega**2
    system = np.block([
        [np.zeros((2, 2)), np.eye(2)],
        [-np.linalg.solve(inertia, [[1200.0 + held, -held], [-held, held]]), -np.linalg.solve(inertia, damping)],
    ])  # fmt: skip
    modal = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(model.omega**2), -model.damping]])
    np.testing.assert_allclose(
        np.sort_complex(np.linalg.eigvals(modal)), np.sort_complex(np.linalg.eigvals(system)), rtol=1e-10
    )


def test_an_oscillator_sags_under_all_that_hangs_on_it():
    friction = EFFECTS["coulomb_friction"](Place(), 1.0, 1e-3)
    plant = build_plant(OSCILLATOR, extra=[friction])
    structure = replace(plant.structure, absorbers=(Absorber(None, 0.3, 3.0, 0.05),))
    rest = build_modal(replace(plant, structure=structure), BAND).rest
    assert rest.position[0] == pytest.approx(-3.3 * 9.81 / 1200.0)


def test_reciprocity_of_the_receptance():
    model = build_modal(build_plant(REFERENCE), BAND)
    s = 2j * pi * 61.0
    dynamic = np.linalg.inv(s**2 * np.eye(model.n) + s * model.damping + np.diag(model.omega**2))
    here, there = model.rows(0.45), model.rows(LENGTH)
    assert here @ dynamic @ there == pytest.approx(there @ dynamic @ here, rel=1e-12)


def test_a_length_in_millimetres_is_refused_before_it_eats_the_machine():
    beam = REFERENCE.structure.model_copy(update={"length": 1469.0})

    with pytest.raises(InputError, match=r"length = 1469 m.*keeps 100 at most.*in m, Pa"):
        modes_below(Structure.of(beam), 500.0)


def test_the_shape_at_rest_passes_through_the_ports_and_sags_like_a_cantilever():
    model = build_modal(build_plant(REFERENCE), BAND)
    places = np.array([port.position for port in model.ports])
    assert model.rest_deflection(places) == pytest.approx(model.rest.position, abs=1e-10)
    free = build_modal(replace(build_plant(REFERENCE), contacts=(), laws=()), BAND)
    beam = free.plant.structure
    sag = -beam.line_mass * beam.gravity * beam.length**4 / (8.0 * beam.bending_stiffness)
    assert free.rest_deflection(np.array([0.0, beam.length])) == pytest.approx([0.0, sag], abs=1e-9 * abs(sag))
