"""Work on several cores gives what work on one gives."""

import os
import signal
from concurrent.futures.process import BrokenProcessPool
from functools import partial

import pytest

from testbed.processes import as_done, processes


def share(whole, part):
    """A part of a whole, and who worked it out."""
    return part / whole, os.getpid()


@pytest.mark.parametrize("jobs", [1, 2])
def test_each_item_comes_back_with_what_came_of_it(jobs):
    done = dict(as_done(partial(share, 10.0), [1, 2, 5], jobs))

    assert {part: result for part, (result, _) in done.items()} == {1: 0.1, 2: 0.2, 5: 0.5}
    assert {process == os.getpid() for _, process in done.values()} == {jobs == 1}


def test_a_single_item_needs_no_process_unless_there_is_a_pool():
    ((_, (_, process)),) = as_done(partial(share, 1.0), [1], 2)
    assert process == os.getpid()

    with processes(1) as pool:
        ((_, (_, process)),) = as_done(partial(share, 1.0), [1], 1, pool)
    assert process != os.getpid()


def test_what_fails_is_raised():
    with pytest.raises(ZeroDivisionError):
        list(as_done(partial(share, 0.0), [1, 2], 2))


def test_an_interrupt_ends_a_process_without_a_traceback(capfd):
    with processes(1) as pool:
        running = pool.submit(os.kill, pool.submit(os.getpid).result(), signal.SIGINT)
        with pytest.raises(BrokenProcessPool):
            running.result()
    assert capfd.readouterr().err == ""


def test_an_interrupt_while_a_process_begins_ends_it_without_a_traceback(capfd):
    with processes(1) as pool:
        running = pool.submit(os.getpid)
        (begun,) = pool._processes
        os.kill(begun, signal.SIGINT)
        with pytest.raises(BrokenProcessPool):
            running.result()
    assert capfd.readouterr().err == ""
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
