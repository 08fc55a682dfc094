"""Cases on the cores of this machine, each in a process of its own: one that dies takes no other case with it."""

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from threading import Thread

from testbed.hidden_effects.plan import Task
from testbed.outputs import Json

RunCase = Callable[[Task, int], Json]
"""A case and the threads of its diagnosis, to what its file holds."""

Workers = Callable[[Sequence[Task], RunCase, int], Iterator[tuple[Task, Json]]]
"""Tasks, how to run one, and threads of each, to the cases in the order in which they are done."""


def on_this_machine(jobs: int) -> Workers:
    """Workers on the cores of this machine.

    Args:
        jobs: cases at a time.
    """

    def work(tasks: Sequence[Task], run: RunCase, threads: int) -> Iterator[tuple[Task, Json]]:
        with ThreadPoolExecutor(jobs, thread_name_prefix="case") as pool:
            running = {pool.submit(_in_own_process, task, run, threads): task for task in tasks}
            try:
                for done in as_completed(running):
                    yield running[done], done.result()
            finally:
                pool.shutdown(wait=False, cancel_futures=True)

    return work


def lost(task: Task, reason: str) -> Json:
    """What is kept of a case that nobody finished.

    Args:
        task: the case.
        reason: in words.
    """
    return task.about | {"failure": reason}


def _in_own_process(task: Task, run: RunCase, threads: int) -> Json:
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_send, args=(there, run, task, threads), daemon=True)
    process.start()
    there.close()
    try:
        result: Json = here.recv()
    except EOFError:
        process.join()
        return lost(task, f"its process ended with status {process.exitcode}")
    finally:
        here.close()
    process.join()
    return result


def _send(to: Connection, run: RunCase, task: Task, threads: int) -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # an interrupt ends it without a word: the parent has its own
    Thread(target=_end_with_parent, daemon=True).start()
    to.send(run(task, threads))
    to.close()


def _end_with_parent() -> None:
    """Nobody waits for the case of a process that was killed."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
