"""Ritz matrices of a changed beam against characteristic equations, static deflections and the damping rule."""

from dataclasses import replace
from math import cos, cosh, inf, pi, sin, sinh, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from models.beam.assembly import assemble_beam, natural_modes, own_damping, solve_static
from models.beam.clamped_free import wave_numbers
from models.errors import InputError
from models.structure import Absorber, Hinge, Structure

EI, LINE_MASS, LENGTH = 1649.0, 2.466, 1.469
PLAIN = Structure(LENGTH, 0.02, EI, LINE_MASS, (1.2, 6e-6), 9.81)
RADIUS = sqrt(EI / (LINE_MASS * LENGTH**4))
N_MODES = 24
CONVERGED = 1e-8  # 24 modes and the static shape of the place that changed


def matrices(structure, *loads):
    return assemble_beam(structure, N_MODES, loads)


def omegas(structure, *loads):
    found = matrices(structure, *loads)
    return np.sqrt(natural_modes(found.stiffness, found.mass)[0])


def roots(characteristic, n, top=20.0):
    """The first n roots in beta L of a characteristic function without poles."""
    grid = np.linspace(0.05, top, 8000)
    value = np.array([characteristic(x) for x in grid])
    at = np.flatnonzero(np.sign(value[:-1]) != np.sign(value[1:]))[:n]
    return np.array([brentq(characteristic, grid[i], grid[i + 1], xtol=1e-14) for i in at])


def clamped_free(x):
    return 1.0 + cos(x) * cosh(x)


def tip_term(x):
    return sin(x) * cosh(x) - cos(x) * sinh(x)


def deflection(x, a):
    """Of the cantilever at x under a unit force at a."""
    near, far = min(x, a), max(x, a)
    return near**2 * (3.0 * far - near) / (6.0 * EI)


def test_the_plain_beam_has_the_frequencies_of_the_tables():
    np.testing.assert_allclose(omegas(PLAIN)[:8], wave_numbers(8) ** 2 * RADIUS, rtol=1e-12)


@pytest.mark.parametrize("ratio", [0.1, 10.0, 1e4])
def test_a_clamp_that_turns_has_the_frequencies_of_its_equation(ratio):
    expected = roots(lambda x: (ratio * clamped_free(x) - x * tip_term(x)) / cosh(x), 4) ** 2 * RADIUS
    found = omegas(replace(PLAIN, clamp_stiffness=ratio * EI / LENGTH))[:4]
    np.testing.assert_allclose(found, expected, rtol=1e-7)  # a turning clamp is no load, so it has no static shape


@pytest.mark.parametrize("power", [5, 7, 8, 10, 12, 15, 20])
def test_a_stiff_clamp_goes_smoothly_to_the_built_in_end(power):
    """All frequencies fall by 2 E I / (k L), from the bending energy that the clamp's moment stores in the spring."""
    loads = (0.45, 1.0, 1.3)
    built_in = omegas(PLAIN, *loads)[:8]
    found = omegas(replace(PLAIN, clamp_stiffness=10.0**power * EI / LENGTH), *loads)[:8]
    np.testing.assert_allclose(1.0 - found / built_in, 2.0 * 10.0**-power, rtol=0.01, atol=1e-12)


@pytest.mark.parametrize("power", [6, 9, 12])
def test_a_stiff_spring_at_the_tip_goes_to_the_support(power):
    supported = roots(lambda x: tip_term(x) / cosh(x), 4) ** 2 * RADIUS  # tan x = tanh x
    found = omegas(PLAIN.with_spring(LENGTH, 10.0**power * EI / LENGTH**3))[:4]
    np.testing.assert_allclose(found, supported, rtol=3e-6 + 400.0 / 10.0**power)  # (beta L)^3 / k, and Ritz


def test_a_heavy_tip_stands_still_above_its_own_frequency():
    found = omegas(PLAIN.with_mass(LENGTH, 1e6 * LINE_MASS * LENGTH))
    supported = roots(lambda x: tip_term(x) / cosh(x), 3) ** 2 * RADIUS
    assert found[0] == pytest.approx(sqrt(3.0 * EI / LENGTH**3 / (1e6 * LINE_MASS * LENGTH)), rel=1e-6)
    np.testing.assert_allclose(found[1:4], supported, rtol=1e-5)


def axial_roots(force, n):
    """Exact circular frequencies under an axial force: EI w'''' - F w'' = rho A omega^2 w with a free end."""

    def characteristic(omega):
        half = force / (2.0 * EI)
        root = sqrt(half**2 + LINE_MASS * omega**2 / EI)
        a, b = sqrt(half + root), sqrt(root - half)
        ca, sa, cb, sb = cosh(a * LENGTH), sinh(a * LENGTH), cos(b * LENGTH), sin(b * LENGTH)
        moment = [a * a * ca + b * b * cb, a * a * sa + a * b * sb]
        shear = [
            EI * (a**3 * sa - b**3 * sb) - force * (a * sa + b * sb),
            EI * (a**3 * ca + a * b * b * cb) - force * (a * ca - a * cb),
        ]
        return (moment[0] * shear[1] - moment[1] * shear[0]) / ca**2

    grid = np.linspace(0.3, 400.0, 20000)
    value = np.array([characteristic(x) for x in grid])
    at = np.flatnonzero(np.sign(value[:-1]) != np.sign(value[1:]))[:n]
    return np.array([brentq(characteristic, grid[i], grid[i + 1]) for i in at])


@pytest.mark.parametrize("force", [-1500.0, -300.0, 300.0, 3000.0])
def test_an_axial_force_shifts_the_frequencies_as_its_equation_says(force):
    found = omegas(replace(PLAIN, axial_force=force))[:2]
    np.testing.assert_allclose(found, axial_roots(force, 2), rtol=1e-5)  # 24 modes; magnified near buckling


def test_the_first_frequency_vanishes_at_the_buckling_load():
    critical = pi**2 * EI / (4.0 * LENGTH**2)
    near, nearer = (omegas(replace(PLAIN, axial_force=-(1.0 - gap) * critical))[0] ** 2 for gap in (0.02, 0.01))
    assert near - 2.0 * nearer == pytest.approx(0.0, abs=2e-3 * near)  # omega^2 goes straight to 0


def test_beyond_the_buckling_load_the_beam_is_refused():
    buckled = replace(PLAIN, axial_force=-1.01 * pi**2 * EI / (4.0 * LENGTH**2))
    with pytest.raises(InputError) as caught:
        omegas(buckled)
    assert caught.value.given == "the beam without its sleeves: its stiffness is not positive"
    assert "compression stays below pi^2 E I / (2 L)^2" in caught.value.expected
    assert "axial_load" in caught.value.mend
    found = matrices(buckled)
    with pytest.raises(InputError):
        solve_static(found.stiffness, found.weight)


def test_a_long_pull_makes_a_string_of_the_beam():
    """Clamped-free string with a boundary layer sqrt(E I / F) at the clamp, which shortens it."""
    force = 1e4 * EI / LENGTH**2
    string = (np.arange(3) + 0.5) * pi / LENGTH * sqrt(force / LINE_MASS)
    np.testing.assert_allclose(
        omegas(replace(PLAIN, axial_force=force))[:3], string * (1.0 + 0.01), rtol=5e-3
    )  # next order of 1e-2


def test_a_hinge_beside_the_clamp_is_a_clamp_that_turns():
    flexibility = 0.1 * LENGTH / EI
    hinged = omegas(replace(PLAIN, hinges=(Hinge(1e-9, flexibility),)))[:5]
    turning = omegas(replace(PLAIN, clamp_stiffness=1.0 / flexibility))[:5]
    np.testing.assert_allclose(hinged, turning, rtol=1e-7)


@pytest.mark.parametrize("flexibility", [0.0, 1e-12, 1e-6, 1e-4])
def test_a_hinge_adds_the_deflection_of_a_kink(flexibility):
    place, tip = 0.4, LENGTH
    found = matrices(replace(PLAIN, hinges=(Hinge(place, flexibility),)), tip)
    row = found.row(tip)
    expected = deflection(tip, tip) + flexibility * (tip - place) ** 2
    assert row @ solve_static(found.stiffness, row) == pytest.approx(expected, rel=1e-10)


def test_the_beam_sags_under_its_own_weight():
    found = matrices(PLAIN, LENGTH)
    sag = found.row(LENGTH) @ solve_static(found.stiffness, found.weight)
    assert sag == pytest.approx(-LINE_MASS * 9.81 * LENGTH**4 / (8.0 * EI), rel=1e-11)


def test_masses_and_absorbers_weigh_where_they_hang():
    hung = PLAIN.with_mass(1.0, 0.5)
    hung = replace(hung, absorbers=(Absorber(0.7, 0.2, 30.0, 0.05),))
    found = matrices(hung, LENGTH)
    sag = found.row(LENGTH) @ solve_static(found.stiffness, found.weight)
    own = LINE_MASS * LENGTH**4 / (8.0 * EI)
    expected = -9.81 * (own + 0.5 * deflection(LENGTH, 1.0) + 0.2 * deflection(LENGTH, 0.7))
    assert sag == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("freq", [8.0, 40.0])
def test_an_absorber_at_the_tip_is_a_mass_that_depends_on_the_frequency(freq):
    share, tuned = 0.1, 2.0 * pi * freq / RADIUS

    def characteristic(x):
        return (clamped_free(x) * (1.0 - (x**2 / tuned) ** 2) - share * x * tip_term(x)) / cosh(x)

    absorber = Absorber(LENGTH, share * LINE_MASS * LENGTH, freq, 0.0)
    found = omegas(replace(PLAIN, absorbers=(absorber,)))[:5]
    np.testing.assert_allclose(found, roots(characteristic, 5) ** 2 * RADIUS, rtol=CONVERGED)


def test_rayleigh_damping_follows_the_beam_but_not_what_is_fastened_to_it():
    own = replace(PLAIN.with_mass(1.2, 0.4), axial_force=200.0, hinges=(Hinge(0.5, 1e-5),), clamp_stiffness=1e5)
    fastened = replace(own.with_spring(0.9, 3e4), absorbers=(Absorber(0.6, 0.2, 25.0, 0.03),))
    same_shapes = (0.6, 0.9)
    bare, full = matrices(own, *same_shapes), matrices(fastened, *same_shapes)
    n = len(bare.weight)
    np.testing.assert_allclose(bare.damping, 1.2 * bare.mass + 6e-6 * bare.stiffness, rtol=1e-12, atol=1e-9)
    beam_part = full.damping - _absorber_damping(full, fastened.absorbers[0])
    np.testing.assert_allclose(beam_part[:n, :n], bare.damping, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(beam_part[n:], 0.0, atol=1e-12)


def _absorber_damping(found, absorber):
    stretch = -found.row(absorber.position)
    stretch[-1] = 1.0
    return 2.0 * absorber.damping_ratio * 2.0 * pi * absorber.frequency * absorber.mass * np.outer(stretch, stretch)


def test_a_dashpot_adds_its_outer_product():
    found, bare = matrices(PLAIN.with_dashpot(0.8, 25.0)), matrices(PLAIN, 0.8)
    row = bare.row(0.8)
    np.testing.assert_allclose(found.damping - bare.damping, 25.0 * np.outer(row, row), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("scale", [1.0, 2.5])
def test_a_loss_factor_gives_every_mode_half_of_it(scale):
    lossy = replace(PLAIN.with_mass(1.3, 0.7), loss_factor=0.02, damping_scale=scale)
    found = matrices(lossy)
    square, phi = natural_modes(found.stiffness, found.mass)
    ratio = np.diag(phi.T @ found.damping @ phi)[:10] / (2.0 * np.sqrt(square[:10]))
    np.testing.assert_allclose(ratio, 0.01 * scale, rtol=1e-6)


def test_damping_of_the_structure_scales():
    mass, stiffness = np.diag([2.0, 3.0]), np.diag([8.0, 27.0])
    twice = own_damping(replace(PLAIN, damping_scale=2.0), mass, stiffness)
    np.testing.assert_allclose(twice, 2.0 * own_damping(PLAIN, mass, stiffness))


def test_modes_are_mass_normalised_and_decouple_the_stiffness():
    found = matrices(PLAIN.with_mass(1.2, 0.4).with_spring(0.7, 1e5))
    square, phi = natural_modes(found.stiffness, found.mass)
    n = 20  # beyond them lie shapes that only the static deflections need
    np.testing.assert_allclose((phi.T @ found.mass @ phi)[:n, :n], np.eye(n), atol=1e-6)
    np.testing.assert_allclose((phi.T @ found.stiffness @ phi)[:n, :n] / square[:n], np.eye(n), atol=1e-6)


def test_the_inertia_carried_is_the_mass_moment_of_a_rigid_translation():
    structure = PLAIN.with_mass(1.2, 0.4)
    found = matrices(structure)
    effective = found.carried @ np.linalg.solve(found.mass, found.carried)
    assert effective == pytest.approx(LINE_MASS * LENGTH + 0.4, rel=0.01)  # 24 modes hold 99.6 % of a translation
    np.testing.assert_allclose(found.weight, -9.81 * found.carried)


def test_a_clamp_without_spring_is_no_clamp():
    with pytest.raises(InputError, match="not positive"):
        omegas(replace(PLAIN, clamp_stiffness=0.0))
    assert omegas(replace(PLAIN, clamp_stiffness=inf))[0] > 0.0
