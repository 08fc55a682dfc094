"""Work on several cores, in processes that begin afresh: simulators do not like to be forked."""

import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import nullcontext
from multiprocessing import get_context
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def processes(jobs: int) -> ProcessPoolExecutor:
    """A pool of processes, which an interrupt ends at once and without a word: this process has its own.

    Args:
        jobs: how many.
    """
    dies = (signal.SIGINT, signal.SIG_DFL)
    return ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=signal.signal, initargs=dies)


def as_done(
    work: Callable[[Item], Result], items: Sequence[Item], jobs: int, shared: Executor | None = None
) -> Iterator[tuple[Item, Result]]:
    """Each item with what came of it, in the order in which they are done.

    Args:
        work: what to do with an item; it and the items can be sent to a process.
        items: different ones.
        jobs: processes; with one, or for one item, all is done in this process unless there is a pool.
        shared: a pool that others use too.
    """
    if shared is None and (jobs == 1 or len(items) < 2):
        yield from ((item, work(item)) for item in items)
        return
    with nullcontext(shared) if shared else processes(min(jobs, len(items))) as pool:
        running = {pool.submit(work, item): item for item in items}
        for future in as_completed(running):
            yield running[future], future.result()
