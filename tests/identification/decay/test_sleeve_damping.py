"""A sleeve's damping from damping ratios: a mass in closed form, the beam there and back, and how sure it is."""

import numpy as np
import pytest
from sleeve_scenes import BAND, DASHPOT, MASS, omega, ratio_of, reference, stopped_mass

from identification.decay.sleeve_damping import NORMAL_95, DampingTable, contact_damping
from identification.decay.sleeve_poles import Dashpots, ratios_of
from models.errors import InputError

TANGENT = 1e-8  # a tangent by differences of 2e-9 m in a force of some N
ONE = np.array([0])


@pytest.fixture(scope="module")
def mass():
    return DampingTable.of(stopped_mass(), "stop", 10.0, most=150.0)


@pytest.fixture(scope="module")
def beam():
    return DampingTable.of(reference(), "sleeve 2", BAND)


def test_a_mass_has_its_closed_form(mass):
    dampings, std = np.array([0.5, 4.0, 50.0]), 1e-4
    found = contact_damping(mass, ONE, ratio_of(dampings)[:, None], np.full((3, 1), std))
    np.testing.assert_allclose(found.value, dampings, rtol=1e-6)  # of the table's cubics, nearly straight here
    np.testing.assert_allclose(found.std, 2.0 * MASS * omega() * std, rtol=1e-6)
    np.testing.assert_allclose(found.high - found.low, 2.0 * NORMAL_95 * found.std, rtol=1e-6)
    assert not found.contradicted.any()
    assert mass.own == pytest.approx(DASHPOT, rel=TANGENT)


def test_less_than_the_rig_loses_without_the_sleeve_is_nothing_and_said(mass):
    without = float(ratio_of(0.0))
    found = contact_damping(mass, ONE, np.array([[0.9 * without], [0.99 * without]]), np.full((2, 1), 0.01 * without))
    np.testing.assert_array_equal(found.value, 0.0)
    np.testing.assert_array_equal(found.low, 0.0)
    assert found.high[1] == pytest.approx(NORMAL_95 * 2.0 * MASS * omega() * 0.01 * without, rel=1e-6)
    assert found.contradicted.tolist() == [True, False]


def test_more_than_any_damping_gives_is_said(beam):
    found = contact_damping(beam, np.array([3]), np.array([[0.3]]), np.array([[0.003]]))
    assert found.contradicted.all()


def test_the_table_is_exact_between_its_points(beam):
    dashpots = Dashpots.of(reference(), ("sleeve 2",))
    for damping in np.geomspace(1.0, 600.0, 23):
        exact = ratios_of(dashpots.poles(np.array([damping]))[0])
        found = beam.ratios(damping)
        nearest = exact[np.abs(exact - found[:, None]).argmin(axis=1)]
        np.testing.assert_allclose(found, nearest, atol=2e-5)  # cubics over steps of 6 %, by their fourth derivative


def test_every_mode_alone_and_all_together_lead_back(beam):
    dampings = np.geomspace(0.3, 500.0, 40)
    ratios = beam.ratios(dampings)
    stds = np.full_like(ratios, 1e-4)
    together = contact_damping(beam, np.arange(7), ratios, stds)
    np.testing.assert_allclose(together.value, dampings, rtol=1e-9)
    for mode in range(7):
        alone = contact_damping(beam, np.array([mode]), ratios[:, [mode]], stds[:, [mode]], near=100.0)
        below = dampings < 150.0  # beyond its peak a mode has two dampings, and the nearer to ``near`` is taken
        np.testing.assert_allclose(alone.value[below], dampings[below], rtol=1e-6)


def test_of_two_dampings_with_one_ratio_the_nearer_is_taken(beam):
    peak = beam.dampings[np.argmax(ratios_of(beam.poles[:, 0]))]
    ratio = beam.ratios(0.4 * peak)[0]
    low, high = (
        contact_damping(beam, np.array([0]), np.array([[ratio]]), np.array([[1e-5]]), near=near)
        for near in (0.3 * peak, 1.5 * peak)
    )
    assert low.value[0] == pytest.approx(0.4 * peak, rel=1e-6)
    assert high.value[0] > peak
    np.testing.assert_allclose(beam.ratios(high.value)[0, 0], ratio, rtol=1e-6)


def test_a_vague_mode_does_not_decide_between_two_dampings(beam):
    """Its ratio prefers one of them by one standard deviation, which is a chance of one in three."""
    peak = beam.dampings[np.nanargmax(ratios_of(beam.poles[:, 0]))]
    one = beam.ratios(0.4 * peak)
    modes, near = np.array([0, 3]), 1.5 * peak
    alone = contact_damping(beam, modes[:1], one[None, :1], np.array([[1e-5]]), near=near).value[0]
    apart = beam.ratios(alone)[3] - one[3]
    for std, expected in ((abs(apart), alone), (0.1 * abs(apart), 0.4 * peak)):
        found = contact_damping(beam, modes, one[None, modes], np.array([[1e-5, std]]), near=near)
        assert found.value[0] == pytest.approx(expected, rel=1e-3)  # the first mode is far more precise


def test_a_mode_that_has_ceased_to_oscillate_ends_and_the_others_go_on(beam):
    gone = np.isnan(beam.poles)
    assert gone.any(axis=0).tolist() == [False, True, False, False, False, False, False]
    assert beam.dampings[gone[:, 1]].min() > 800.0  # it creeps where half its damping ratio's slope reaches 1
    assert (np.diff(gone[:, 1].astype(int)) >= 0).all()


def test_precision_adds_up_and_the_most_telling_mode_has_most_of_it(beam):
    stds = np.array([[1e-3, 2e-4, 1e-3, 1e-4, 1e-3, 1e-3, 1e-3]])
    found = contact_damping(beam, np.arange(7), beam.ratios(np.array([80.0])), stds)
    slopes = beam.ratios(80.0, 1)
    precision = (slopes / stds[0]) ** 2
    assert found.std[0] == pytest.approx(precision.sum() ** -0.5, rel=1e-9)
    np.testing.assert_allclose(found.shares[0], precision / precision.sum(), rtol=1e-9)
    assert found.most_telling == np.argmax(np.abs(slopes) / stds[0]) == 1


def test_modes_that_contradict_each_other_widen_the_interval(beam):
    modes, stds = np.array([0, 1]), np.full((1, 2), 1e-4)
    agreed = contact_damping(beam, modes, beam.ratios(np.array([80.0]))[:, modes], stds)
    apart = np.diag(beam.ratios(np.array([79.0, 81.0]))[:, modes])[None]
    found = contact_damping(beam, modes, apart, stds)
    # Two readings 2 N s/m apart with weights w: chi^2 = 4 w0 w1 / (w0 + w1), on one degree of freedom.
    w = (beam.ratios(80.0, 1)[modes] / stds[0]) ** 2
    assert found.std[0] / agreed.std[0] == pytest.approx(np.sqrt(4.0 * w[0] * w[1] / w.sum()), rel=0.01)
    assert found.contradicted[0]
    assert not agreed.contradicted[0]
    assert 79.0 < found.value[0] < 81.0


def test_intervals_cover_the_truth(beam):
    rng, n = np.random.default_rng(3), 4000
    exact = beam.ratios(np.full(n, 60.0))
    stds = 0.02 * exact
    found = contact_damping(beam, np.arange(7), exact + stds * rng.standard_normal(exact.shape), stds)
    cover = np.mean((found.low <= 60.0) & (found.high >= 60.0))
    # Widened where chance makes modes differ, so that it covers a little more; 4000 draws tell it to 0.4 %.
    assert 0.945 < cover < 0.985
    assert np.mean(found.contradicted) < 0.008


def test_what_is_not_known_is_left_out(beam):
    ratios, stds = np.tile(beam.ratios(50.0), (3, 1)), np.full((3, 7), 1e-4)
    ratios[0, :3], ratios[1] = np.nan, np.nan
    found = contact_damping(beam, np.arange(7), ratios, stds)
    np.testing.assert_allclose(found.value[[0, 2]], 50.0, rtol=1e-9)
    assert np.isnan([found.value[1], found.std[1], found.low[1], found.high[1]]).all()
    assert found.std[0] > found.std[2]
    np.testing.assert_array_equal(found.shares[0, :3], 0.0)
    assert not found.contradicted[1]


def test_frequencies_number_the_modes(beam):
    own = np.abs(beam.poles[np.searchsorted(beam.dampings, beam.own)]) / (2.0 * np.pi)
    assert beam.matched(own[[4, 0]] * 1.01).tolist() == [4, 0]


def test_a_band_without_modes_is_refused():
    with pytest.raises(InputError, match=r"modes up to 5 Hz; the lowest .* has 25.64 Hz; raise the frequency"):
        DampingTable.of(reference(), "sleeve 2", 5.0)


def test_numbers_that_are_no_modes_are_refused(beam):
    with pytest.raises(InputError, match=r"ratios of 1 modes with the numbers 9; .*from 0 to 6; number them"):
        contact_damping(beam, np.array([9]), np.array([[0.1]]), np.array([[0.1]]))


def test_a_ratio_of_unknown_precision_is_refused(beam):
    with pytest.raises(InputError, match=r"deviation is not a positive number; modes are weighed .*; give .* nan"):
        contact_damping(beam, ONE, np.array([[0.1]]), np.array([[0.0]]))
