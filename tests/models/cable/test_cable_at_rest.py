from dataclasses import replace

import numpy as np
import pytest
from cable_scenes import EI, LENGTH, LINE_MASS, REFERENCE, bare_beam, still_cable

from models.beam.clamped_free import wave_numbers
from models.cable.accounts import stored_energy
from models.cable.moving import natural_freqs, settle
from models.effects import EFFECTS, build_effect
from models.errors import InputError
from models.modal import build_modal
from models.plant import build_plant
from models.ports import PointLaw, Port
from models.rig import EffectEntry


def test_natural_frequencies_of_the_free_beam_converge_with_fourth_order():
    expected = wave_numbers(4) ** 2 * np.sqrt(EI / (LINE_MASS * LENGTH**4)) / (2.0 * np.pi)
    errors = []
    for n in (16, 32):
        cable = still_cable(build_plant(bare_beam(0.0)), n)
        settle(cable)
        errors.append(natural_freqs(cable, 4) / expected - 1.0)
    assert np.all(errors[1] > 0.0)  # consistent masses make a beam stiffer
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 4.0, atol=0.3)
    assert errors[0][3] < 2e-4


def test_the_beam_sags_as_beam_theory_says():
    """Under a hundredth of gravity; what is left is that the beam turns, by 1e-4 of its length."""
    cable = still_cable(build_plant(bare_beam(0.0981)), 12)
    tip = cable.row(LENGTH) @ settle(cable)
    assert tip == pytest.approx(-LINE_MASS * 0.0981 * LENGTH**4 / (8.0 * EI), rel=1e-7)


def test_it_rests_on_its_sleeves_where_the_modal_model_does():
    plant = build_plant(REFERENCE)
    cable = still_cable(plant, 12)
    found, expected = cable.port_rows @ settle(cable), build_modal(plant, 900.0, 30).rest.position
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-10)


def test_a_second_search_stays_where_the_first_one_ended():
    cable = still_cable(build_plant(REFERENCE), 24)
    first, second = settle(cable), settle(cable)
    np.testing.assert_allclose(cable.port_rows @ second, cable.port_rows @ first, rtol=0.0, atol=1e-10)


def test_a_static_force_stores_half_its_work():
    plant = build_plant(bare_beam(0.0))
    cable = still_cable(plant, 12, held_at=1.1)
    cable.course.held = 0.5
    q = settle(cable)
    assert cable.row(1.1) @ q == pytest.approx(0.5 * 1.1**3 / (3.0 * EI), rel=1e-6)
    energy = stored_energy(cable, q[None], np.zeros((1, len(q))))[0]
    assert energy == pytest.approx(0.5 * 0.5 * (cable.row(1.1) @ q), rel=1e-5)


def test_no_state_at_rest_is_one_error_in_three_parts():
    law = PointLaw(Port(1.2), lambda *motion: float("nan"), ())
    cable = still_cable(replace(build_plant(REFERENCE), laws=(law,)), 12)
    with pytest.raises(
        InputError, match=r"exudyn at rest: no equilibrium was found; the beam rests where .*; look for"
    ):
        settle(cable)


def test_masses_and_inertia_are_those_of_the_whole_beam():
    entry = EffectEntry(kind="point_mass", position=0.77, mass=0.4)
    cable = still_cable(build_plant(REFERENCE, [build_effect(entry, REFERENCE, EFFECTS)]), 7)
    up = np.tile([0.0, 1.0, 0.0, 0.0], len(cable.nodes))
    assert up @ cable.carried == pytest.approx(LINE_MASS * LENGTH + 0.4, rel=1e-12)
    turn = np.concatenate([[0.0, x, 0.0, 1.0] for x in cable.nodes])
    assert turn @ cable.mass @ turn == pytest.approx(LINE_MASS * LENGTH**3 / 3.0 + 0.4 * 0.77**2, rel=1e-12)
