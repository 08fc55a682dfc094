"""Objects between two processes: what is large and used again is sent once and then named by a number.

Records with their spectra are megabytes, and thousands of hypotheses are held against them. Either end that has met
one writes its number; the end that has only numbers given to it, the companion, gives none itself. A message is written
whole or not at all, so that one that cannot be sent costs itself alone. Arrays arrive contiguous.
"""

import pickle
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from io import BytesIO
from typing import IO, Any, TypeVar
from weakref import ref

from models.rig import Rig

Class = TypeVar("Class", bound=type)

_SENT_ONCE: set[type] = {Rig}


def sent_once(cls: Class) -> Class:
    """Marks a class whose objects are immutable and may be large: a process that has met one keeps it."""
    _SENT_ONCE.add(cls)
    return cls


class Shared:
    """Objects that two ends both have, by number.

    Args:
        numbering: whether this end gives numbers, and does not itself keep what it has numbered alive.

    Attributes:
        last: number that was given.
    """

    def __init__(self, *, numbering: bool) -> None:
        self.numbering = numbering
        self.last = 0
        self._numbers: dict[int, int] = {}
        self._objects: dict[int, Callable[[], Any]] = {}
        self._dropped: list[int] = []

    def number_of(self, obj: object) -> int | None:
        """The number of an object that both ends have."""
        number = self._numbers.get(id(obj))
        found = None if number is None else self._objects.get(number)
        return number if found and found() is obj else None

    def next_number(self, obj: object) -> int:
        """A number for an object that is about to be sent."""
        self.last += 1
        number, identity = self.last, id(obj)
        self._numbers[identity], self._objects[number] = number, ref(obj, lambda _: self._drop(number, identity))
        return number

    def _drop(self, number: int, identity: int) -> None:
        if self._objects.pop(number, None):
            self._dropped.append(number)
        if self._numbers.get(identity) == number:
            del self._numbers[identity]

    def keep(self, number: int, obj: object) -> None:
        """What came with a number from the other end."""
        self._numbers[id(obj)], self._objects[number] = number, lambda: obj

    def known(self, number: int) -> object:
        """The object of a number."""
        return self._objects[number]()

    def dropped(self) -> list[int]:
        """Numbers that hold no more since this was last asked."""
        return [self._dropped.pop() for _ in range(len(self._dropped))]

    def take_back(self, before: int) -> None:
        """Drop the numbers given since that one: what was to carry them did not arrive."""
        for number in range(before + 1, self.last + 1):
            if number in self._objects:
                self._drop(number, id(self._objects[number]()))

    def forget(self, numbers: list[int]) -> None:
        """Let go of objects of which the other end says that their numbers hold no more."""
        for number in numbers:
            if number in self._objects:
                del self._numbers[id(self._objects.pop(number)())]


def packed(message: object, shared: Shared) -> bytes:
    """A message as bytes.

    Args:
        message: anything that can be pickled.
        shared: what both ends have.

    Raises:
        Exception: what stands in the way of pickling; nothing has become of it.
    """
    before, stream = shared.last, BytesIO()
    try:
        _Pickler(stream, shared).dump(message)
    except Exception:
        shared.take_back(before)
        raise
    return stream.getvalue()


def unpacked(message: bytes, shared: Shared) -> Any:
    """What ``packed`` made bytes of.

    Args:
        message: of the other end.
        shared: what both ends have.

    Raises:
        Exception: what stands in the way, such as a class that is not there.
    """
    return _Unpickler(BytesIO(message), shared).load()


HEAD = 8
"""Bytes before a message that say how long it is."""


def send(to: IO[bytes], message: bytes) -> None:
    """Write a message, and before it how long it is."""
    to.write(len(message).to_bytes(HEAD, "little"))
    to.write(message)
    to.flush()


def receive(of: IO[bytes]) -> bytes:
    """Read a message.

    Raises:
        EOFError: the other end is no more.
    """
    size = int.from_bytes(_read(of, HEAD), "little")
    return _read(of, size)


def _read(of: IO[bytes], size: int) -> bytes:
    found = of.read(size)
    if len(found) < size:
        raise EOFError
    return found


class _Pickler(pickle.Pickler):
    def __init__(self, to: IO[bytes], shared: Shared) -> None:
        super().__init__(to, pickle.HIGHEST_PROTOCOL)
        self.shared = shared

    def persistent_id(self, obj: object) -> object:
        if type(obj) not in _SENT_ONCE:
            return None
        number = self.shared.number_of(obj)
        if number is not None:
            return number, None
        return (self.shared.next_number(obj), _parts_of(obj)) if self.shared.numbering else None

    def reducer_override(self, obj: object) -> Any:
        return NotImplemented if _fields_of(type(obj)) is None else _parts_of(obj)


def _parts_of(obj: object) -> Any:
    """How it is made again; of a dataclass its fields alone, since other threads may be deriving more of it."""
    names = _fields_of(type(obj))
    if names is None:
        return obj.__reduce_ex__(pickle.HIGHEST_PROTOCOL)
    return _bare, (type(obj),), {name: getattr(obj, name) for name in names}


def _bare(cls: type) -> object:
    return object.__new__(cls)


def _fields_of(cls: type) -> tuple[str, ...] | None:
    """Names of what a dataclass holds; None of what is none, or says itself how it is pickled."""
    if cls not in _FIELDS:
        own = hasattr(cls, "__setstate__") or any(getattr(cls, name) is not getattr(object, name) for name in _PICKLING)
        plain = is_dataclass(cls) and not own and bool(cls.__dictoffset__)
        _FIELDS[cls] = tuple(each.name for each in fields(cls)) if plain else None
    return _FIELDS[cls]


_FIELDS: dict[type, tuple[str, ...] | None] = {}

_PICKLING = ("__reduce_ex__", "__reduce__", "__getstate__")


class _Unpickler(pickle.Unpickler):
    def __init__(self, of: IO[bytes], shared: Shared) -> None:
        super().__init__(of)
        self.shared = shared

    def persistent_load(self, named: Any) -> object:
        number, parts = named
        if parts is None:
            return self.shared.known(number)
        make, args, state, *_ = parts
        obj = make(*args)
        if hasattr(obj, "__setstate__"):
            obj.__setstate__(state)
        else:
            obj.__dict__.update(state)
        self.shared.keep(number, obj)
        return obj
