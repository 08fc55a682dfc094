"""FRFs and mode shapes in units of their noise: 1 for the truth, and finite however far off a model is."""

from dataclasses import replace

import numpy as np
import pytest
from rest_records import LINES, frfs_of, modes_of
from trial_records import REFERENCE, evaluator_of, measured, moved, oscillator, sweep

from identification.calibrate import beginning
from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.prepare import Horizon, cut_to, prepare
from identification.rest_target import FREQ_STD, NO_MODE, SHAPE_STD, SOFT_LINES, FrfTarget, ModesTarget
from models.effects import Place
from models.effects.force_gain import ForceGain
from models.effects.sensor_gain import SensorGain
from models.errors import InputError
from models.simulate import Settings

TRUTH, WRONG = Hypothesis(REFERENCE), moved(REFERENCE, *[2.0] * 9)
SETTINGS = Settings()


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("rig", [REFERENCE, oscillator()], ids=["beam", "oscillator"])
def test_the_truth_leaves_the_noise_of_frfs_alone(rig):
    truth = Hypothesis(rig)
    target = FrfTarget.of(frfs_of(truth, noise=0.01))

    residual = target.residual(truth, SETTINGS)

    assert residual.shape == (target.n_data,)
    # The noise itself is known to a tenth.
    assert rms(residual) == pytest.approx(1.0, abs=0.1)
    assert target.score(truth).nrmse == pytest.approx(target.nrmse_of_noise, rel=0.15)
    assert target.score(truth).noise_nrmse == target.nrmse_of_noise


def test_a_line_at_0_hz_is_left_out():
    record = frfs_of(TRUTH)
    whole = replace(
        record,
        frequency=np.concatenate([[0.0], LINES]),
        values=np.concatenate([np.full((len(record.sensors), 1), np.inf), record.values], axis=1),
        coherence=np.ones((len(record.sensors), len(LINES) + 1)),
    )

    target = FrfTarget.of(whole)

    np.testing.assert_array_equal(target.frequency, LINES)
    assert target.record.coherence.shape == target.record.values.shape


def test_the_soft_difference_of_a_small_error_is_the_relative_one_and_of_a_large_one_at_most_two():
    target = FrfTarget.of(frfs_of(TRUTH, noise=0.002)).soft()
    assert len(target.frequency) <= SOFT_LINES

    true, near, far = (
        target.residual(TRUTH.with_effects(ForceGain(Place(), gain=g)), SETTINGS) for g in (1, 0.95, 1e-6)
    )

    # 0.2 % is a standard deviation of 0.14 % of each part.
    assert rms(true) == pytest.approx(1.0, abs=0.1)
    assert np.median(np.abs(near.view(complex))) == pytest.approx(0.05 / 0.0014, rel=0.1)
    assert np.max(np.abs(far.view(complex))) < 2.0 / 0.0014 * 1.1


def test_a_beginning_holds_frfs_softly_and_modes_whole():
    evaluator = Evaluator([FrfTarget.of(frfs_of(TRUTH)), ModesTarget.of(modes_of(TRUTH))], 1)

    frfs, modes = beginning(evaluator, 0.1, 0.5).at_rest

    assert frfs.is_soft
    assert modes is evaluator.targets[1]


def test_a_cut_leaves_frfs_whole():
    timed = evaluator_of(measured(Hypothesis(oscillator()), sweep(2048)))
    frfs = FrfTarget.of(frfs_of(Hypothesis(oscillator())))

    cut = cut_to(timed.with_targets([*timed.targets, frfs]), 0.25, [Horizon("test", 1.0, 1.0)])

    assert cut.at_rest == (frfs,)
    assert [target.record.n_samples for target in cut.timed] == [512]
    assert cut.extent == "0.2 s of records and h.uff"


def test_an_evaluator_of_all_kinds_has_one_row():
    truth = Hypothesis(oscillator())
    record, _ = measured(truth, sweep(4096), noise=0.01)

    evaluator = prepare(truth, [frfs_of(truth), record, modes_of(truth)], 1, np.random.default_rng(0))
    whole, part = evaluator.residuals([(truth, None), (truth, "h.uff")])

    assert len(whole) == evaluator.n_data == sum(target.n_data for target in evaluator.targets)
    frfs = next(target for target in evaluator.at_rest if target.record.name == "h.uff")
    assert np.count_nonzero(part) == frfs.n_data
    assert len(evaluator.responses(truth)) == 1


def test_modes_of_the_truth_leave_their_own_errors():
    target = ModesTarget.of(modes_of(TRUTH, freq=FREQ_STD, shape=SHAPE_STD, damping=0.2))

    residual = target.residual(TRUTH, SETTINGS)

    assert residual.shape == (target.n_data,)
    assert 0.6 < rms(residual) < 1.2
    assert rms(target.residual(WRONG, SETTINGS)) > 1.5 * rms(residual)
    assert target.score(TRUTH).nrmse == pytest.approx(target.nrmse_of_noise, rel=0.4)


def test_modes_without_error_leave_none_whatever_their_scale():
    record = modes_of(TRUTH, freq=0.0, shape=0.0, damping=0.0)
    scaled = replace(
        record, shapes=record.shapes * np.array([2.0, -1j, 0.3j, 5.0, 1.0, -1.0])[: len(record.shapes), None]
    )

    for one in (record, scaled, replace(scaled, damping_ratios=None)):
        target = ModesTarget.of(one)
        assert rms(target.residual(TRUTH, SETTINGS)) < 1e-6
        assert len(target.residual(TRUTH, SETTINGS)) == target.n_data


def test_real_shapes_have_one_number_an_entry():
    record = modes_of(TRUTH)
    real = replace(record, shapes=record.shapes.real + 0j)

    complex_target, target = ModesTarget.of(record), ModesTarget.of(real)

    assert complex_target.n_data - target.n_data == record.shapes.size
    assert len(target.residual(TRUTH, SETTINGS)) == target.n_data


def test_a_mode_that_the_model_does_not_have_is_wholly_missed():
    record = modes_of(Hypothesis(oscillator()))
    more = replace(
        record,
        natural_freqs=np.array([*record.natural_freqs, 100.0]),
        damping_ratios=np.array([*record.damping_ratios, 0.01]),
        shapes=np.vstack([record.shapes, record.shapes]),
    )
    target = ModesTarget.of(more)

    residual = target.residual(Hypothesis(oscillator()), SETTINGS)

    assert np.all(np.isfinite(residual))
    assert residual[1] == pytest.approx(NO_MODE / FREQ_STD)
    assert target.score(Hypothesis(oscillator())).nrmse > 0.5


def test_a_shape_sees_a_sensor_that_reads_upside_down():
    target = ModesTarget.of(modes_of(TRUTH))

    inverted = TRUTH.with_effects(SensorGain(Place(sensor="P8"), gain=-1.0))

    assert rms(target.residual(inverted, SETTINGS)) > 5.0 * rms(target.residual(TRUTH, SETTINGS))


def test_a_mode_that_no_sensor_sees_is_refused():
    record = modes_of(TRUTH)
    still = record.shapes.copy()
    still[1] = 0.0

    with pytest.raises(InputError, match=r"m\.uff: mode 2 is 0 at all sensors of the rig; .*; remove the mode"):
        ModesTarget.of(replace(record, shapes=still))
