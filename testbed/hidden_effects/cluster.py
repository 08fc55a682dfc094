"""Cases on a Dask cluster.

What a lost worker was at is begun anew by another one, as often as the scheduler allows
(``distributed.scheduler.allowed-failures``, 3 by default).
"""

from collections.abc import Iterator, Sequence
from typing import Any

from models.errors import InputError
from testbed.hidden_effects.crew import RunCase, Workers, lost
from testbed.hidden_effects.plan import Task
from testbed.outputs import Json


def on_cluster(address: str) -> Workers:
    """Workers of a cluster whose machines have this project installed, in the same version.

    Nobody is called before there are cases to run.

    Args:
        address: of its scheduler, like ``tcp://10.0.0.5:8786``.

    Returns:
        what runs the cases; it raises InputError where nobody answers, or ``distributed`` is not installed.
    """

    def work(tasks: Sequence[Task], run: RunCase, threads: int) -> Iterator[tuple[Task, Json]]:
        with _client(address) as client:
            from distributed import as_completed

            running = {client.submit(run, task, threads, pure=False): task for task in tasks}
            for done in as_completed(list(running)):  # type: ignore[no-untyped-call]
                failure = done.exception()
                task = running[done]
                yield task, done.result() if failure is None else lost(task, f"{type(failure).__name__}: {failure}")
                done.release()

    return work


def _client(address: str) -> Any:
    try:
        from distributed import Client
    except ModuleNotFoundError as missing:
        raise InputError(
            f"--scheduler {address}: the package {missing.name!r} is not installed",
            "a cluster is spoken to through distributed",
            "run make once, which installs it, or in the project's folder: pip install -e '.[cluster]'",
        ) from missing
    try:
        return Client(address, timeout=ANSWER)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise InputError(
            f"--scheduler {address}: {error}",
            "the address of a Dask scheduler that answers, like tcp://10.0.0.5:8786",
            "start one with dask scheduler, and workers with dask worker ADDRESS --nthreads 1",
        ) from error


ANSWER = "10 s"
"""In which a scheduler has to answer."""
