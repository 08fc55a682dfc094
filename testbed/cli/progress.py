"""Progress on standard error: a line that changes on a terminal, plain lines elsewhere."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A function that tells what is being done."""
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield lambda text: console.print(text, markup=False, soft_wrap=True)
        return
    with console.status("reading") as status:

        def tell(text: str) -> None:
            console.print(text, style="dim", markup=False)
            status.update(escape(text))

        yield tell
