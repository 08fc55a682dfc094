"""Residuals in units of the noise: 1 for the truth, whatever the number of threads."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import FS, REFERENCE, evaluator_of, let_go, measured, moved, multisine, oscillator, sweep

from identification.evaluate import AHEAD, Evaluator, TimeTarget, carry_noise, nrmse, scored_spectrum, whitened
from identification.hypothesis import Hypothesis
from identification.noise import Noise
from models.band_limit import SCORE_EDGE
from models.record import Record


def brick_wall(channels, fs):
    """Nothing above 0.35 fs."""
    freq = np.fft.rfftfreq(channels.shape[1], 1.0 / fs)
    return np.fft.irfft(np.fft.rfft(channels) * (freq <= SCORE_EDGE * fs), channels.shape[1])


@pytest.mark.parametrize("rig", [REFERENCE, oscillator()], ids=["beam", "oscillator"])
def test_the_truth_leaves_the_noise_alone(rig):
    truth = Hypothesis(rig)
    evaluator = evaluator_of(measured(truth, multisine()))

    residual = evaluator.residuals([(truth, None)])[0]

    # Four standard deviations of chi-square over its degrees of freedom.
    assert np.mean(residual**2) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / evaluator.n_data))
    assert len(residual) == evaluator.n_data


def test_a_wrong_rig_leaves_more():
    evaluator = evaluator_of(measured(Hypothesis(oscillator()), multisine()))

    residual = evaluator.residuals([(moved(oscillator(), 0.0, 2.0, 0.0), None)])[0]

    assert np.mean(residual**2) > 100.0


def test_nrmse_is_that_of_low_passed_signals():
    rng = np.random.default_rng(2)
    channels = rng.standard_normal((3, 1024)) * np.array([[1.0], [5.0], [0.2]])
    model = channels + 0.3 * rng.standard_normal((3, 1024))
    channels -= channels.mean(axis=1, keepdims=True)
    model -= model.mean(axis=1, keepdims=True)
    error, true = brick_wall(model - channels, FS), brick_wall(channels, FS)

    found = nrmse(scored_spectrum(model - channels), scored_spectrum(channels), ("acceleration",) * 3)

    assert found == pytest.approx(np.sqrt(np.mean(error**2) / np.mean(true**2)), rel=1e-12)


def test_the_nrmse_of_the_noise_is_what_the_truth_leaves():
    record, noise = measured(Hypothesis(REFERENCE), multisine(), noise=0.02)
    clean, _ = measured(Hypothesis(REFERENCE), multisine(), noise=0.0)
    target = TimeTarget.of(record, noise)

    left = nrmse(scored_spectrum(clean.responses) - target.measured, target.measured, target.quantities)

    assert target.nrmse_of_noise == pytest.approx(left, rel=0.05)


def test_a_cut_keeps_the_beginning_and_its_noise():
    target = TimeTarget.of(*measured(Hypothesis(oscillator()), sweep(2048)))

    short = target.cut(500)

    np.testing.assert_array_equal(short.record.responses, target.record.responses[:, :500])
    np.testing.assert_array_equal(short.record.excitation, target.record.excitation[:500])
    np.testing.assert_array_equal(short.measured, scored_spectrum(target.record.responses[:, :500]))
    assert np.all(short.density == target.density[0, 0])
    np.testing.assert_array_equal(short.driven.excitation, target.record.excitation[: 500 + AHEAD])
    assert short.cut(500) is short
    assert target.cut(2048).record.n_samples == 2048 - AHEAD
    decay = replace(target.record, excitation=None)
    assert TimeTarget.of(decay, target.noise).cut(500).record.excitation is None


@pytest.mark.parametrize(
    ("asked", "kept", "at_least"),
    [
        (500, 500, 500),
        (1001, 1000, 1008),
        (1499, 1485, 1500),
        (2031, 2025, 2031),  # 2048 would be the next, and 2032 are all that may be heard
        (2032, 2032, 2032),
        (9999, 2032, 2032),
    ],
)
def test_a_quick_cut_has_no_prime_above_eleven_but_where_all_is_kept(asked, kept, at_least):
    target = TimeTarget.of(*measured(Hypothesis(oscillator()), sweep(2048)))

    assert target.cut_quickly(asked).record.n_samples == kept
    assert target.cut_quickly(asked, at_least=True).record.n_samples == at_least


@pytest.mark.parametrize("seconds", [0.2, 1.0, 4.0])
def test_the_truth_leaves_the_noise_alone_in_however_short_a_part(seconds):
    truth = Hypothesis(REFERENCE)
    evaluator = evaluator_of(measured(truth, multisine(8192, 4), noise=5e-4))

    (residual,) = evaluator.with_targets([evaluator.timed[0].cut(round(seconds * FS))]).residuals([(truth, None)])

    assert np.sqrt(np.mean(residual**2)) == pytest.approx(1.0, abs=0.03)


def test_a_cut_keeps_a_density_where_it_was_in_frequency():
    target = TimeTarget.of(*measured(Hypothesis(oscillator()), sweep(2048)))
    peak = np.ones_like(target.density)
    peak[0, 300:320] = 50.0

    short = replace(target, density=peak).cut(1024)

    assert short.density.shape == short.measured.shape
    assert np.flatnonzero(short.density[0] > 1.0).mean() == pytest.approx(155.0, abs=1.0)


def test_no_channel_is_believed_to_be_without_noise():
    record, _ = measured(Hypothesis(oscillator()), sweep(512), noise=0.0)

    target = TimeTarget.of(record, Noise(np.zeros(1), 0.0, "", ""))

    assert np.all(target.density > 0.0)


def test_noise_of_the_excitation_is_carried_through_the_model():
    rig = oscillator("displacement", freq=150.0, damping_ratio=0.1)
    record, noise = measured(Hypothesis(rig), sweep(4096), noise=1e-4, force_noise=0.02)
    evaluator = evaluator_of((record, noise))

    (target,) = carry_noise(evaluator, Hypothesis(rig), np.random.default_rng(4))

    sensors = evaluator.targets[0].density
    freq = np.arange(sensors.shape[1]) * FS / 4096
    omega, about = 2.0 * np.pi * freq, rig.structure
    gain = 1.0 / np.abs(about.stiffness - about.mass * omega**2 + 1j * about.damping * omega)
    expected = sensors[0] + (gain * noise.excitation) ** 2
    band = (freq > 80.0) & (freq < 220.0)
    assert np.all(target.density >= sensors)
    # 4 realisations of 280 lines: 3 % of the sum, and 1/sqrt(4 x 9) = 17 % of each smoothed line.
    assert target.density[0, band].sum() == pytest.approx(expected[band].sum(), rel=0.1)
    assert freq[np.argmax(target.density[0])] == pytest.approx(150.0, rel=0.1)


def test_without_noise_of_the_excitation_nothing_is_carried():
    evaluator = evaluator_of(measured(Hypothesis(oscillator()), sweep(512)))

    (target,) = carry_noise(evaluator, Hypothesis(oscillator()), np.random.default_rng(4))

    assert target is evaluator.targets[0]


def test_threads_change_nothing():
    truth = Hypothesis(REFERENCE)
    pairs = [measured(truth, multisine(512, seed=k), name=f"run {k}") for k in range(3)]
    hypotheses = [(truth, None), (moved(REFERENCE, *[0.5] * 9), "run 1"), (moved(REFERENCE, *[-0.5] * 9), None)]

    serial = evaluator_of(*pairs, jobs=1).residuals(hypotheses)
    parallel = evaluator_of(*pairs, jobs=2).residuals(hypotheses)

    for one, other in zip(serial, parallel, strict=True):
        np.testing.assert_array_equal(one, other)


def test_only_the_named_record_is_simulated():
    truth = Hypothesis(oscillator())
    evaluator = evaluator_of(*[measured(truth, sweep(512), name=name) for name in ("a", "b")])

    whole, part = evaluator.residuals([(truth, None), (truth, "b")])

    half = evaluator.n_data // 2
    assert np.all(part[:half] == 0.0)
    np.testing.assert_array_equal(part[half:], whole[half:])
    assert evaluator.n_runs == 3


def test_a_motion_without_bound_has_no_residual_and_spoils_no_other():
    rig = oscillator()
    evaluator = evaluator_of(measured(Hypothesis(rig), sweep(512)))
    mad = Hypothesis(rig, values={"damping": -1e6})

    sane, gone = evaluator.residuals([(Hypothesis(rig), None), (mad, None)])

    assert gone is None
    np.testing.assert_array_equal(sane, evaluator.residuals([(Hypothesis(rig), None)])[0])


def test_no_hypotheses_no_residuals():
    assert Evaluator([TimeTarget.of(*measured(Hypothesis(oscillator()), sweep(512)))], 1).residuals([]) == []


def test_noise_of_the_sensors_counts_once_and_that_of_the_force_as_often_as_there_are_channels():
    record, noise = measured(Hypothesis(REFERENCE), multisine(1024))
    own = TimeTarget.of(record, noise)
    shared = replace(own, density=1e6 * own.density)

    assert own.repeats == pytest.approx(1.0)
    assert shared.repeats == pytest.approx(len(record.sensors), rel=1e-4)
    assert Evaluator([own, shared], 1).repeats == pytest.approx((1.0 + len(record.sensors)) / 2.0, rel=1e-4)


def test_a_part_has_the_noise_of_its_own_time():
    """Noise of the force that is carried to the second half only is none of the first half's."""
    evaluator = evaluator_of(measured(Hypothesis(oscillator()), sweep(4096)))
    (target,) = evaluator.timed
    late = np.zeros((4, 1, 4096))
    late[:, :, 2048:] = 100.0 * target.noise.sensors * np.random.default_rng(1).standard_normal((4, 1, 2048))
    loud = target.with_carried(late)

    np.testing.assert_allclose(loud.cut(2000).density, target.cut(2000).density, rtol=1e-9)
    # Half of the record at 100 times the noise: 5000 times its power, some 15 % off with 4 realisations and 9 lines.
    assert np.median(loud.density / target.density) == pytest.approx(5000.0, rel=0.1)
    assert loud.cut(3000).density.mean() < 0.75 * loud.density.mean()
    assert loud.with_noise(loud.noise).carried.size == 0


def test_what_is_not_judged_does_not_count():
    record, noise = let_go(REFERENCE, 20.0)
    target = TimeTarget.of(record, noise, 40)
    other = record.responses.copy()
    other[:, :40] = 1e3

    np.testing.assert_array_equal(target.spectrum(other), target.measured)


@pytest.mark.parametrize("n", [256, 4096])
def test_noise_alone_leaves_as_much_as_is_judged(n):
    record, noise = let_go(REFERENCE, 20.0)
    target = TimeTarget.of(record, noise, 64).cut(n)

    noises = noise.sensors[:, None] * np.random.default_rng(5).standard_normal((len(record.sensors), n))
    left = whitened(target.spectrum(noises), target)

    assert target.n_judged < target.n_data
    assert left @ left == pytest.approx(target.n_judged, rel=0.05)
    assert TimeTarget.of(record, noise).n_judged == TimeTarget.of(record, noise).n_data


@pytest.mark.parametrize("unjudged", [0, 40])
def test_a_constant_that_tells_nothing_changes_nothing(unjudged):
    record, noise = let_go(REFERENCE, 20.0)
    zero = 9.81 * np.array([1.0, *[0.0] * (len(record.sensors) - 1)])[:, None]
    heavy = replace(record, responses=record.responses + zero)
    free = ("acceleration", *["displacement"] * (len(record.sensors) - 1))
    still, off, told = (
        TimeTarget.of(each, noise, unjudged, without)
        for each, without in ((record, free), (heavy, free), (heavy, None))
    )

    # Round-off of 9.81 beside the spectrum of the motion.
    np.testing.assert_allclose(off.measured, still.measured, atol=1e-12 * np.abs(still.measured).max())
    np.testing.assert_allclose(
        off.cut(512).measured, still.cut(512).measured, atol=1e-12 * np.abs(still.measured).max()
    )
    assert np.abs(told.measured[0] - still.measured[0]).max() > 1e3 * np.sqrt(noise.sensors[0])
    np.testing.assert_allclose(off.at_its_zero(record.responses), heavy.responses, rtol=1e-12)
    assert off.n_judged == told.n_judged - 2


def test_an_exchanged_or_missing_channel_takes_its_zero_along():
    record, noise = let_go(REFERENCE, 20.0)
    free = ("acceleration", *["displacement"] * (len(record.sensors) - 1))
    target, (one, other, *_) = TimeTarget.of(record, noise, 0, free), record.sensors

    assert target.exchanged(one, other).without_zero.tolist()[:2] == [False, True]
    assert not target.without(one).without_zero.any()


def test_a_quiet_quantity_counts_beside_a_loud_one():
    """0.3 of two channels in m and 0 of one in m/s^2 are sqrt(2 / 3) of 0.3, whatever the units."""
    rng = np.random.default_rng(4)
    record = Record("mixed", FS, None, ("a", "d", "e"), np.array([[1e3], [1e-3], [2e-3]]) * rng.normal(size=(3, 1024)))
    kinds = ("acceleration", "displacement", "displacement")
    target = TimeTarget.of(record, Noise(0.01 * record.responses.std(axis=1), 0.0, "", ""), quantities=kinds)
    error = np.array([[0.0], [0.3], [0.3]]) * target.measured

    assert target.nrmse_left(whitened(error, target)) == pytest.approx(0.3 * np.sqrt(2.0 / 3.0), rel=1e-12)
    assert target.nrmse_of_noise == pytest.approx(0.01, rel=0.05)  # both are white
    assert target.without("e").quantities == ("acceleration", "displacement")
