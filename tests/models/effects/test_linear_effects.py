"""Effects on the linear structure: natural frequencies and damping against characteristic equations."""

from dataclasses import replace
from math import cos, cosh, sin, sinh, sqrt

import numpy as np
import pytest
from effect_scenes import BEAM, OSCILLATOR
from scipy.optimize import brentq

from models.effects import Place
from models.effects.clamp_compliance import ClampCompliance
from models.effects.modal_damping import ModalDamping
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.youngs_modulus import YoungsModulus
from models.modal import build_modal
from models.plant import build_plant
from models.rig import Rig
from models.structure import Structure

BARE = Rig(**{**dict(BEAM), "sleeves": ()})
STRUCTURE = Structure.of(BEAM.structure)
EI_OVER_L = STRUCTURE.bending_stiffness / STRUCTURE.length
MASS = STRUCTURE.line_mass * STRUCTURE.length
TIP = Place(position=STRUCTURE.length)
RITZ = 1e-6  # assumed shapes with the static shape of the place among them


def model(*effects, rig=BARE):
    return build_modal(build_plant(rig, extra=effects), band=400.0)


def first_root(characteristic):
    """The first natural circular frequency from f(lambda) = 0, lambda^2 = omega sqrt(rho A L^4 / E I)."""
    root = brentq(characteristic, 0.3, 3.0)
    return root**2 * sqrt(STRUCTURE.bending_stiffness / (STRUCTURE.line_mass * STRUCTURE.length**4))


def clamped_free(x):
    return 1.0 + cos(x) * cosh(x)


def tip_term(x):
    return sin(x) * cosh(x) - cos(x) * sinh(x)


@pytest.mark.parametrize("share", [0.01, 0.3, 2.0])
def test_a_mass_at_the_tip(share):
    expected = first_root(lambda x: clamped_free(x) - share * x * tip_term(x))
    assert model(PointMass(TIP, mass=share * MASS)).omega[0] == pytest.approx(expected, rel=RITZ)


def test_a_mass_weighs():
    sag = [build_modal(build_plant(BEAM, extra=e), 400.0).rest.position[0] for e in ((), (PointMass(TIP, mass=0.01),))]
    assert sag[1] < sag[0] < 0.0


@pytest.mark.parametrize("ratio", [0.01, 1.0, 10.0])
def test_a_spring_at_the_tip(ratio):
    expected = first_root(lambda x: clamped_free(x) + ratio / x**3 * tip_term(x))
    stiffness = ratio * EI_OVER_L / STRUCTURE.length**2
    assert model(PointStiffness(TIP, stiffness=stiffness)).omega[0] == pytest.approx(expected, rel=RITZ)


@pytest.mark.parametrize("ratio", [0.1, 1.0, 10.0, 1000.0])
def test_a_clamp_that_turns(ratio):
    expected = first_root(lambda x: ratio * clamped_free(x) - x * tip_term(x))
    clamp = ClampCompliance(Place(), rotational_stiffness=ratio * EI_OVER_L)
    assert model(clamp).omega[0] == pytest.approx(expected, rel=RITZ)


def test_a_clamp_that_turns_a_little_lowers_all_frequencies_by_the_same_share():
    """To first order 2 E I / (k L), from the bending energy that the clamp's moment stores in the spring."""
    before, after = model().omega[:4], model(ClampCompliance(Place(), rotational_stiffness=1e4 * EI_OVER_L)).omega[:4]
    np.testing.assert_allclose(1.0 - after / before, 2e-4, rtol=5e-3)  # second order, growing with the mode


def test_the_trials_of_a_clamp_are_as_far_off_as_they_say():
    shares = [
        1.0 - model(ClampCompliance(Place(), rotational_stiffness=ratio * EI_OVER_L)).omega[0] / model().omega[0]
        for ratio in (10.0, 100.0, 1000.0)
    ]
    np.testing.assert_allclose(shares, [0.16, 0.02, 0.002], rtol=0.05)  # one digit is all they promise


def test_frequencies_go_with_the_root_of_youngs_modulus_and_stiffness_damping_follows():
    before, after = model(), model(YoungsModulus(Place(), ratio=1.21))
    np.testing.assert_allclose(after.omega, 1.1 * before.omega, rtol=1e-9)
    eta1, eta2 = STRUCTURE.rayleigh
    np.testing.assert_allclose(np.diag(after.damping), eta1 + eta2 * after.omega**2, rtol=1e-9)


def test_modal_damping_multiplies_every_damping_ratio_and_moves_no_frequency():
    before, after = model(), model(ModalDamping(Place(), ratio=2.5))
    np.testing.assert_allclose(after.damping, 2.5 * before.damping, rtol=1e-12)
    np.testing.assert_array_equal(after.omega, before.omega)


@pytest.mark.parametrize("effect", [ModalDamping(Place(), ratio=1.5), YoungsModulus(Place(), ratio=1.5)])
def test_a_ratio_multiplies_what_the_rig_file_already_changed(effect):
    twice = replace(effect, ratio=1.5 * 1.5)
    assert effect.change_structure(effect.change_structure(STRUCTURE)) == twice.change_structure(STRUCTURE)


def test_modal_damping_is_not_the_dashpots():
    dashpot = PointDamping(TIP, damping=3.0)
    alone, scaled = model(dashpot), model(dashpot, ModalDamping(Place(), ratio=0.0))
    tip = alone.rows(STRUCTURE.length)
    np.testing.assert_allclose(scaled.damping, 3.0 * np.outer(tip, tip), rtol=1e-6, atol=1e-9 * np.ptp(tip) ** 2)


@pytest.mark.parametrize(
    ("effect", "mass", "stiffness", "damping"),
    [
        (PointMass(Place(), mass=1.0), 4.0, 1200.0, 0.7),
        (PointStiffness(Place(), stiffness=300.0), 3.0, 1500.0, 0.7),
        (PointDamping(Place(), damping=0.5), 3.0, 1200.0, 1.2),
        (ModalDamping(Place(), ratio=3.0), 3.0, 1200.0, 2.1),
    ],
    ids=lambda value: getattr(value, "kind", ""),
)
def test_on_an_oscillator(effect, mass, stiffness, damping):
    changed = model(effect, rig=OSCILLATOR)
    assert changed.omega[0] == pytest.approx(sqrt(stiffness / mass))
    assert changed.damping[0, 0] == pytest.approx(damping / mass)


@pytest.mark.parametrize(
    "effect",
    [
        PointMass(TIP, mass=0.0),
        PointStiffness(TIP, stiffness=0.0),
        PointDamping(TIP, damping=0.0),
        ClampCompliance(Place(), rotational_stiffness=1e12 * EI_OVER_L),
        ModalDamping(Place(), ratio=1.0),
        YoungsModulus(Place(), ratio=1.0),
    ],
    ids=lambda effect: effect.kind,
)
def test_the_limit_without_effect(effect):
    np.testing.assert_allclose(model(effect).omega[:8], model().omega[:8], rtol=1e-5)  # another set of assumed shapes


@pytest.mark.parametrize(
    "effect",
    [
        PointMass(TIP, mass=1.0),
        PointStiffness(TIP, stiffness=1e4),
        PointDamping(TIP, damping=10.0),
        ClampCompliance(Place(), rotational_stiffness=EI_OVER_L),
        ModalDamping(Place(), ratio=4.0),
        YoungsModulus(Place(), ratio=1.2),
    ],
    ids=lambda effect: effect.kind,
)
def test_the_structure_stays_passive(effect):
    changed = model(effect)
    assert changed.omega.min() > 0.0
    assert np.linalg.eigvalsh(changed.damping).min() > 0.0


def test_words_carry_the_shift_of_the_natural_frequencies():
    assert "+10 %" in YoungsModulus(Place(), ratio=1.21).in_words()
