"""Dampings of two sleeves at once: there and back, their covariance, and what cannot be told apart."""

from dataclasses import replace

import numpy as np
import pytest
from sleeve_scenes import reference

from identification.decay.several_sleeves import several_dampings
from identification.decay.sleeve_poles import Dashpots, ratio_slopes, ratios_of
from models.errors import InputError

SLEEVES = ("sleeve 1", "sleeve 2")
N = 5


@pytest.fixture(scope="module")
def linear():
    return reference(closed=True)


def identified(linear, dampings):
    poles, slopes = Dashpots.of(linear, SLEEVES).poles(np.array(dampings))
    poles, slopes = poles[:N], slopes[:N]
    return np.abs(poles) / (2.0 * np.pi), ratios_of(poles), ratio_slopes(poles[:, None], slopes)


@pytest.mark.parametrize("dampings", [(30.0, 200.0), (150.0, 5.0), (80.0, 80.0)])
def test_exact_ratios_lead_back(linear, dampings):
    freqs, ratios, slopes = identified(linear, dampings)
    found = several_dampings(linear, SLEEVES, freqs, ratios, 0.01 * ratios)
    np.testing.assert_allclose(found.values, dampings, rtol=1e-5)  # where the search ends
    weighted = slopes / (0.01 * ratios)[:, None]
    np.testing.assert_allclose(found.covariance, np.linalg.inv(weighted.T @ weighted), rtol=1e-3)
    np.testing.assert_allclose(found.intervals.mean(axis=1), dampings, rtol=1e-4)


def test_a_sleeve_that_does_not_damp_stays_at_nothing(linear):
    freqs, ratios, _ = identified(linear, (0.0, 60.0))
    found = several_dampings(linear, SLEEVES, freqs, ratios * (1.0 - 1e-3), 0.01 * ratios)
    assert 0.0 <= found.values[0] < 1e-6
    assert found.values[1] == pytest.approx(60.0, rel=0.01)  # a thousandth of ratios that this sleeve makes


def test_the_scatter_is_the_covariance(linear):
    freqs, ratios, _ = identified(linear, (40.0, 90.0))
    rng, stds, n = np.random.default_rng(0), 0.01 * ratios, 150
    found = [several_dampings(linear, SLEEVES, freqs, ratios + stds * rng.standard_normal(N), stds) for _ in range(n)]
    values = np.array([f.values for f in found])
    told = several_dampings(linear, SLEEVES, freqs, ratios, stds)
    # 150 draws tell a standard deviation to 6 %.
    np.testing.assert_allclose(values.std(axis=0), told.stds, rtol=0.2)
    np.testing.assert_allclose(values.mean(axis=0), (40.0, 90.0), atol=4.0 * told.stds.max() / np.sqrt(n))


def test_fewer_modes_than_sleeves_are_refused(linear):
    freqs, ratios, _ = identified(linear, (40.0, 90.0))
    with pytest.raises(InputError, match=r"1 modes for 2 sleeves; each mode tells one number, .*; name fewer"):
        several_dampings(linear, SLEEVES, freqs[:1], ratios[:1], ratios[:1])


def test_sleeves_at_one_place_are_refused(linear):
    model = linear.model
    first, second = model.plant.contacts
    same = replace(model.plant, contacts=(replace(first, position=second.position), second))
    ports = tuple(replace(port, position=second.position) for port in model.ports)
    tangents = tuple(replace(tangent, port=ports[-1]) for tangent in linear.tangents)
    double = replace(linear, model=replace(model, plant=same, ports=ports), tangents=tangents)
    freqs, ratios, _ = identified(double, (40.0, 40.0))
    with pytest.raises(
        InputError, match=r"dampings of sleeve 1, sleeve 2 from modes at .*; each sleeve damps .*; name"
    ):
        several_dampings(double, SLEEVES, freqs, ratios, 0.01 * ratios)
