"""Parts of a fit: they sum to the whole, lie where they are said to lie, and vary no more than they claim."""

from dataclasses import replace

import numpy as np
import pytest

from identification.consistency.cells import cells_of, weighted
from identification.evaluate import TimeTarget, carry_noise
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns
from tests.identification.trial_records import FS, evaluator_of, measured, moved, multisine, oscillator, sweep


def fitted(*pairs, evaluator=None):
    evaluator = evaluator or evaluator_of(*pairs)
    rig = oscillator()
    return evaluator, fit(evaluator, Hypothesis(rig), rig_unknowns(rig), precise=True)


@pytest.fixture(scope="module")
def two_records():
    truth = moved(oscillator(), 0.5, -0.5, 0.5)
    return fitted(*(measured(truth, multisine(1024, seed=s), seed=s, name=f"r{s}") for s in (1, 2)))


@pytest.mark.parametrize("in_time", [False, True])
def test_the_parts_sum_to_the_whole(two_records, in_time):
    evaluator, found = two_records
    data = weighted(evaluator, found, 100.0)

    cells = list(cells_of(data, in_time=in_time))

    rows, rest = np.concatenate([d.rows for d in data], axis=1), np.concatenate([d.rest for d in data])
    np.testing.assert_allclose(sum(cell.score for cell in cells), rows @ rest, rtol=1e-8, atol=1e-8)
    assert [(cell.record, cell.part) for cell in cells] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    # Where a slope is cut in time the parts overlap by the width of the band's edge.
    within = 0.03 if in_time else 1e-9
    total = rows @ rows.T
    assert np.abs(sum(cell.information for cell in cells) - total).max() < within * np.abs(total).max()


def test_the_bands_part_at_the_edge(two_records):
    evaluator, found = two_records
    low, high = weighted(evaluator, found, 100.0)[0].bands
    frequency = np.repeat(np.arange(low.shape[1] // 2) * FS / 1024, 2)

    assert np.all(low[:, frequency > 100.0] == 0.0)
    assert np.all(high[:, frequency <= 100.0] == 0.0)


def test_a_blow_that_comes_late_speaks_late():
    force = np.zeros(2048)
    force[1500:1508] = 100.0
    evaluator, found = fitted(measured(Hypothesis(oscillator()), force, noise=0.001))
    (record,) = weighted(evaluator, found, None)
    early, late = record.times

    first, then = (np.fft.irfft(np.ascontiguousarray(rows[1]).view(complex), 2048) ** 2 for rows in (early, late))
    # At 3 % damping the energy falls to a half in 0.03 s, 62 samples; the edge of the band blurs by some samples.
    assert first[1480:1600].sum() > 0.97 * first.sum()
    assert then[1540:].sum() > 0.97 * then.sum()


@pytest.mark.parametrize("in_time", [False, True])
def test_the_scores_of_parts_vary_as_their_information_says(in_time):
    truth, force = Hypothesis(oscillator()), sweep(512)
    pairs = [measured(truth, force, seed=s) for s in range(200)]
    evaluator, found = fitted(pairs[0])
    (record,) = weighted(evaluator, found, 60.0)
    scores = []
    for pair in pairs:
        target = TimeTarget.of(*pair)
        residual = target.residual(truth, evaluator.settings)
        scores.append([rows[1] @ residual for rows in (record.times if in_time else record.bands)])
    told = [cell.information[1, 1] for cell in cells_of([record], in_time=in_time)]

    # A variance of 200 draws is known to 10 %; the weight of the record's own residual adds 2 %.
    np.testing.assert_allclose(np.var(scores, axis=0), told, rtol=0.35)


def test_noise_that_channels_share_weighs_a_line_as_one_channel():
    rig = oscillator()
    rig = rig.model_copy(update={"sensors": tuple(rig.sensors[0].model_copy(update={"name": n}) for n in "abcd")})
    pair = measured(Hypothesis(rig), multisine(1024), noise=1e-4, force_noise=0.1)
    evaluator = evaluator_of(pair)
    evaluator = evaluator.with_targets(carry_noise(evaluator, Hypothesis(rig), np.random.default_rng(0)))
    found = fit(evaluator, Hypothesis(rig), rig_unknowns(rig), max_iterations=1)

    (record,) = weighted(evaluator, found, None)

    assert record.shared.min() == pytest.approx(0.5, rel=1e-3)


def test_a_band_is_measured_in_what_the_model_leaves_there(two_records):
    evaluator, found = two_records
    plain = weighted(evaluator, found, 100.0)
    high = np.concatenate([record.is_high for record in plain])

    missed = weighted(evaluator, replace(found, residual=np.where(high, 4.0, 1.0) * found.residual), 100.0)[0]

    assert np.mean(missed.rest[missed.is_high] ** 2) == pytest.approx(1.0, abs=0.01)
    np.testing.assert_allclose(missed.rows[:, ~missed.is_high], plain[0].rows[:, ~missed.is_high])
    assert missed.missed > 0.8 * missed.is_high.sum()
    assert plain[0].missed == 0.0
