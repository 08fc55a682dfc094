"""A process beside this one does what it can, and what it cannot is done here."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from math import factorial, sqrt
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from identification.companion import Companion, Work

ROOT = Path(__file__).parents[2]
PID = "__import__('os').getpid()"
PATIENCE = 60.0
"""Seconds until it is given up that a process begins, or ends."""


def ready(companion):
    until = time.monotonic() + PATIENCE
    while not companion.is_ready:
        assert time.monotonic() < until, "the companion did not begin"
        time.sleep(0.02)
    return companion


@pytest.fixture(scope="module")
def companion():
    companion = ready(Companion())
    yield companion
    companion.end()


def is_there(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_it_works_in_another_process(companion):
    assert companion.do(Work(factorial), [5]) == [120]
    (pid,) = companion.do(Work(eval), [PID])
    assert pid != os.getpid()


def test_what_fails_there_is_left_to_who_asked(companion):
    assert companion.do(Work(sqrt), [-1.0]) is None
    assert companion.do(Work(sqrt), [4.0]) == [2.0]


def test_what_it_prints_does_not_mix_with_what_it_answers(companion):
    assert companion.do(Work(print), ["aside"]) == [None]
    assert companion.do(Work(factorial), [3]) == [6]


@pytest.mark.parametrize("there", [True, False], ids=["cannot be sent", "cannot be read there"])
def test_what_does_not_arrive_costs_itself_alone(companion, monkeypatch, there):
    script = ModuleType("script_of_a_user")
    script.Own = type("Own", (int,), {"__module__": script.__name__})
    monkeypatch.setitem(sys.modules, script.__name__, script)
    item = (lambda: None) if there else script.Own(3)
    work = Work(partial(isinstance, np.zeros(100)))

    assert companion.do(work, [item]) is None
    assert companion.do(work, [np.ndarray, list]) == [True, False]
    assert companion.do(work, [np.ndarray]) == [True]


def test_what_cannot_come_back_is_left_to_who_asked(companion):
    assert companion.do(Work(iter), [[1, 2]]) is not None
    assert companion.do(Work(eval), ["lambda: 0"]) is None
    assert companion.do(Work(factorial), [3]) == [6]


def test_one_that_was_killed_leaves_the_work_to_who_asked():
    companion = ready(Companion())
    (pid,) = companion.do(Work(eval), [PID])

    os.kill(pid, signal.SIGTERM)

    assert companion.do(Work(factorial), [5]) is None
    assert not companion.is_ready


def test_where_there_is_no_python_to_begin_the_system_says_so(monkeypatch):
    monkeypatch.setattr(sys, "executable", None)
    with pytest.raises(OSError, match="no Python"):
        Companion()


def test_where_no_process_can_be_begun_the_system_says_so(monkeypatch):
    monkeypatch.setattr(sys, "executable", str(ROOT / "no python here"))
    with pytest.raises(OSError, match="no python here"):
        Companion()


@pytest.mark.parametrize("busy", [False, True])
def test_one_whose_caller_was_killed_ends(tmp_path, busy):
    script = tmp_path / "caller.py"
    script.write_text(
        "import os, time\n"
        "from functools import partial\n"
        "from identification.companion import Companion, Work\n"
        "companion = Companion()\n"
        "while not companion.is_ready:\n"
        "    time.sleep(0.02)\n"
        "print(*companion.do(Work(eval), [\"__import__('os').getpid()\"]), flush=True)\n"
        f"companion.do(Work(time.sleep), [600]) if {busy} else time.sleep(600)\n"
    )
    caller = subprocess.Popen(
        [sys.executable, script], stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": str(ROOT)}, text=True
    )
    with caller:
        pid = int(caller.stdout.readline())
        time.sleep(0.5)
        caller.kill()

    until = time.monotonic() + PATIENCE
    while is_there(pid):
        assert time.monotonic() < until, "the companion went on without its caller"
        time.sleep(0.05)
