"""What a companion does until its pipe ends: reads work and items, and writes what comes of them."""

import os
import signal
from queue import SimpleQueue
from threading import Thread
from typing import IO

from threadpoolctl import threadpool_limits

import identification.sketch  # noqa: F401 - what most work needs is there before the first is asked for
from identification.wire import Shared, packed, receive, send, unpacked


def answer(request: bytes, shared: Shared) -> bytes:
    """What comes of a request, as bytes: None where it cannot be read, done or sent.

    Args:
        request: numbers that hold no more, work and items.
        shared: what both ends have.
    """
    try:
        dropped, work, items = unpacked(request, shared)
        shared.forget(dropped)
        return packed([work.function(item) for item in items], shared)
    except Exception:  # noqa: BLE001 - it is done again by who asked, where it fails in its own words
        return packed(None, shared)


def main() -> None:
    """Serve on the standard streams; what is printed goes to the standard error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    queue: SimpleQueue[bytes] = SimpleQueue()
    Thread(target=_listen, args=(requests, queue), daemon=True).start()
    shared = Shared(numbering=False)
    send(answers, b"ready")
    while True:
        send(answers, answer(queue.get(), shared))


def _listen(requests: IO[bytes], queue: "SimpleQueue[bytes]") -> None:
    """Nobody waits for the work of a process that is no more, so it ends in the middle of it."""
    try:
        while True:
            queue.put(receive(requests))
    except (OSError, EOFError):
        os._exit(0)
