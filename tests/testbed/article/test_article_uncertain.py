"""Frequencies of thousands of rigs, their statistics, the posterior and the emulator; feed-forward slews."""

import numpy as np
import pytest

from models.linear import frf, linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from testbed.article.emulated import NAMES, emulated, frequency_shares
from testbed.article.reading import tapped_modes
from testbed.article.rig import BAND, TIP, at_rest, natural_freqs
from testbed.article.slew import (
    BEFORE,
    DISTANCE,
    FS,
    INVERTED_TO,
    LASTS,
    by_engine,
    by_model,
    carried_out,
    courses,
    slewed,
    wanted,
)
from testbed.article.small_motion import Draws, SmallMotion
from testbed.article.truth import truth_of
from testbed.article.uncertain import Statistics, coincidence, condition, difference, draws_at, posterior
from testbed.article.updating import updated
from tests.testbed.article.article_scenes import bench_test_by_model, geometry

HALF = 5e-4


def damping_ratios(rig):
    return natural_modes(linearised(at_rest(rig)), (), BAND).damping_ratios[:4]


@pytest.mark.parametrize("clearance", [5e-5, 5e-4, 1e-3, 2e-3])
def test_small_motion_is_that_of_the_model_at_any_numbers(clearance):
    rig = geometry().rig(clearance, "force")
    motion, rng = SmallMotion.of(rig), np.random.default_rng(5)
    factors = np.exp(0.2 * rng.standard_normal((4, 6)))
    nominal = Draws.of(rig, 4)
    draws = Draws(
        nominal.stiffness * factors[:, :2],
        nominal.damping * factors[:, 2:4],
        nominal.clearance * factors[:, 4:],
        np.exp(0.01 * rng.standard_normal(4)),
    )
    found, touching, poles = motion.natural_freqs(draws), motion.touching(draws), motion.poles(draws)
    ratios = -poles.real / np.abs(poles)
    for n in range(4):
        values = {"youngs_modulus": rig.structure.youngs_modulus * draws.modulus[n]}
        for key in ("stiffness", "damping", "clearance"):
            values |= {f"sleeves[{i}].{key}": getattr(draws, key)[n, i] for i in range(2)}
        other = rig.with_values(values)
        np.testing.assert_allclose(found[n], natural_freqs(other), rtol=1e-5)
        np.testing.assert_allclose(ratios[n], damping_ratios(other), rtol=1e-4)
        np.testing.assert_array_equal(touching[n], at_rest(other).rest.penetration > 0.0)


def test_statistics_of_a_normal_hold_its_numbers():
    freqs = np.random.default_rng(2).normal([10.0, 40.0, 90.0, 190.0], [0.1, 0.4, 0.9, 1.9], (20000, 4))
    found = Statistics.of(freqs)
    assert np.all(np.abs(found.mean - [10.0, 40.0, 90.0, 190.0]) < 1.5 * found.mean_within)
    assert np.all(np.abs(found.std - [0.1, 0.4, 0.9, 1.9]) < 1.5 * found.std_within)
    np.testing.assert_allclose(found.std_within, 1.96 * found.std / np.sqrt(2.0 * 20000), rtol=0.05)
    np.testing.assert_allclose(found.variation, 0.01, rtol=0.03)


def test_a_clearance_moves_no_frequency_while_both_sleeves_carry():
    rig = geometry().rig(5e-5, "force")
    freqs = condition(SmallMotion.of(rig), rig, "clearance", 200)
    assert np.ptp(freqs, axis=0).max() < 1e-6
    assert condition(SmallMotion.of(rig), rig, "stiffness", 200).std(axis=0).min() > 0.05


def test_what_two_distributions_have_in_common():
    rng = np.random.default_rng(4)
    one, other = rng.standard_normal(4000), rng.standard_normal(4000)
    assert coincidence(one, one)[0] == pytest.approx(1.0, abs=2e-3)
    share, within = coincidence(one, other[:1000] + 2.0)
    assert share == pytest.approx(0.3173, abs=0.03)
    assert 0.005 < within < 0.05
    assert coincidence(one, other + 20.0)[0] < 1e-3


def test_each_tap_is_held_against_the_model_at_its_own_time():
    tests = np.array([[100.0] * 4, [200.0] * 4, [400.0] * 4])
    samples = np.stack([1.01 * tests, 1.01 * tests, 1.25 * tests, 1.25 * tests])
    samples[:, 2] += 4.0
    found = difference(samples, tests)
    of_tap = np.array([0.13, 0.13, 0.14])
    np.testing.assert_allclose(found.mean, of_tap.mean())
    half = 4.302653 * of_tap.std(ddof=1) / np.sqrt(3.0)
    np.testing.assert_allclose(found.interval[0], [of_tap.mean() - half, of_tap.mean() + half], rtol=1e-6)
    np.testing.assert_allclose(found.inside, 0.5)


def test_shares_of_the_frequencies_add_up():
    rig = geometry().rig(5e-5, "force")
    shares = frequency_shares(SmallMotion.of(rig), rig)
    np.testing.assert_allclose(shares.first.sum(axis=1), 1.0, atol=0.05)
    assert NAMES[int(np.argmax(shares.total[0]))] == "stiffness 2"


@pytest.mark.study
def test_the_posterior_holds_what_is_there():
    rig, truth = geometry().rig(HALF, "force"), truth_of(geometry(), HALF, "force", "modal")
    modes = tapped_modes(bench_test_by_model(HALF, "force").taps, rig)
    motion, found = SmallMotion.of(rig), updated(rig, modes)
    course = np.array([effect.values for effect in found.dampings]).T
    told = posterior(motion, rig, modes, course, 400)
    true = [truth.built.structure.youngs_modulus / rig.structure.youngs_modulus]
    true += [sleeve.stiffness for sleeve in truth.built.sleeves]
    draws = np.column_stack([told.draws.modulus, told.draws.stiffness])
    assert np.all(np.abs(draws.mean(axis=0) - true) < 3.0 * draws.std(axis=0))
    assert np.all(draws.std(axis=0) < [0.005, 0.06 * true[1], 0.06 * true[2]])
    np.testing.assert_allclose(told.at_taps(motion, course).mean(axis=0), modes.natural_freqs, rtol=2e-3)
    assert told.independent > 100.0


@pytest.mark.slow
def test_the_emulator_knows_what_it_has_not_seen():
    rig = geometry().rig(HALF, "table").with_values({"sleeves[0].damping": 70.0, "sleeves[1].damping": 130.0})
    found = emulated(rig, bench_test_by_model(HALF, "table").struck, TIP, 1)
    assert found.error < 0.12
    assert found.covered > 0.8
    assert found.samples.std() == pytest.approx(found.simulated.std(), rel=0.25)


def test_points_of_a_design_are_rigs_about_the_mean():
    rig = geometry().rig(HALF, "force")
    found = draws_at(rig, np.array([[0.0] * 6, [1.0, 0.0, -1.0, 0.0, 0.0, 2.0]]))
    np.testing.assert_allclose(found.stiffness[1] / found.stiffness[0], [1.1, 1.0])
    np.testing.assert_allclose(found.damping[1] / found.damping[0], [0.7, 1.0])
    np.testing.assert_allclose(found.clearance[1] / found.clearance[0], [1.0, 1.2])


@pytest.mark.parametrize("clearance", [5e-5, 5e-4, 2e-3])
def test_the_tip_can_be_brought_anywhere_slowly_enough(clearance):
    """Where base to tip were 0, no motion of the base would move the tip."""
    rig = slewed(geometry().rig(clearance, "table"))
    transfer = frf(linearised(build_modal(build_plant(rig), BAND)), np.linspace(0.5, INVERTED_TO, 400), ["tip"])
    assert np.abs(transfer).min() > 0.5


def test_the_wanted_course_is_smooth_and_arrives():
    course = wanted()
    assert course[0] == 0.0
    assert course[-1] == DISTANCE
    assert course[: round(BEFORE * FS)].max() == 0.0
    assert np.abs(np.diff(course, 3)).max() * FS**3 < 400.0 * DISTANCE / LASTS**3


def test_a_perfect_model_brings_the_tip_where_it_is_wanted():
    truth = truth_of(geometry(), HALF, "table", "modal")
    real = build_plant(slewed(truth.built), truth.hidden)
    initial = build_plant(slewed(geometry().rig(HALF, "table")))
    bases = courses({"initial": initial, "perfect": real})
    slews = {name: carried_out(base, by_model(real)) for name, base in bases.items()}
    assert slews["no model"].rms > 1e-3
    assert slews["initial"].rms < 0.1 * slews["no model"].rms
    assert slews["perfect"].rms < 1e-6
    again = carried_out(bases["perfect"], by_engine(real, "modal"))
    np.testing.assert_allclose(again.tip, slews["perfect"].tip, atol=1e-7)
