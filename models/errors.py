"""The one error a user sees: what was given, what was expected, how to mend it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Self


class InputError(ValueError):
    """Bad input, told in three parts.

    Args:
        given: where and what, e.g. ``rig.toml: sleeves[1].clearance = -0.0002 m``.
        expected: the rule it breaks, e.g. ``a clearance is 0 or more``.
        mend: what the reader can do, e.g. ``for a preload, use gap_offset``.
    """

    def __init__(self, given: str, expected: str, mend: str) -> None:
        super().__init__(f"{given}; {expected}; {mend}")
        self.given, self.expected, self.mend = given, expected, mend

    def __reduce__(self) -> tuple[type[Self], tuple[str, str, str]]:
        """By its three parts, so that it comes whole out of another process."""
        return type(self), (self.given, self.expected, self.mend)


@contextmanager
def in_file(name: str) -> Iterator[None]:
    """Bad input told with the file in which it stands.

    Args:
        name: of the file.

    Raises:
        InputError: raised inside, its place preceded by the file's name.
    """
    try:
        yield
    except InputError as error:
        raise InputError(f"{name}: {error.given}", error.expected, error.mend) from None


class DivergenceError(ArithmeticError):
    """A simulation left the range of finite numbers; the message says when and what to change."""


class NoRestError(InputError, DivergenceError):
    """A structure that nowhere stays at rest: bad input to its owner, a motion without bound to a fit on its way."""


class NotComputableError(InputError, DivergenceError):
    """A model that cannot be computed: bad input to its owner, a step too far to a fit on its way."""
