"""A property that is computed when it is first asked for.

``functools.cached_property`` does that too, but until Python 3.12 for no two objects of a class at the same time: it
holds a lock of the class while it computes, and of records that are worked at in threads one waits for the other.
"""

from collections.abc import Callable
from typing import Any, Generic, TypeVar, overload

Value = TypeVar("Value")


class computed_once(Generic[Value]):  # noqa: N801 - a decorator
    """Kept in the object's own dictionary, for objects each of which is met by one thread at a time.

    Args:
        compute: from the object.
    """

    def __init__(self, compute: Callable[[Any], Value]) -> None:
        self._compute, self.__doc__ = compute, compute.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        """The name under which the value is kept."""
        self._name = name

    @overload
    def __get__(self, obj: None, owner: type) -> "computed_once[Value]": ...
    @overload
    def __get__(self, obj: object, owner: type) -> Value: ...
    def __get__(self, obj: object | None, owner: type) -> "Value | computed_once[Value]":
        """The value; asked of the class, the property itself."""
        if obj is None:
            return self
        value = obj.__dict__[self._name] = self._compute(obj)
        return value
