"""Work on several cores, in processes that begin afresh: simulators do not like to be forked."""

import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager, nullcontext
from multiprocessing import get_context
from typing import Any, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def processes(jobs: int) -> ProcessPoolExecutor:
    """A pool of processes, which an interrupt ends at once and without a word: this process has its own.

    Args:
        jobs: how many.
    """
    return _Pool(jobs, mp_context=get_context("spawn"), initializer=_die_of_an_interrupt)


class _Pool(ProcessPoolExecutor):
    """Processes that begin with interrupts held back: one that is still being set up would complain at length."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Begins a process where none is idle."""
        with _interrupts_held():
            return super().submit(fn, *args, **kwargs)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """What is begun meanwhile inherits that; where the system has no such thing, nothing is held.

    The tracker of shared resources, which lets interrupts through when it starts, was started with the pool.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _die_of_an_interrupt() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


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
