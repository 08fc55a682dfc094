"""Whether a heading keeps its unit where it is looked for: in square brackets."""

import re
from collections.abc import Iterable

from models.errors import InputError
from testbed.records.recording import Tag
from testbed.records.units import is_unit

_ROUND = re.compile(r"\s*(.*?)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)\s*")


def check_brackets(tags: Iterable[Tag], file: str) -> None:
    """Whether each channel without a unit is without one.

    Args:
        tags: of the channels, as headed.
        file: its name, for errors.

    Raises:
        InputError: a unit stands in round brackets.
    """
    for tag in tags:
        match = _ROUND.fullmatch(tag.name or "")
        if tag.unit is None and match and is_unit(match[2]):
            raise InputError(
                f'{file}: a channel is headed "{tag.name}"',
                "a unit stands in square brackets behind the name",
                f"write {match[1]} [{match[2]}]",
            )
