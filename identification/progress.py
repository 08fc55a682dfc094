"""How long work tells what it does."""

from collections.abc import Callable

Progress = Callable[[str], None]


def silent(message: str) -> None:
    """No progress."""
    del message
