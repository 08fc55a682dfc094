"""Planned tests: what they cost, and that an experiment file makes the very signal that was weighed."""

from dataclasses import replace

import numpy as np
import pytest
from rival_scenes import bench_of

from identification.next_experiment import candidates
from identification.next_experiment.costs import COSTS, LIMITS
from identification.next_experiment.planned import SEED
from testbed.virtual.campaign import runs_of
from testbed.virtual.experiment import Experiment
from tests.identification.trial_records import REFERENCE, oscillator

BENCH = bench_of(REFERENCE, 0.02, rms=3.0)
ALL = [
    *candidates.at_the_shaker(BENCH, COSTS),
    *candidates.elsewhere(BENCH, COSTS),
    *candidates.in_bands(BENCH, COSTS, {"low": (10.0, 40.0)}),
    *candidates.with_a_sensor(BENCH, COSTS, 0.75),
    *candidates.struck(BENCH, COSTS),
    *candidates.released(BENCH, COSTS),
]


@pytest.mark.parametrize("test", ALL, ids=lambda test: test.words)
def test_an_experiment_file_makes_the_signal_that_was_weighed(test):
    (run,) = runs_of(Experiment.model_validate({"fs": test.fs, "seed": SEED, "excitation": test.excitation}), REFERENCE)
    record = test.record("next", BENCH.sensors)
    if test.is_held:
        hold = run.trial.hold
        assert (hold.position, hold.force) == (test.excitation["position"], test.excitation["force"])
        assert not run.driven
        assert record.moving_start
        return
    assert np.array_equal(run.trial.excitation, record.excitation)
    assert run.trial.position == record.excitation_position


def test_a_few_dozen_tests_are_within_reach():
    assert 30 <= len(ALL) <= 60
    assert {test.excitation["kind"] for test in ALL} == {"multisine", "sweep", "hammer", "release"}
    assert len({test.words for test in ALL}) == len(ALL)


def test_moving_the_shaker_costs_more_than_turning_a_knob():
    louder = candidates.steady(BENCH, COSTS, 2.0, BENCH.band, "level")
    (moved, *_) = candidates.elsewhere(BENCH, COSTS)
    assert louder.minutes == pytest.approx(1.0 + 2.0 / 60.0)
    assert moved.minutes - louder.minutes == pytest.approx(COSTS.shaker - COSTS.setting)


def test_a_part_of_a_steady_test_is_its_beginning():
    test = candidates.steady(BENCH, COSTS, 1.0, BENCH.band, "level", longer=4)
    whole, part = test.record("next", ()), test.record("next", (), 2.0)
    assert test.seconds == 8.0
    assert whole.excitation[: part.n_samples] == pytest.approx(part.excitation)


def test_a_force_far_beyond_those_so_far_is_not_allowed():
    assert candidates.allowed(candidates.steady(BENCH, COSTS, 2.0, BENCH.band, ""), BENCH, LIMITS)
    assert not candidates.allowed(candidates.steady(BENCH, COSTS, 8.0, BENCH.band, ""), BENCH, LIMITS)


def test_where_nothing_drove_the_rig_only_blows_and_holds_are_left():
    silent = replace(BENCH, level=0.0)
    assert not [*candidates.at_the_shaker(silent, COSTS), *candidates.elsewhere(silent, COSTS)]
    assert list(candidates.struck(silent, COSTS))


def test_an_oscillator_has_no_places():
    bench = bench_of(oscillator(), 0.01)
    assert not [*candidates.elsewhere(bench, COSTS), *candidates.released(bench, COSTS), *candidates.between(bench)]
    (blow,) = candidates.struck(bench, COSTS)
    assert "position" not in blow.excitation


def test_one_more_sensor_sits_where_there_is_none():
    taken = [sensor.position for sensor in REFERENCE.sensors]
    spots = candidates.between(BENCH)
    assert spots
    assert min(abs(x - y) for x in spots for y in taken) > 0.05 * REFERENCE.structure.length
    more = BENCH.with_sensor(spots[0])
    assert (more.sensors[-1], len(more.noise)) == (more.rig.sensors[-1].name, 9)
    assert more.rig.sensors[-1].node not in [*(s.node for s in REFERENCE.sensors), REFERENCE.excitation.node]


def test_a_blow_is_made_as_hard_as_asked_in_round_numbers():
    blow = candidates.scaled(next(iter(candidates.struck(BENCH, COSTS))), 123.4)
    assert blow.excitation["peak"] == 120.0
    assert "120 N" in blow.words


@pytest.mark.parametrize("fs", [666.67, 610.3515625, 2048.0])
def test_a_multisine_is_made_at_any_rate(fs):
    bench = replace(bench_of(REFERENCE, 0.01), fs=fs)
    for test in candidates.at_the_shaker(bench, COSTS):
        assert candidates.allowed(test, bench, replace(LIMITS)) in (True, False)


def test_where_all_is_at_the_shaker_there_is_nowhere_else():
    tip = REFERENCE.structure.length
    sensors = (REFERENCE.sensors[0].model_copy(update={"position": tip}),)
    excitation = REFERENCE.excitation.model_copy(update={"position": tip})
    alone = REFERENCE.model_copy(update={"sensors": sensors, "sleeves": (), "excitation": excitation})
    bench = replace(bench_of(REFERENCE, 0.01), rig=alone)
    assert candidates.places(bench) == []
    assert list(candidates.elsewhere(bench, COSTS)) == []
