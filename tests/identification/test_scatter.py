"""Intervals widen where a number moves as a part of the data is left out, and only there."""

import numpy as np
import pytest
from rest_records import frfs_of, modes_of
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.evaluate import Evaluator
from identification.fit import fit
from identification.hypothesis import Hypothesis, coordinates, effect_unknowns, rig_unknowns
from identification.intervals import corrected
from identification.rest_target import FrfTarget, ModesTarget
from identification.scatter import beyond_noise, is_needed_throughout, widening
from models.effects import Place
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

UNKNOWNS = rig_unknowns(REFERENCE)
TRUTH = Hypothesis(REFERENCE)


def fitted(*effects):
    """The rig's numbers on two records of the truth with effects that the model does not know."""
    truth = TRUTH.with_effects(*effects)
    forces = {"low": multisine(4096, 4, rms=4.0), "high": multisine(4096, 4, rms=12.0, seed=2)}
    evaluator = evaluator_of(*(measured(truth, force, name=name) for name, force in forces.items()), jobs=2)
    return evaluator, fit(evaluator, TRUTH, UNKNOWNS, precise=True, tolerance=0.0)


def pulls(found):
    """Distance of each number from the truth, in standard deviations."""
    return (coordinates(found.hypothesis, UNKNOWNS) - coordinates(TRUTH, UNKNOWNS)) / found.std()


def test_noise_alone_widens_little():
    evaluator, found = fitted()
    factor = widening(evaluator, found, found.jacobian * found.residual)
    assert np.all(factor >= 1.0)
    assert np.median(factor) < 1.3
    assert factor.max() < 2.0


def test_what_every_channel_misses_a_little_widens_to_hold_the_truth():
    gains = 1.0 + 0.001 * np.random.default_rng(3).standard_normal(len(REFERENCE.sensors))
    evaluator, found = fitted(
        *(SensorGain(Place(sensor=s.name), gain=g) for s, g in zip(REFERENCE.sensors, gains, strict=True))
    )
    factor = widening(evaluator, found, found.jacobian * found.residual)
    told = corrected(evaluator, found, np.random.default_rng(0))
    np.testing.assert_allclose(told.std() / found.std(), factor, rtol=0.2)
    before, after = pulls(found), pulls(found) / factor
    assert found.ratio < 1.1
    assert np.sqrt(np.mean(before**2)) > 2.0
    assert np.sqrt(np.mean(after**2)) < 1.7


N, PARTS = 4000, np.repeat(np.arange(8), 500)
NONE = np.zeros(3)


def straight_line(rng, *, step=0.0, alone=False):
    """Slopes of three numbers, and noise to which each part adds its own share of the first slope."""
    jacobian = rng.standard_normal((3, N))
    if alone:
        jacobian[2, PARTS != 0] = 0.0
    residual = rng.standard_normal(N) + step * rng.standard_normal(8)[PARTS] * jacobian[0]
    inverse = np.linalg.inv(jacobian @ jacobian.T)
    move = -inverse @ (jacobian @ residual)
    return jacobian, residual + move @ jacobian, move, np.diag(inverse)


def test_a_part_left_out_moves_the_numbers_as_a_fit_without_it():
    rng = np.random.default_rng(0)
    jacobian, residual, _, known = straight_line(rng, step=0.5)
    moves = []
    for part in range(8):
        rest = part != PARTS
        rows, left = jacobian[:, rest], residual[rest]
        moves.append(np.linalg.solve(rows @ rows.T, -rows @ left))
    excess = beyond_noise(jacobian, jacobian * residual, PARTS, NONE, known)
    jackknife = 7.0 / 8.0 * np.sum(np.square(moves), axis=0)
    assert excess[0] == pytest.approx(jackknife[0], rel=0.05)
    assert excess[0] > 30.0 * known[0]


def test_noise_alone_is_seldom_beyond_itself_and_disagreement_holds_the_truth():
    rng = np.random.default_rng(1)
    quiet, pulls_of_all = [], []
    for _ in range(100):
        jacobian, residual, _, known = straight_line(rng)
        quiet.append(np.sqrt(1.0 + beyond_noise(jacobian, jacobian * residual, PARTS, NONE, known) / known))
        jacobian, residual, move, known = straight_line(rng, step=0.5)
        excess = beyond_noise(jacobian, jacobian * residual, PARTS, NONE, known)
        pulls_of_all.append(move[0] / np.sqrt(known[0] + excess[0]))
    assert np.median(quiet) < 1.1
    assert np.quantile(quiet, 0.95) < 1.6
    assert np.mean(np.abs(pulls_of_all) < 1.96) > 0.88


def test_a_number_that_one_part_alone_tells_is_contradicted_by_none():
    jacobian, residual, _, known = straight_line(np.random.default_rng(2), step=0.5, alone=True)
    excess = beyond_noise(jacobian, jacobian * residual, PARTS, NONE, known)
    assert excess[2] < known[2]


def test_frfs_of_two_rigs_disagree_and_those_of_one_do_not():
    softer = {"youngs_modulus": 0.995 * TRUTH.rig.structure.youngs_modulus}
    here, there = frfs_of(TRUTH), frfs_of(Hypothesis(TRUTH.rig.with_values(softer)), seed=2, name="other.uff")
    again = frfs_of(TRUTH, seed=2, name="other.uff")
    table = ModesTarget.of(modes_of(TRUTH))
    apart, alike = (Evaluator([FrfTarget.of(here), FrfTarget.of(other), table], 1) for other in (there, again))
    factors = []
    for evaluator in (apart, alike):
        found = fit(evaluator, TRUTH, UNKNOWNS, precise=True)
        factors.append(widening(evaluator, found, found.jacobian * found.residual)[0])
    assert len(table.mode_freqs) == table.n_data
    assert factors[0] > 5.0
    assert factors[1] < 2.0


HEAVY = PointMass(Place(position=0.8), 0.1)


def fits_of(*truths):
    """The records of these rigs, and the fits of the reference rig to them without the mass and with it."""
    pairs = [
        measured(truth, multisine(4096, rms=2.0, low=10.0, seed=seed), seed=seed, name=f"record {seed}")
        for seed, truth in enumerate(truths, start=1)
    ]
    evaluator, heavy = evaluator_of(*pairs), TRUTH.with_effects(HEAVY)
    less = fit(evaluator, TRUTH, UNKNOWNS, precise=True)
    return evaluator, less, fit(evaluator, heavy, (*UNKNOWNS, *effect_unknowns(heavy, places=False)), precise=True)


def test_an_effect_of_the_rig_is_needed_throughout():
    assert is_needed_throughout(*fits_of(TRUTH.with_effects(HEAVY), TRUTH.with_effects(HEAVY)))


def test_a_lone_record_is_not_left_out():
    assert is_needed_throughout(*fits_of(TRUTH.with_effects(HEAVY)))


def test_what_one_record_alone_has_is_not():
    evaluator, less, found = fits_of(TRUTH.with_effects(HEAVY), TRUTH)

    assert less.cost - found.cost > 1e3  # decisive, if nobody asks which of them says so
    assert not is_needed_throughout(evaluator, less, found)
