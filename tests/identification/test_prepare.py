"""Records made ready: the horizon of chaos, windows within it, and steps fine enough for the noise."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import FS, REFERENCE, evaluator_of, let_go, measured, oscillator, sweep

from identification.calibrate import set_in_motion
from identification.evaluate import AHEAD, Evaluator, TimeTarget, scored_spectrum, whitened
from identification.hypothesis import Hypothesis, OffsetUnknown, StartUnknown
from identification.noise import Noise
from identification.prepare import (
    LEAST_TORN,
    MIN_SAMPLES,
    PREDICTABLE_GROWTH,
    RESOLVED,
    Horizon,
    cut_to,
    followed_long,
    horizons,
    level,
    levels,
    prepare,
    resolved,
    start_unknowns,
)
from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.simulate import Settings


def ueda(force, seconds=400.0, fs=10.0):
    """Ueda's oscillator x'' + 0.05 x' + x^3 = force cos t: chaotic under 7.5, along a line under 0.05."""
    rig = Rig(
        structure=Oscillator(kind="oscillator", mass=1.0, stiffness=0.0, damping=0.05),
        excitation=Excitation(quantity="force"),
        sensors=(Sensor(name="top", quantity="velocity"),),
    )
    time = np.arange(round(seconds * fs)) / fs
    record = Record("ueda", fs, force * np.cos(time), ("top",), np.zeros((1, len(time))))
    noise = Noise(np.ones(1), 0.0, "", "")
    evaluator = Evaluator([TimeTarget.of(record, noise)], 1, Settings(steps_per_sample=20))
    return evaluator, Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=1.0),))


def test_chaos_has_a_horizon_where_its_exponent_says():
    (found,) = horizons(*ueda(7.5))

    # Largest exponent 0.1 1/s (Ueda 1979): a growth of 300 after about 57 s; it fluctuates along the path.
    assert 20.0 < found.seconds < 150.0
    assert found.growth > 1e3 * PREDICTABLE_GROWTH


def test_a_linear_rig_is_predicted_to_the_end():
    evaluator = evaluator_of(measured(Hypothesis(oscillator()), sweep(2048)))

    (found,) = horizons(evaluator, Hypothesis(oscillator()))

    assert (found.record, found.seconds) == ("test", 1.0)
    assert found.growth < 2.0


def test_a_free_decay_is_not_disturbed():
    record, noise = measured(Hypothesis(oscillator()), sweep(1024))

    (found,) = horizons(evaluator_of((replace(record, excitation=None), noise)), Hypothesis(oscillator()))

    assert (found.growth, found.seconds) == (0.0, 0.5)


@pytest.fixture
def three():
    """Records of 1, 2 and 3 s, the longest the quietest."""
    rows = [(2048, 30.0, "short"), (4096, 20.0, "middle"), (6144, 10.0, "long")]
    return evaluator_of(*[measured(Hypothesis(oscillator()), sweep(n, a), name=name) for n, a, name in rows])


def limits_of(evaluator, *seconds):
    return [Horizon(t.record.name, 1.0, s) for t, s in zip(evaluator.targets, seconds, strict=True)]


def lengths(evaluator):
    return {t.record.name: t.record.duration for t in evaluator.targets}


AT_END = AHEAD / FS
"""Seconds at the end of a test that nothing is judged on."""


def test_time_is_shared_and_what_one_leaves_the_others_take(three):
    cut = cut_to(three, 4.5, limits_of(three, 1.0, 0.5, 3.0))

    assert lengths(cut) == pytest.approx({"short": 1.0 - AT_END, "middle": 0.5, "long": 3.0 - AT_END}, abs=1e-3)
    shared = cut_to(three, 2.4, limits_of(three, 1.0, 2.0, 3.0))
    assert {t.record.n_samples for t in shared.targets} == {1620}  # of 1638 each: 2^2 3^4 5 is quickly transformed


def test_nothing_is_kept_beyond_its_horizon(three):
    cut = cut_to(three, float("inf"), limits_of(three, 0.4, 0.5, 0.6))

    # Of 819, 1024 and 1229 samples those that have a quick transform.
    assert {t.record.name: t.record.n_samples for t in cut.targets} == {"short": 810, "middle": 1024, "long": 1225}


def test_a_record_is_never_shorter_than_a_few_waves(three):
    cut = cut_to(three, 0.01, limits_of(three, 1.0, 2.0, 3.0))

    assert {t.record.n_samples for t in cut.targets} == {MIN_SAMPLES}


@pytest.mark.parametrize(("most", "kept"), [(1, {"short"}), (2, {"short", "long"}), (5, {"short", "middle", "long"})])
def test_of_many_records_the_loudest_and_the_quietest_are_kept(three, most, kept):
    assert set(lengths(cut_to(three, 10.0, limits_of(three, 1.0, 2.0, 3.0), most))) == kept


@pytest.mark.parametrize(
    ("seconds", "kept"),
    [
        (10.0, {"middle", "long"}),  # of 0.4, 2 and 3 s
        (0.7, {"short", "middle", "long"}),  # of 0.7 s that are asked for 0.4 are most
    ],
)
def test_effects_in_time_are_looked_for_where_the_motion_can_be_followed_for_long(three, seconds, kept):
    followed, limits = followed_long(three, seconds, limits_of(three, 0.4, 2.0, 3.0))

    assert set(lengths(followed)) == {limit.record for limit in limits} == kept


def test_the_level_is_that_of_the_excitation_or_else_of_the_response():
    record, _ = measured(Hypothesis(oscillator()), sweep(1024))

    assert level(record) == pytest.approx(np.sqrt(np.mean(record.excitation**2)))
    assert level(replace(record, excitation=None)) == pytest.approx(np.sqrt(np.mean(record.responses**2)))


@pytest.mark.parametrize(
    ("quantity", "kinds"),
    [("acceleration", [StartUnknown] * 2), ("displacement", [StartUnknown, StartUnknown, OffsetUnknown])],
)
def test_a_moving_start_is_unknown(quantity, kinds):
    record, _ = measured(Hypothesis(oscillator(quantity)), sweep(512), moving_start=True)

    assert [type(u) for u in start_unknowns(Hypothesis(oscillator(quantity)), [record])] == kinds
    assert start_unknowns(Hypothesis(oscillator(quantity)), [replace(record, moving_start=False)]) == ()


def test_a_sensor_at_the_clamp_says_nothing_of_the_state_at_the_start():
    at_clamp = Sensor(name="clamp", node=1, position=0.0, quantity="acceleration")
    rig = REFERENCE.model_copy(update={"sensors": (*REFERENCE.sensors, at_clamp)})
    record, _ = measured(Hypothesis(REFERENCE), sweep(512), moving_start=True)
    heard = np.vstack([record.responses, 0.01 * record.responses[:1]])
    with_clamp = replace(record, sensors=(*record.sensors, "clamp"), responses=heard)

    scales = [
        [unknown.scale for unknown in start_unknowns(Hypothesis(each), [what])]
        for each, what in ((REFERENCE, record), (rig, with_clamp))
    ]

    assert scales[1] == pytest.approx(scales[0])


def test_what_a_recorder_reads_at_rest_is_no_motion_where_it_accelerates():
    record, _ = measured(Hypothesis(oscillator()), sweep(4096), noise=0.01)
    heavy = replace(record, responses=record.responses + 9.81)
    still, off = (
        prepare(Hypothesis(oscillator()), [each], 1, np.random.default_rng(0)).timed[0] for each in (record, heavy)
    )

    np.testing.assert_allclose(off.measured, still.measured, atol=1e-9 * np.abs(still.measured).max())
    assert off.noise.sensors == pytest.approx(still.noise.sensors, rel=1e-6)


def test_of_driven_records_and_decays_those_are_loud_whose_sensors_are():
    rows = [(1.0, "quiet"), (30.0, "loud"), (10.0, "decay")]
    quiet, loud, decay = (measured(Hypothesis(oscillator()), sweep(512, a), name=name)[0] for a, name in rows)
    found = levels([quiet, loud, replace(decay, excitation=None)])

    assert found == pytest.approx({"quiet": 1.0 / 30.0, "loud": 1.0, "decay": 1.0 / 3.0}, rel=0.05)
    assert levels([quiet, loud])["loud"] == level(loud)


def test_the_start_of_a_mode_above_the_band_is_not_unknown():
    record, _ = measured(Hypothesis(REFERENCE), sweep(512), moving_start=True)
    slow = replace(record, fs=256.0)

    assert len(start_unknowns(Hypothesis(REFERENCE), [slow])) < len(start_unknowns(Hypothesis(REFERENCE), [record]))


def test_steps_are_halved_until_the_noise_hides_them():
    rig = oscillator("velocity")
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=1e12),))
    pair = measured(truth, sweep(1024, amplitude=200.0), noise=1e-4, settings=Settings(steps_per_sample=64))
    coarse = evaluator_of(pair, settings=Settings(steps_per_sample=1))

    fine = resolved(coarse, truth)

    def error(evaluator):
        exact = truth.simulated(pair[0], Settings(steps_per_sample=64)).channels
        there = evaluator.responses(truth)[0].channels
        return np.sqrt(np.mean(whitened(scored_spectrum(there - exact), evaluator.targets[0]) ** 2))

    assert fine.settings.times > 1
    assert error(fine) < RESOLVED < error(coarse)


def test_steps_that_are_fine_enough_stay():
    truth = Hypothesis(oscillator())
    evaluator = evaluator_of(measured(truth, sweep(512), noise=0.05))

    assert resolved(evaluator, truth) is evaluator


def test_steps_are_halved_in_every_record_by_its_own():
    truth = Hypothesis(REFERENCE)
    fast, slow = measured(truth, sweep(1024, amplitude=200.0), noise=1e-4), measured(truth, sweep(256), noise=0.05)
    slow = replace(slow[0], fs=80.0, name="slow"), slow[1]
    coarse = evaluator_of(fast, slow)
    before = [response.steps_per_sample for response in coarse.responses(truth)]

    fine = resolved(coarse, truth)

    assert before[1] > 64  # as many as steps of the fast record ever were
    assert fine.settings.times > 1
    after = [response.steps_per_sample for response in fine.responses(truth)]
    assert after == [fine.settings.times * each for each in before]


def test_preparing_estimates_and_carries_the_noise():
    rig = oscillator()
    record, noise = measured(Hypothesis(rig), sweep(4096), noise=0.01, force_noise=0.01)

    (target,) = prepare(Hypothesis(rig), [record], 1, np.random.default_rng(0)).targets

    assert target.noise.sensors == pytest.approx(noise.sensors, rel=0.15)
    assert target.density.max() > 1.5 * target.density.min()
    assert target.record.fs == FS


def with_quiet_sensors(evaluator):
    """The evaluator with sensors of a thousandth of noise."""
    (target,) = evaluator.timed
    return evaluator.with_targets([replace(target, noise=replace(target.noise, sensors=np.array([1e-3])))])


def with_force_noise(evaluator, share):
    """The evaluator with noise in the force that its record does not hold."""
    (target,) = evaluator.timed
    sigma = share * float(np.std(target.record.excitation))
    return evaluator.with_targets([replace(target, noise=replace(target.noise, excitation=sigma))])


def test_noise_of_the_force_that_grows_ends_what_can_be_predicted():
    """From 1e-3 an exponent of 0.1 1/s makes a tenth in 46 s, before the tangent's growth is 300."""
    evaluator, model = ueda(7.5)
    evaluator = with_quiet_sensors(evaluator)
    (tangent,), (found,) = horizons(evaluator, model), horizons(with_force_noise(evaluator, 1e-3), model)

    assert found.torn > 10.0 * LEAST_TORN
    assert 3.0 < found.seconds < 0.8 * tangent.seconds


def test_noise_of_the_force_that_a_linear_rig_passes_on_ends_nothing():
    evaluator = evaluator_of(measured(Hypothesis(oscillator(damping_ratio=0.002)), sweep(8192)))

    (found,) = horizons(with_force_noise(evaluator, 0.02), Hypothesis(oscillator(damping_ratio=0.002)))

    assert found.torn < 1e-6
    assert found.seconds == evaluator.timed[0].record.duration


def test_a_free_decay_through_impacts_is_followed_as_far_as_its_state_is_not_lost():
    evaluator = evaluator_of(let_go(REFERENCE, 150.0, n=4096))
    unknowns = start_unknowns(Hypothesis(REFERENCE), [target.record for target in evaluator.timed])
    known = set_in_motion(evaluator, Hypothesis(REFERENCE), unknowns)

    (struck,) = horizons(evaluator, known)
    quiet = replace(known, starts={name: 1e-4 * start for name, start in known.starts.items()})
    (free,) = horizons(evaluator, quiet)

    # Without impacts a disturbance stays in proportion; its first window is louder than the decay's mean.
    assert 1.0 < free.growth < 4.0
    assert struck.growth > 2.0 * free.growth
