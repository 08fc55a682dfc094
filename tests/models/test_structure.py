"""What a rig file's structure is made of, and that a change leaves the old one alone."""

from dataclasses import replace
from math import inf, pi

import pytest
from model_scenes import REFERENCE

from models.rig import Oscillator
from models.structure import Absorber, Structure


def test_a_beam_has_the_section_of_a_solid_round_bar():
    beam = Structure.of(REFERENCE.structure)
    assert beam.bending_stiffness == pytest.approx(210e9 * pi * 0.02**4 / 64)
    assert beam.line_mass == pytest.approx(7850.0 * pi * 0.02**2 / 4)
    assert (beam.length, beam.rayleigh, beam.gravity) == (1.469, (1.2, 6e-6), 9.81)
    assert beam.is_beam
    assert beam.clamp_stiffness == inf


def test_an_oscillators_dashpot_is_damping_in_proportion_to_its_mass():
    oscillator = Structure.of(Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=0.6, gravity=9.81))
    assert not oscillator.is_beam
    assert (oscillator.line_mass, oscillator.bending_stiffness, oscillator.gravity) == (3.0, 1200.0, 9.81)
    assert oscillator.rayleigh == pytest.approx((0.2, 0.0))


@pytest.mark.parametrize(
    ("add", "held"), [("with_mass", "masses"), ("with_spring", "springs"), ("with_dashpot", "dashpots")]
)
def test_what_is_attached_is_added_to_a_new_structure(add, held):
    before = Structure.of(REFERENCE.structure)
    after = getattr(getattr(before, add)(0.5, 2.0), add)(0.7, 3.0)
    assert getattr(after, held) == ((0.5, 2.0), (0.7, 3.0))
    assert getattr(before, held) == ()


def test_an_absorber_on_a_fixed_base_has_its_frequency_and_damping():
    spring, dashpot = Absorber(0.5, mass=0.2, frequency=25.0, damping_ratio=0.03).coefficients
    assert spring / 0.2 == pytest.approx((2 * pi * 25.0) ** 2)
    assert dashpot == pytest.approx(2 * 0.03 * (spring * 0.2) ** 0.5)


def test_a_drifting_beam_is_at_any_time_one_that_stays():
    beam = Structure.of(REFERENCE.structure)
    drifting = replace(beam, stiffness_rate=-0.02)
    assert beam.at(3.0) == beam
    assert drifting.at(0.0) == beam
    assert drifting.at(3.0) == replace(beam, bending_stiffness=pytest.approx(0.94 * beam.bending_stiffness))
