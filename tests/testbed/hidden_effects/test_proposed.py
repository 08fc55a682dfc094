"""Proposed tests are carried out on the rig as it really is, and what comes of them is told."""

import json
from dataclasses import replace

import numpy as np
import pytest
from made_up_cases import made_up
from quick_cases import FS, no_case, small_case

from identification.next_experiment.planned import PlannedTest
from identification.next_experiment.proposal import Option, Proposal
from models.effects import EFFECTS, Place
from models.errors import InputError
from models.rig import Sensor
from models.simulators.protocol import Resolution
from testbed.cli.app import main
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.proposed import carried_out, carrier, proposed, run_proposed
from testbed.hidden_effects.proposed_page import proposed_page, proposed_summary
from testbed.hidden_effects.proposed_run import run_next_experiments, with_a_group
from testbed.hidden_effects.sets import REPORTED
from testbed.outputs import keep_json

TASK = Task("reported", 1, "point_mass", 0)
MULTISINE = {"kind": "multisine", "low": 8.0, "high": 120.0, "rms": 5.0, "period": 0.5, "periods": 4}
RELEASE = {"kind": "release", "position": 1.2, "force": 20.0, "duration": 1.0}
NOISE = {"P1": 0.02, "P2": 0.03, "P3": 0.04, "P4": 0.05, "excitation": 0.01}


def proposal_of(excitation, rig=None, noise=NOISE):
    test = PlannedTest("do it", "any", excitation, FS, 1.0)
    option = Option(test, 0.99, 5.0, 1.0, test.seconds)
    return Proposal("do it", "to see", test, (option,), 0.9, rig=rig, noise=noise)


def a_case(*hidden, engine="fine"):
    case = small_case(TASK)
    return replace(case, truth=replace(case.truth, hidden=hidden, engine=engine))


def test_the_record_is_of_what_is_really_there():
    mass = EFFECTS["point_mass"](Place(position=0.9), mass=0.5)
    quiet = proposal_of(MULTISINE, noise={})

    with_it, without = (carried_out(case, quiet, "mujoco", Resolution())[1] for case in (a_case(mass), a_case()))

    assert with_it.n_samples == 1024
    np.testing.assert_array_equal(with_it.excitation, without.excitation)
    assert np.std(with_it.responses - without.responses) > 0.05 * np.std(without.responses)


def test_the_noise_is_that_of_the_records_so_far():
    case = a_case()
    noisy, clean = (
        carried_out(case, proposal_of(MULTISINE, noise=noise), "mujoco", Resolution())[1] for noise in (NOISE, {})
    )
    names = (*noisy.sensors, "excitation")
    sizes = [size_of(after - before) for before, after in zip(channels_of(clean), channels_of(noisy), strict=True)]
    np.testing.assert_allclose(sizes, [NOISE[name] for name in names], rtol=0.1)


def channels_of(record):
    return (*record.responses, record.excitation)


def size_of(noise):
    """Rms that noise has if it is as dense everywhere as below a quarter of the rate, where the recorder passes all."""
    dense = np.abs(np.fft.rfft(noise)[1 : len(noise) // 4]) ** 2
    return np.sqrt(np.mean(dense) / len(noise))


def test_a_rig_that_is_let_go_has_no_excitation_and_a_new_sensor_reads():
    case = a_case()
    more = (*case.rig.sensors, Sensor(name="P5", node=5, position=0.15))
    rig, record = carried_out(
        case, proposal_of(RELEASE, case.rig.model_copy(update={"sensors": more})), "mujoco", Resolution()
    )
    assert record.excitation is None
    assert record.sensors == tuple(sensor.name for sensor in rig.sensors) == ("P1", "P2", "P3", "P4", "P5")
    assert np.std(record.responses[-1]) > 0.0


def test_the_cases_own_simulator_comes_first_and_what_none_carries_is_said():
    drift = EFFECTS["stiffness_drift"](Place(), rate=-0.01)
    assert carrier(a_case(engine="exudyn").truth, held=False)[0] == "exudyn"
    assert carrier(a_case(engine="exudyn").truth, held=True)[0] == "exudyn"
    assert carrier(a_case(drift).truth, held=False)[0] == "fine"
    assert carrier(a_case().truth, held=True)[0] == "mujoco"
    assert carrier(a_case(drift).truth, held=True) is None


def test_finite_elements_shake_where_the_test_says_as_a_simulator_does():
    mass = EFFECTS["point_mass"](Place(position=0.9), mass=0.5)
    for elsewhere in ({}, {"position": 0.5}):
        quiet = proposal_of(MULTISINE | elsewhere, noise={})
        own, other = (carried_out(a_case(mass), quiet, name, Resolution())[1] for name in ("fine", "mujoco"))

        assert own.excitation_position == other.excitation_position
        np.testing.assert_array_equal(own.excitation, other.excitation)
        assert size_of_difference(own, other) < 0.02


def size_of_difference(own, other):
    return np.linalg.norm(own.responses - other.responses) / np.linalg.norm(other.responses)


@pytest.mark.slow
def test_where_no_group_is_stated_nothing_is_tested():
    content = proposed(small_case(Task("reported", 1, "nothing", 3)), 1)
    assert content["outcome"] == "no group"
    assert content["before"]["verdict"] == "complete"
    assert content["before"]["right"]
    assert "after" not in content


def test_a_crash_is_a_result():
    assert run_proposed(TASK, draw=no_case)["failure"] == f"ArithmeticError: {TASK.name} cannot be drawn"


GROUP = [{"kind": "point_mass", "position": 0.5}, {"kind": "absorber", "position": 0.5}]


def came_of(number, outcome, separation=3.0, probability=0.97):
    stated = {"verdict": "missing_effect", "right": True, "in_group": True, "probability": 0.6, "effects": GROUP[:1]}
    case = {**Task("reported", 1, "point_mass", number).about, "hidden": GROUP[:1], "outcome": outcome}
    case["before"] = {**stated, "indistinguishable": [GROUP]}
    if outcome == "no group":
        return case
    promise = {"do": "shake it", "minutes": 1.5, "separation": separation, "expected_probability": 0.95}
    right = outcome != "wrong"
    groups = [GROUP] if outcome == "still open" else []
    after = {**stated, "right": right, "probability": probability, "indistinguishable": groups}
    return {**case, "proposal": {**promise, "present_probability": 0.55}, "simulator": "mujoco", "after": after}


def test_tests_that_part_are_counted_apart_from_those_that_cannot():
    rows = [
        came_of(0, "told apart"),
        came_of(1, "wrong"),
        came_of(2, "still open", separation=0.1),
        came_of(3, "no group"),
    ]
    crashed = Task("reported", 1, "point_mass", 4).about | {"failure": "ValueError: nobody knows"}

    summary = proposed_summary([*rows, crashed])

    assert summary["outcomes"] == {
        "told apart": 1, "still open": 1, "wrong": 1, "no group": 1, "no test": 0, "no simulator": 0,
    }  # fmt: skip
    parted, other = summary["promised to settle it"], summary["promised less"]
    assert (parted["cases"], other["cases"]) == (2, 1)
    assert parted["promised"] == pytest.approx(0.95)
    assert parted["reached"] == pytest.approx(0.97 / 2)
    page = proposed_page(summary, "testbed")
    assert "| promised to settle it | 2 | 1 | 0 | 1 | 0.550 | 0.950 | 0.485 |" in page
    assert "point_mass at 0.5 m, absorber at 0.5 m" in page
    assert "`reported-1-point_mass-4` failed: ValueError: nobody knows." in page


def with_group(number, groups, **more):
    case = made_up("point_mass", number, **more)
    return case | {"diagnosis": case["diagnosis"] | {"indistinguishable": groups}}


def test_cases_with_a_stated_group_are_run_once(tmp_path):
    for case in (with_group(0, [GROUP]), with_group(1, []), with_group(2, [GROUP])):
        keep_json(tmp_path / "all" / "cases" / f"{case['case']}.json", case)
    tasks = with_a_group(tmp_path / "all")
    assert [task.number for task in tasks] == [0, 2]
    told = []

    def work(todo, run, threads):
        return ((task, run(task, threads)) for task in todo)

    def again():
        return run_next_experiments(
            tasks, tmp_path / "out", work, threads=1, command=["testbed"], progress=told.append,
            run=lambda task, _: came_of(task.number, "told apart") | task.about,
        )  # fmt: skip

    assert again()["outcomes"]["told apart"] == 2
    assert again()["cases"] == 2
    assert told[-1] == "2 of 2 cases are there, 0 to do"
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["promised to settle it"]["cases"] == 2
    assert (tmp_path / "out" / "README.md").read_text().startswith("# The next experiment")


def test_the_newest_batch_is_taken_first(tmp_path):
    seeds = list(REPORTED.batches)
    for seed in (1, seeds[0], seeds[-1], seeds[-2]):
        case = with_group(0, [GROUP], seed=seed)
        keep_json(tmp_path / "cases" / f"{case['case']}.json", case)
    assert [task.seed for task in with_a_group(tmp_path)] == [seeds[-1], seeds[-2], seeds[0], 1]


def test_those_whose_test_was_to_settle_it_come_before_all_others(tmp_path):
    for number, separation in enumerate((0.2, 4.0, None)):
        case = with_group(number, [GROUP])
        if separation is not None:
            case["diagnosis"]["next_experiment"] = {"separation": separation, "expected_probability": 0.99}
        keep_json(tmp_path / "cases" / f"{case['case']}.json", case)
    assert [task.number for task in with_a_group(tmp_path)] == [1, 0, 2]


@pytest.mark.parametrize(("outcome", "status"), [("told apart", 0), ("still open", 0), ("wrong", 1), (None, 1)])
def test_a_test_that_misleads_or_a_case_that_fails_is_told_by_the_exit_status(outcome, status, tmp_path, monkeypatch):
    keep_json(tmp_path / "cases" / "one.json", with_group(0, [GROUP]))

    case = came_of(0, outcome) if outcome else {"case": "reported-1-wear-0", "failure": "stopped"}
    summary = proposed_summary([case])
    monkeypatch.setattr("testbed.hidden_effects.proposed_run.run_next_experiments", lambda *_, **__: summary)
    assert main(["benchmark", "next-experiments", str(tmp_path), "--out", str(tmp_path / "out")]) == status


def test_a_folder_without_groups_is_refused(tmp_path, capsys):
    with pytest.raises(InputError, match=r"0 finished cases, none with a stated group; a folder of .*; name the"):
        with_a_group(tmp_path)
    assert main(["benchmark", "next-experiments", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "none with a stated group" in capsys.readouterr().err
