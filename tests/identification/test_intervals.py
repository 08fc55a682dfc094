"""The last fit's numbers lie as far from the truth as its intervals say, whatever the noise and the steps were."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, let_go, measured, moved, multisine, oscillator, sweep

from identification.calibrate import calibrate, unknowns_of
from identification.evaluate import carry_noise
from identification.fit import fit
from identification.hypothesis import LARGEST_SIGMA, Hypothesis, at_coordinates, coordinates, rig_unknowns
from identification.intervals import corrected, finer
from identification.prepare import prepare
from identification.scatter import widening
from models.simulate import Settings


def pulls(found, truth):
    """Distance of each number from the truth, in standard deviations."""
    far = coordinates(found.hypothesis, found.unknowns) - coordinates(truth, found.unknowns)
    return far / found.std()


def test_intervals_hold_the_truth_where_the_force_is_noisy():
    truth, unknowns = Hypothesis(REFERENCE), rig_unknowns(REFERENCE)
    records = [
        measured(truth, multisine(4096, rms=rms), noise=5e-4, force_noise=0.01, seed=seed, name=f"{rms:g} N")[0]
        for seed, rms in enumerate((5.0, 10.0))
    ]
    evaluator = prepare(truth, records, 1, np.random.default_rng(0))
    plain = fit(evaluator, truth, unknowns, max_iterations=4)

    found = corrected(evaluator, plain, np.random.default_rng(1))

    assert np.sqrt(np.mean(pulls(found, truth) ** 2)) < 1.7
    assert np.sqrt(np.mean(pulls(plain, truth) ** 2)) > np.sqrt(np.mean(pulls(found, truth) ** 2))
    assert np.all(found.std() > 0.9 * plain.std())


def test_noise_of_the_force_at_a_resonance_that_nothing_excites_pulls_no_number():
    """Least squares takes numbers with which the model answers that noise least: too much damping.

    Three realisations tell the scatter of what is taken back by two degrees of freedom: of several draws some lie four
    of their own standard deviations from the truth, where without it they lie up to sixteen.
    """
    rig = oscillator(freq=200.0, damping_ratio=0.02, damping=0.3, stiffness=0.01, mass=0.01)
    truth, far = Hypothesis(rig), []
    for seed in range(3):
        force = multisine(16384, periods=4, low=20.0, high=100.0, seed=seed)
        evaluator = evaluator_of(measured(truth, force, noise=0.01, force_noise=0.01, seed=seed))
        evaluator = evaluator.with_targets(carry_noise(evaluator, truth, np.random.default_rng(seed)))
        plain = fit(evaluator, truth, rig_unknowns(rig), precise=True)

        for draw in range(4):
            found = corrected(evaluator, plain, np.random.default_rng(100 * draw + seed))
            far.append((pulls(replace(plain, covariance=found.covariance), truth), pulls(found, truth)))

    before, after = np.sqrt(np.mean(np.square(far), axis=(0, 2)))
    assert before > 3.0
    assert after < min(3.0, 0.4 * before)
    assert np.median(np.abs([pull for _, pull in far])) < 2.0


def test_coarse_steps_leave_no_trace_in_the_numbers():
    truth = moved(oscillator(), 0.5, -0.5, 0.5)
    record, noise = measured(truth, sweep(4096, high=600.0), noise=2e-5, settings=Settings(steps_per_sample=32))
    coarse = evaluator_of((record, noise), settings=Settings(steps_per_sample=1))
    plain = fit(coarse, truth, rig_unknowns(truth.rig), tolerance=0.0)

    found = corrected(coarse, plain, np.random.default_rng(0))

    assert np.abs(pulls(plain, truth)).max() > 5.0
    assert np.abs(pulls(found, truth)).max() < 4.0


def test_a_state_at_the_start_is_the_same_at_any_resolution():
    """It is told mode by mode; of this beam an eigenvector turns over as more of them are computed."""
    beam = REFERENCE.structure.model_copy(
        update={"length": 0.95, "diameter": 0.012, "youngs_modulus": 119.92e9, "density": 1600.0}
    )
    sleeve = REFERENCE.sleeves[0].model_copy(update={"position": 0.6})
    sensors = tuple(sensor for sensor in REFERENCE.sensors if sensor.position < beam.length)
    drive = REFERENCE.excitation.model_copy(update={"position": 0.8})
    rig = REFERENCE.model_copy(
        update={"structure": beam, "sleeves": (sleeve,), "sensors": sensors, "excitation": drive}
    )
    evaluator, given = evaluator_of(let_go(rig, -5.0), rig=rig), Hypothesis(rig)
    found = calibrate(evaluator, given, unknowns_of(given, evaluator))
    assert found.ratio < 1.5

    (residual,) = finer(evaluator, found.hypothesis).residuals([(found.hypothesis, None)])

    assert np.sqrt(np.mean(residual**2)) < 1.1 * found.ratio


@pytest.mark.parametrize("share", [0.3, 3.0], ids=["too flat", "too steep"])
def test_slopes_that_are_not_those_of_the_valley_move_nothing_away(share):
    """Where they are too flat, each correction goes farther wrong than the one before; where too steep, it goes on."""
    truth = moved(oscillator(), 0.5, -0.5, 0.5)
    record, noise = measured(truth, sweep(4096, high=600.0), noise=2e-5, settings=Settings(steps_per_sample=32))
    coarse = evaluator_of((record, noise), settings=Settings(steps_per_sample=1))
    plain = fit(coarse, truth, rig_unknowns(truth.rig), tolerance=0.0)
    wrong = replace(plain, jacobian=share * plain.jacobian, covariance=plain.covariance / share**2)

    found = corrected(coarse, wrong, np.random.default_rng(0))

    fine = coarse.with_settings(Settings(steps_per_sample=32))
    (before,), (after,) = (fine.residuals([(each.hypothesis, None)]) for each in (plain, found))
    if share < 1.0:
        assert found.hypothesis.values == plain.hypothesis.values
    assert after @ after < before @ before or share < 1.0


def test_a_number_at_its_bound_does_not_keep_the_others_from_being_corrected():
    truth = moved(oscillator(), 6.0, -0.5, 0.5)  # a mass further off than its tolerance lets it go
    record, noise = measured(truth, sweep(4096, high=600.0), noise=2e-5, settings=Settings(steps_per_sample=32))
    coarse = evaluator_of((record, noise), settings=Settings(steps_per_sample=1))
    ended = fit(coarse, Hypothesis(truth.rig), rig_unknowns(truth.rig), tolerance=0.0)
    x = coordinates(ended.hypothesis, ended.unknowns)
    assert x[0] == pytest.approx(LARGEST_SIGMA, abs=1e-6)
    # Finer steps do not move the end of an oscillator's fit, whose steps are exact: so the fit is put beside its end.
    beside = at_coordinates(ended.hypothesis, ended.unknowns, x + np.array([0.0, 1e-3, 0.0]))
    plain = fit(coarse, beside, ended.unknowns, max_iterations=0)

    found = corrected(coarse, plain, np.random.default_rng(0))

    fine = coarse.with_settings(Settings(steps_per_sample=32))
    (before,), (after,) = (fine.residuals([(each.hypothesis, None)]) for each in (plain, found))
    assert after @ after < before @ before


def test_without_noise_of_the_excitation_the_intervals_are_the_fits_or_what_the_parts_scatter():
    truth = Hypothesis(oscillator())
    evaluator = evaluator_of(measured(truth, sweep(1024)))
    plain = fit(evaluator, truth, rig_unknowns(truth.rig))

    found = corrected(evaluator, plain, np.random.default_rng(0))

    factor = widening(evaluator, plain, found.jacobian * found.residual)
    np.testing.assert_allclose(found.covariance, plain.covariance * np.outer(factor, factor), rtol=1e-3)


def test_what_the_intervals_were_widened_by_is_kept():
    rig = oscillator()
    pairs = [
        measured(moved(rig, 0.0, sigma, 0.0), sweep(2048), seed=seed, name=f"day {seed}")
        for seed, sigma in enumerate((-0.05, 0.0, 0.08))
    ]
    evaluator = evaluator_of(*pairs)
    plain = fit(evaluator, Hypothesis(rig), rig_unknowns(rig), precise=True)

    found = corrected(evaluator, plain, np.random.default_rng(0))

    assert np.max(found.widened) > 2.0
    unwidened = found.covariance / np.outer(found.widened, found.widened)
    np.testing.assert_allclose(np.diag(unwidened), np.diag(plain.covariance), rtol=0.1)


def test_a_model_without_unknowns_is_its_own_correction():
    truth = Hypothesis(oscillator())
    evaluator = evaluator_of(measured(truth, sweep(1024), force_noise=0.01))
    plain = fit(evaluator, truth, ())
    assert corrected(evaluator, plain, np.random.default_rng(0)) is plain


def test_a_correction_that_is_none_is_not_made():
    truth = Hypothesis(oscillator())
    evaluator = evaluator_of(measured(truth, sweep(1024)))
    plain = fit(evaluator, truth, rig_unknowns(truth.rig))
    wild = replace(plain, jacobian=1e-6 * plain.jacobian)

    found = corrected(evaluator, wild, np.random.default_rng(0))

    assert found.hypothesis is plain.hypothesis
