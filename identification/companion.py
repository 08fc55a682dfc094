"""A process beside this one that does pieces of its work: Python's lock lets one thread of a process run at a time.

It begins afresh, so that nothing of this process but what it is sent is in it, runs no script of the caller, and ends
with this one, whatever ends that. What it cannot do is done here.
"""

import atexit
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from threading import Event, Thread
from typing import Generic, TypeVar

from identification.wire import Shared, packed, receive, send, sent_once, unpacked

Item = TypeVar("Item")
Product = TypeVar("Product")


@sent_once
class Work(Generic[Item, Product]):
    """What is done with many items; what it holds is sent with the first of them.

    Args:
        function: of a module, or bound to arguments, so that it can be pickled.
    """

    def __init__(self, function: Callable[[Item], Product]) -> None:
        self.function = function


class Companion:
    """A process that is begun, and used as soon as it is ready and for as long as it lives.

    Raises:
        OSError: the system gives none.
    """

    def __init__(self) -> None:
        if not sys.executable:
            raise OSError("no Python to begin")
        path = [entry for entry in sys.path if isinstance(entry, str)]
        begin = f"import sys; sys.path[:] = {path!r}; from {__name__}_process import main; main()"
        self._shared = Shared(numbering=True)
        self._ready = Event()
        self._process = subprocess.Popen(  # noqa: S603 - this Python and our own module
            [sys.executable, "-c", begin],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # an interrupt from the keyboard is for this process, and ends that one with it
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests, self._answers = self._process.stdin, self._process.stdout
        atexit.register(self.end)
        Thread(target=self._await, name="companion", daemon=True).start()

    def _await(self) -> None:
        try:
            receive(self._answers)
        except (OSError, EOFError, ValueError):
            self.end()
        else:
            self._ready.set()

    @property
    def is_ready(self) -> bool:
        """It can be given work."""
        return self._ready.is_set()

    def do(self, work: Work[Item, Product], items: Sequence[Item]) -> list[Product] | None:
        """What came of some items; None where it could not do them all.

        Args:
            work: done with these and other items.
            items: some.
        """
        before = self._shared.last
        try:
            request = packed((self._shared.dropped(), work, items), self._shared)
        except Exception:  # noqa: BLE001 - whatever cannot be pickled is done here
            return None
        try:
            send(self._requests, request)
            products: list[Product] | None = unpacked(receive(self._answers), self._shared)
        except BaseException as error:
            self.end()
            if isinstance(error, Exception):
                return None
            raise
        if products is None:
            self._shared.take_back(before)
        return products

    def end(self) -> None:
        """End the process; it is not asked again."""
        self._ready.clear()
        self._process.kill()
        for pipe in (self._requests, self._answers):
            with suppress(OSError):
                pipe.close()
        self._process.wait()
        atexit.unregister(self.end)
