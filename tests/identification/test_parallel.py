"""The same results in the same order, wherever they come from."""

import os
import signal
import subprocess
import sys
import time
from math import sqrt
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, moved, multisine

from identification import parallel
from identification.evaluate import FEW
from identification.hypothesis import Hypothesis
from identification.parallel import in_parallel, in_threads
from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness

ROOT = Path(__file__).parents[2]
PID = "(__import__('time').sleep(0.01), __import__('os').getpid())[1]"
PATIENCE = 60.0
"""Seconds until it is given up that a companion begins."""


@pytest.fixture
def companions(monkeypatch):
    """Waits until each of so many cores is at work; companions that other tests may have lost are not used."""
    parallel._pool.cache_clear()

    def begun(jobs):
        until = time.monotonic() + PATIENCE
        while len(found := set(in_parallel(jobs, eval, [PID] * 10 * jobs))) < jobs:
            assert time.monotonic() < until, "all was done in this process"
        assert os.getpid() in found

    yield begun
    parallel._pool.cache_clear()


@pytest.mark.parametrize("jobs", [1, 2, 3])
@pytest.mark.parametrize("alike", [True, False])
@pytest.mark.parametrize("n", [0, 1, 2, 50])
def test_results_are_in_order(jobs, alike, n):
    assert in_parallel(jobs, sqrt, range(n), alike=alike) == [sqrt(k) for k in range(n)]


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_threads_give_results_in_order_and_the_first_error(jobs):
    for n in (0, 1, 50):
        assert in_threads(jobs, lambda k: -k, range(n)) == [-k for k in range(n)]
    with pytest.raises(ValueError, match="'one'"):
        in_threads(jobs, int, ["4", "one", "two", "3"])


def test_two_threads_are_at_work_at_the_same_time():
    met = Barrier(2, timeout=5.0)
    assert sorted(in_threads(2, lambda _: met.wait(), range(2))) == [0, 1]


def test_companions_take_their_share(companions):
    companions(3)


def test_what_cannot_be_sent_is_done_in_threads(companions):
    companions(2)
    seen = []
    assert in_parallel(2, lambda item: seen.append(item) or -item, range(20)) == [-k for k in range(20)]
    assert sorted(seen) == list(range(20))
    companions(2)


@pytest.mark.parametrize("jobs", [1, 2])
def test_the_first_that_fails_says_why(companions, jobs):
    companions(jobs)
    for _ in range(5):
        with pytest.raises(ValueError, match="'one'"):
            in_parallel(jobs, int, ["4", "one", "two", "3"] * 5)


@pytest.mark.parametrize("n", [1, 3, 2 * FEW + 1])
def test_cores_do_not_change_a_residual(companions, n):
    records = [measured(Hypothesis(REFERENCE), multisine(seed=k), name=f"test {k}") for k in range(2)]
    evaluator = evaluator_of(*records)
    size = len(REFERENCE.parameters())
    near = [moved(REFERENCE, *(0.1 * k * (i == 0) for i in range(size))) for k in range(n)]
    spring = CubicStiffness(Place(position=1.0), stiffness=1e6)
    asked = [(each, None) for each in near] + [(near[0].with_effects(spring), "test 1")]
    asked.append((near[0].with_effects(CubicStiffness(Place(position=1.0), stiffness=-1e12)), None))
    companions(2)

    one, two = (evaluator.with_jobs(jobs).residuals(asked) for jobs in (1, 2))

    assert one[-1] is None
    assert two[-1] is None
    assert np.array_equal(np.array(one[:-1]), np.array(two[:-1]))
    assert not one[-2][: evaluator.targets[0].n_data].any()


def test_an_interrupt_ends_it(tmp_path):
    script = tmp_path / "caller.py"
    script.write_text(
        "import signal, time\n"
        "from identification.parallel import in_parallel\n"
        # Whoever runs the tests in the background may have had interrupts ignored, which is inherited.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "print('begun', flush=True)\n"
        "in_parallel(2, time.sleep, [0.1] * 6000)\n"
    )
    caller = subprocess.Popen(
        [sys.executable, script],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        caller.stdout.readline()
        time.sleep(1.0)
        caller.send_signal(signal.SIGINT)
        _, told = caller.communicate(timeout=PATIENCE)
    finally:
        caller.kill()

    assert told.rstrip().endswith("KeyboardInterrupt")


def test_a_script_without_a_guard_runs_once(tmp_path):
    script = tmp_path / "caller.py"
    script.write_text(
        "import os\n"
        "from identification.parallel import in_parallel\n"
        "class Own(float):\n"
        "    pass\n"
        f"while len(set(in_parallel(2, eval, [{PID!r}] * 20))) < 2:\n"
        "    pass\n"
        "print(sum(in_parallel(2, float, [Own(2.0)] * 50)))\n"
    )

    found = subprocess.run(
        [sys.executable, script],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
        timeout=2 * PATIENCE,
    )

    assert (found.stdout, found.stderr) == ("100.0\n", "")
