"""Who runs the cases: processes that may die, and a cluster whose workers may."""

import json
import os
import signal
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from multiprocessing import get_context

import psutil
import pytest
from distributed import LocalCluster
from quick_cases import deadly_once, no_case, real_and_small, slow, told

from models.errors import InputError
from testbed.cli.app import main
from testbed.hidden_effects.case_run import run_case
from testbed.hidden_effects.cluster import on_cluster
from testbed.hidden_effects.crew import on_this_machine
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.run import path_of, run_hidden_effects

TASKS = [Task("tuning", 11, "nothing", number) for number in range(3)]


def test_a_process_that_dies_loses_its_own_case_only():
    done = dict(on_this_machine(2)(TASKS, deadly_once, 3))
    assert "its process ended with status 7" in done[TASKS[1]]["failure"]
    assert done[TASKS[0]]["threads"] == done[TASKS[2]]["threads"] == 3
    assert done[TASKS[0]]["pid"] != done[TASKS[2]]["pid"] != os.getpid()


def all_for_ever(folder):
    list(on_this_machine(2)(TASKS, partial(told, folder), 1))


def test_the_cases_of_a_killed_run_end_with_it(tmp_path):
    run = get_context("spawn").Process(target=all_for_ever, args=(tmp_path,))
    run.start()
    while len([file for file in tmp_path.iterdir() if file.read_text()]) < 2:
        time.sleep(0.05)
    working = [psutil.Process(int(file.read_text())) for file in tmp_path.iterdir()]
    run.kill()
    run.join()
    _, alive = psutil.wait_procs(working, timeout=30.0)
    assert alive == []


def test_a_case_that_fails_is_told_with_where_it_did():
    case = run_case(TASKS[0], draw=no_case)
    assert case["failure"] == "ArithmeticError: tuning-11-nothing-0 cannot be drawn"
    assert case["where"][-1].startswith("quick_cases.py:")


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, worker_dashboard_address=None
    ) as cluster:
        yield cluster


def pids(cluster):
    return {worker.pid for worker in cluster.workers.values() if worker.pid}


def kill_the_first_at_work(begun):
    """The process that begins a case first, once it has."""
    until = time.monotonic() + 60.0
    while not (files := list(begun.iterdir())):
        assert time.monotonic() < until, "no case was begun"
        time.sleep(0.01)
    victim = int(files[0].name.split()[-1])
    os.kill(victim, signal.SIGKILL)
    return victim


def test_the_command_runs_real_cases_on_a_cluster_of_which_a_worker_is_killed(cluster, monkeypatch, tmp_path):
    begun, out = tmp_path / "begun", tmp_path / "out"
    begun.mkdir()
    asked = partial(run_hidden_effects, run=partial(real_and_small, begun))
    monkeypatch.setattr("testbed.hidden_effects.run.run_hidden_effects", asked)
    order = ["--set", "tuning", "--only", "nothing", "--cases", "2", "--scheduler", cluster.scheduler_address]

    with ThreadPoolExecutor(1) as beside:
        killing = beside.submit(kill_the_first_at_work, begun)
        assert main(["benchmark", "hidden-effects", *order, "--out", str(out)]) == 1  # two cases meet no bar of 200

    assert killing.result() not in pids(cluster)
    times_begun = Counter(file.name.split()[0] for file in begun.iterdir())
    assert set(times_begun) == {task.name for task in TASKS[:2]}
    assert max(times_begun.values()) > 1
    for case in [json.loads(path_of(out, task).read_text()) for task in TASKS[:2]]:
        assert case["judged"]["right"], case
        assert any(decision.startswith("complete") for decision in case["decisions"])
        assert case["held_out"]["after"] == pytest.approx(1.0, abs=0.15)  # 512 samples tell a perfect model no better


def test_what_a_killed_worker_was_at_is_done_by_another(cluster):
    tasks = [Task("tuning", 11, "nothing", number) for number in range(6)]
    work = on_cluster(cluster.scheduler_address)(tasks, slow, 1)
    (first, case) = next(work)
    before = pids(cluster)
    victim = next(pid for pid in before if pid != case["pid"])
    os.kill(victim, signal.SIGKILL)
    done = {first: case, **dict(work)}
    assert set(done) == set(tasks)
    assert not [case for case in done.values() if "failure" in case]
    while len(pids(cluster)) < len(before):
        time.sleep(0.1)
    assert victim not in pids(cluster)


def test_a_scheduler_that_does_not_answer_is_refused(monkeypatch):
    monkeypatch.setattr("testbed.hidden_effects.cluster.ANSWER", "1 s")
    with pytest.raises(InputError, match=r"--scheduler tcp://127.0.0.1:9: .*; .*that answers.*; start one with"):
        list(on_cluster("tcp://127.0.0.1:9")(TASKS, no_case, 1))
