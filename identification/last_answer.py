"""The last answer to a question that takes long and is asked again about the same objects."""

from collections.abc import Callable
from typing import Generic, TypeVar

Answer = TypeVar("Answer")


class LastAnswer(Generic[Answer]):
    """Keeps one answer and what it was about: the same objects, not equal ones."""

    def __init__(self) -> None:
        self._kept: tuple[tuple[object, ...], Answer] | None = None

    def about(self, *objects: object, ask: Callable[[], Answer]) -> Answer:
        """The kept answer if it was about these objects, or a new one, which is kept.

        Args:
            objects: that the question is about.
            ask: finds the answer.
        """
        if self._kept is None or any(one is not other for one, other in zip(self._kept[0], objects, strict=True)):
            self.keep(*objects, answer=ask())
        assert self._kept is not None
        return self._kept[1]

    def keep(self, *objects: object, answer: Answer) -> None:
        """Take an answer that was found elsewhere.

        Args:
            objects: that it is about.
            answer: to keep.
        """
        self._kept = objects, answer
