"""Work on all cores: a share of it in this process, and others in companions beside it.

Where records are short, as in most of a search, Python's lock takes all that threads could bring (``make bench``).
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import count
from threading import Lock, local
from typing import Any, Generic, TypeVar

from threadpoolctl import threadpool_limits

from identification.companion import Companion, Work

Item = TypeVar("Item")
Product = TypeVar("Product")


def in_parallel(
    jobs: int, work: Callable[[Item], Product], items: Iterable[Item], *, alike: bool = False
) -> list[Product]:
    """The results in order; with one job in the caller's own thread, so that work in parallel can itself be divided.

    Args:
        jobs: cores.
        work: a function of a module, or one bound to arguments with ``partial``, which changes nothing and rests on
            nothing that was changed in this process alone. What cannot be pickled is done in threads of this process.
        items: one after the other.
        alike: they take about as long as each other, so that many can be handed over at once.
    """
    _one_thread_in_algebra()
    asked = list(items)
    if jobs == 1 or not asked:
        return [work(item) for item in asked]
    rest = _Rest[Item, Product](asked, PORTIONS * jobs if alike else len(asked))
    pool, of_all = _pool(jobs), Work(work)
    try:
        for share in [pool.submit(_take_share, of_all, rest) for _ in range(min(jobs, len(asked)))]:
            share.result()
    finally:
        rest.leave()
    return rest.in_order()


def in_threads(jobs: int, work: Callable[..., Product], *items: Iterable[Any]) -> list[Product]:
    """The results in order, all made by this process: of arrays so large that to send them costs more than the lock.

    Args:
        jobs: cores.
        work: any function that changes nothing another item reads, and does no other work in parallel.
        items: of each argument of the work, one after the other.
    """
    _one_thread_in_algebra()
    return list(map(work, *items)) if jobs == 1 else list(_pool(jobs).map(work, *items))


class _Rest(Generic[Item, Product]):
    """Items that nobody has taken yet, and what came of those that were.

    Source: guided self-scheduling, C. D. Polychronopoulos, D. J. Kuck, IEEE Trans. Comput. C-36 (1987) 1425: large
    portions first, since each costs a message, and single items last, so that all end together.

    Args:
        items: all.
        portions: of what is left, one of which is taken.
    """

    def __init__(self, items: Sequence[Item], portions: int) -> None:
        self.items, self.portions = items, portions
        self.products: dict[int, Product] = {}
        self.errors: dict[int, Exception] = {}
        self._taken, self._lock = 0, Lock()

    def portion(self) -> range:
        """Numbers of the next items; empty where there are none."""
        with self._lock:
            left = len(self.items) - self._taken
            first, self._taken = self._taken, self._taken + min(left, max(1, left // self.portions))
            return range(first, self._taken)

    def leave(self) -> None:
        """Nobody takes what is left."""
        with self._lock:
            self._taken = len(self.items)

    def in_order(self) -> list[Product]:
        """All products, or the error of the first item that failed: those before it were taken, too."""
        if self.errors:
            raise self.errors[min(self.errors)]
        return [self.products[k] for k in range(len(self.items))]


PORTIONS = 2
"""Of what is left, for each core."""


@cache
def _one_thread_in_algebra() -> None:
    """Matrices are small here, and the library's own threads get in the way."""
    threadpool_limits(1)


@cache
def _pool(jobs: int) -> ThreadPoolExecutor:
    """One pool for all work; each of its threads but the first has a companion."""
    return ThreadPoolExecutor(jobs, "simulate", initializer=_begin, initargs=(count(),))


_thread = local()


def _begin(numbers: "count[int]") -> None:
    try:
        _thread.companion = Companion() if next(numbers) else None
    except OSError:
        _thread.companion = None


def _take_share(work: Work[Item, Product], rest: _Rest[Item, Product]) -> None:
    """By the thread's companion where it has one that can, until nothing is left."""
    companion: Companion | None = _thread.companion
    while portion := rest.portion():
        items = [rest.items[k] for k in portion]
        products = companion.do(work, items) if companion and companion.is_ready else None
        if products is not None:
            rest.products.update(zip(portion, products, strict=True))
        else:
            _do(work, rest, portion)


def _do(work: Work[Item, Product], rest: _Rest[Item, Product], portion: range) -> None:
    for k in portion:
        try:
            rest.products[k] = work.function(rest.items[k])
        except Exception as error:  # noqa: BLE001 - told by who asked
            rest.errors[k] = error
            rest.leave()
            return
