"""Poles over dampings: a mass in closed form, the beam against differences, and what is refused."""

import numpy as np
import pytest
from sleeve_scenes import BAND, DASHPOT, MASS, SPRING, omega, ratio_of, reference, stopped_mass

from identification.decay.sleeve_poles import Dashpots, nearest_modes, ratio_slopes, ratios_of
from models.errors import InputError
from models.linear import natural_modes

TANGENT = 1e-8  # a tangent by differences of 2e-9 m in a force of some N


def test_a_mass_has_its_closed_form():
    dashpots = Dashpots.of(stopped_mass(), ("stop",))
    assert dashpots.own[0] == pytest.approx(DASHPOT, rel=TANGENT)
    assert dashpots.springs[0] == pytest.approx(SPRING, rel=TANGENT)
    for damping in (0.0, 4.0, 60.0):
        poles, slopes = dashpots.poles(np.array([damping]))
        ratio = ratio_of(damping)
        np.testing.assert_allclose(poles, omega() * (1j * np.sqrt(1.0 - ratio**2) - ratio), rtol=TANGENT)
        np.testing.assert_allclose(ratios_of(poles), ratio, rtol=TANGENT)
        np.testing.assert_allclose(ratio_slopes(poles, slopes[:, 0]), 0.5 / (MASS * omega()), rtol=TANGENT)


def test_a_mass_that_creeps_has_no_mode():
    poles, slopes = Dashpots.of(stopped_mass(), ("stop",)).poles(np.array([2.0 * MASS * omega()]))
    assert poles.shape == (0,)
    assert slopes.shape == (0, 1)


def test_the_rigs_own_dampings_give_its_own_modes():
    linear = reference(closed=True)
    dashpots = Dashpots.of(linear, ("sleeve 1", "sleeve 2"))
    poles, _ = dashpots.poles(dashpots.own)
    modes = natural_modes(linear, (), BAND)
    n = len(modes.natural_freqs)
    np.testing.assert_allclose(np.abs(poles[:n]) / (2.0 * np.pi), modes.natural_freqs, rtol=1e-10)  # two eigenproblems
    np.testing.assert_allclose(ratios_of(poles[:n]), modes.damping_ratios, rtol=1e-9)


@pytest.mark.parametrize("damping", [3.0, 80.0, 400.0])
def test_slopes_are_those_of_differences(damping):
    dashpots = Dashpots.of(reference(closed=True), ("sleeve 1", "sleeve 2"))
    at = np.array([damping, 0.5 * damping])
    poles, slopes = dashpots.poles(at)
    for sleeve in range(2):
        step = 1e-4 * damping * np.eye(2)[sleeve]
        (more, _), (less, _) = dashpots.poles(at + step), dashpots.poles(at - step)
        different = (more - less)[:8] / (2.0 * step[sleeve])
        # Differences err by step^2, 1e-8 of the way to where the next poles meet.
        np.testing.assert_allclose(slopes[:8, sleeve], different, rtol=1e-5, atol=1e-7 * np.abs(slopes).max())
        ratios = (ratios_of(more) - ratios_of(less))[:8] / (2.0 * step[sleeve])
        np.testing.assert_allclose(ratio_slopes(poles, slopes[:, sleeve])[:8], ratios, rtol=1e-5, atol=1e-10)


def test_a_sleeve_that_is_open_at_rest_is_refused():
    with pytest.raises(InputError, match=r"sleeve 1: it is open at rest, by 0.0265 mm; a dashpot .*; name a sleeve"):
        Dashpots.of(reference(), ("sleeve 1",))


def test_an_unknown_sleeve_is_refused():
    with pytest.raises(InputError, match=r"sleeve 'x'; the rig has sleeve 1, sleeve 2; use one of these names"):
        Dashpots.of(reference(), ("sleeve 2", "x"))


def test_each_frequency_finds_the_mode_that_is_nearest():
    computed = np.array([10.0, 11.0, 40.0])
    assert nearest_modes(computed, np.array([41.0, 10.4])).tolist() == [2, 0]
    assert nearest_modes(computed, np.array([10.4, 10.5])).tolist() == [0, 1]


@pytest.mark.parametrize("freqs", [[20.0], [10.0, 10.1, 10.2, 10.3]])
def test_a_frequency_that_no_mode_has_is_refused(freqs):
    with pytest.raises(InputError, match=r"modes at .* Hz; the rig at rest has 10, 11 Hz, and each .*; leave"):
        nearest_modes(np.array([10.0, 11.0, 400.0]), np.array(freqs))
