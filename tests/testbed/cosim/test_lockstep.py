"""Plant, identifier and twin together: what is found, what feedback does, and what it costs."""

import numpy as np
import pytest
from cosim_scenes import REFERENCE, silent, varying

from models import live
from models.errors import InputError
from testbed.cosim.lockstep import run_in_lockstep
from testbed.cosim.measures import effect_of, measures_of
from testbed.cosim.plan import Wish, plan_of
from testbed.cosim.run import findings
from testbed.figures.cosim import cosim_figure

STEP = varying((0.0, 1.5, 1.501), (80.0, 80.0, 40.0))


def ran(rig, **wish):
    plan = plan_of(rig, Wish(**wish))
    run = run_in_lockstep(plan, silent)
    return plan, run, measures_of(plan, run)


@pytest.fixture(scope="module")
def ramp():
    return ran(varying((0.0, 4.0), (80.0, 112.0)), seconds=4.0)


@pytest.fixture(scope="module")
def step():
    return ran(STEP, seconds=3.0)


def test_a_ramp_is_identified_and_followed(ramp):
    plan, run, measures = ramp
    got = run.exchanges
    assert measures.identified < 0.01  # 0.3 % at 40 dB, by the estimates' own standard deviations
    assert 0.5 < np.std((got.values - plan.true_damping(got.times)) / got.stds) < 1.5
    assert measures.coverage > 0.85  # windows overlap: some twenty of these are independent
    assert measures.told < 0.1 * measures.alone


def test_what_is_fed_back_is_late_by_the_age_of_the_windows(ramp):
    plan, _, measures = ramp
    # On a line the delay that aligns best is the mean age, up to noise of 0.3 N s/m on 8 N s/m a second.
    assert measures.aligned_lag == pytest.approx(measures.lag, abs=0.04)
    assert plan.window / 2.0 < measures.lag < plan.taps.period + plan.window
    slope = 8.0
    told = measures.moved_times >= measures.first_exchange
    assert np.mean(measures.moved_error[told]) == pytest.approx(-slope * measures.lag, abs=0.1)


def test_an_exchange_acts_after_what_it_speaks_for(ramp):
    _, run, _ = ramp
    got = run.exchanges
    assert (np.diff(got.acts) > 0.0).all()
    assert (got.acts - got.times > run.latency / 2.0).all()


def test_a_step_is_followed_within_two_taps(step):
    plan, _, measures = step
    late = measures.moved_times > 1.5 + 2.0 * plan.taps.period
    before = measures.moved_times < 1.5
    assert np.abs(measures.moved_error[late | before]).max() < 4.0  # ten standard deviations, of 40
    at = np.argmax(np.abs(measures.moved_error) > 20.0)
    assert 1.5 <= measures.moved_times[at] < 1.6


@pytest.fixture
def step_finely(monkeypatch):
    """Met far below what twin and truth are compared by: a table is iterated for, and a plain dashpot met at once."""
    monkeypatch.setattr(live, "FORCE_TOLERANCE", 1e-12)
    return ran(STEP, seconds=3.0)


def test_without_feedback_the_twin_stays_wrong(step_finely):
    plan, run, measures = step_finely
    after = measures.times > 1.5 + 4.0 * plan.taps.period
    assert measures.alone_over_time[after].min() > 0.1
    assert measures.told_over_time[after].max() < 0.03
    assert measures.alone_over_time[measures.times < 1.3].max() < 1e-9  # the same model under the same force
    assert run.power.shape == run.told.shape == run.alone.shape == (plan.n_samples // plan.hop, 8)


def test_the_effect_has_few_knots_and_is_the_truth(ramp, step):
    plan, run, _ = ramp
    effect = effect_of(plan, run.exchanges)
    assert len(effect.times) == 2
    times = np.linspace(effect.times[0], effect.times[-1], 20)
    np.testing.assert_allclose(np.interp(times, effect.times, effect.values), 80.0 + 8.0 * times, rtol=0.005)
    assert len(effect_of(step[0], step[1].exchanges).times) == 4


@pytest.fixture(scope="module")
def wrong():
    return ran(REFERENCE, seconds=2.0, start=25.0)


def test_a_twin_that_begins_wrong_is_put_right(wrong):
    _, run, measures = wrong
    assert measures.aligned_lag is None
    assert abs(run.exchanges.values[-1] - 80.0) < 2.0
    assert measures.told_over_time[-1] < 0.01 < measures.alone_over_time[-1]


def test_a_wrong_start_counts_over_the_whole_run_and_not_as_fed_back(wrong):
    _, run, measures = wrong
    first = run.exchanges.acts[0]
    assert (measures.first_exchange, measures.start) == (first, pytest.approx(25.0))
    assert measures.moved_times[0] == 0.0
    # the table of modes over damping has the own one to 1e-7
    assert np.abs(measures.moved_error[measures.moved_times < first] + 55.0).max() < 1e-5
    assert measures.fed_back < 0.02
    # an error of 55 in 80 for the first of 2 s, and what was fed back after it
    expected = np.hypot(55.0 / 80.0 * np.sqrt(first / 2.0), measures.fed_back * np.sqrt(1.0 - first / 2.0))
    assert measures.moved_with == pytest.approx(expected, rel=0.02)  # the grid of an eighth of a hop


def test_the_picture_holds_the_start_and_the_largest_error(wrong):
    plan, run, measures = wrong
    top, middle, _ = cosim_figure(plan, run, measures).axes
    (moved,) = (line for line in top.get_lines() if str(line.get_label()).startswith("what the twin moves with"))
    assert (moved.get_xdata()[0], moved.get_ydata()[0]) == (0.0, pytest.approx(25.0))
    assert top.get_ylim()[0] < 25.0
    low, high = middle.get_ylim()
    assert low < measures.moved_error.min() < measures.moved_error.max() < high
    assert low < (run.exchanges.bounds - 80.0).min() < (run.exchanges.bounds - 80.0).max() < high


def test_the_seed_makes_the_noise():
    first, same, other = (ran(REFERENCE, seconds=1.0, seed=seed)[1].exchanges.values for seed in (0, 0, 1))
    np.testing.assert_array_equal(first, same)
    assert np.abs(first[-1] - other[-1]) > 0.0


def test_less_noise_is_less_error():
    errors = [ran(REFERENCE, seconds=2.0, snr=snr)[2].identified for snr in (20.0, 40.0, 60.0)]
    # Errors fall with the noise, by ten for 20 dB, as far as the samples of 2 s tell.
    assert errors[0] > 4.0 * errors[1] > 16.0 * errors[2]


def test_a_damping_that_changes_within_windows_is_said_and_hardly_any_noise_is_not():
    times = [0.1 * i for i in range(20)]
    _, quick, _ = ran(varying(times, [80.0, 200.0] * 10), seconds=2.0)
    assert len(findings(quick)) == 1
    assert findings(quick)[0].startswith("in ")
    _, exact, _ = ran(REFERENCE, seconds=1.0, snr=100.0)
    assert exact.exchanges.contradicted.any()  # the stepper's own error stands out
    assert findings(exact) == []


def test_it_runs_faster_than_it_happens(ramp):
    _, run, measures = ramp
    assert measures.real_time_factor > 1.0  # 5 on one core of two; the machine may be busy
    assert measures.shares.sum() == pytest.approx(1.0)
    assert run.seconds.shape[1] == 3


def test_a_run_in_which_nothing_stands_out_is_refused():
    plan = plan_of(REFERENCE, Wish(seconds=0.1))
    with pytest.raises(InputError, match=r"a run of 0.0977 s at 40 dB, in which no mode .*; a window .*; run longer"):
        run_in_lockstep(plan, silent)
