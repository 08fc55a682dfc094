"""Changing a parsed TOML document where two versions of its content differ, and nowhere else."""

from collections.abc import Iterator
from difflib import SequenceMatcher
from typing import Any

import tomlkit
from tomlkit import TOMLDocument
from tomlkit.items import AoT, Comment, Table

Content = dict[str, Any]


def edit(document: TOMLDocument, before: Content, after: Content) -> None:
    """Turn a document with the content ``before`` into one with the content ``after``, comments kept.

    Args:
        document: the owner's file as parsed; changed in place.
        before: what the document holds, defaults included.
        after: what it shall hold.
    """
    for key in before.keys() - after.keys():
        _remove(document, key)
    for key, new in after.items():
        if key not in document:
            document[key] = new
        elif isinstance(new, tuple):
            _edit_list(document, key, before.get(key, ()), new)
        else:
            _edit_table(document[key], before.get(key, {}), new)


def _edit_table(table: Any, before: Content, after: Content) -> None:
    for key in before.keys() - after.keys():
        table.pop(key, None)
    for key, new in after.items():
        old = before.get(key)
        if new == old:
            continue
        if key not in table:
            _add(table, key, new)
        elif isinstance(new, tuple) and isinstance(old, tuple) and len(new) == len(old):
            for i in (i for i in range(len(new)) if new[i] != old[i]):
                table[key][i] = new[i]
        else:
            table[key] = new


def _add(table: Any, key: str, new: Any) -> None:
    """Add a key after the last one, above the comments that introduce the next table."""
    tail = _tail(table) if isinstance(table, Table) else []
    if not tail:
        table[key] = new
        return
    body = table.value.body
    del body[-len(tail) :]
    table[key] = new
    body.extend(tail)


def _edit_list(document: TOMLDocument, key: str, before: tuple[Content, ...], after: tuple[Content, ...]) -> None:
    """Edit the tables that stay, remove those that went and add those that came, each where it belongs."""
    tables: Any = document[key]
    identities = [_identity(old) for old in before], [_identity(new) for new in after]
    matches = SequenceMatcher(None, *identities, autojunk=False)
    # From the end, so that the places still to come keep their numbers.
    for tag, i, i_end, j, j_end in reversed(matches.get_opcodes()):
        if tag == "equal":
            for old, new, table in zip(before[i:i_end], after[j:j_end], list(tables)[i:i_end], strict=True):
                _edit_table(table, old, new)
            continue
        for place in reversed(range(i, i_end)):
            _hand_on_comments(document, tables[place])
            del tables[place]
        for new in reversed(after[j:j_end]):
            _insert(tables, i, new)


def _insert(tables: Any, place: int, new: Content) -> None:
    """Insert a table with a blank line before and after it, as far as it has neighbours."""
    tables.insert(place, new)
    if isinstance(tables, AoT):
        for table in tables.body[max(place - 1, 0) : min(place + 1, len(tables) - 1)]:
            if not table.as_string().endswith("\n\n"):
                table.add(tomlkit.nl())


def _identity(table: Content) -> tuple[Any, ...]:
    """What makes it the same part when its numbers change; beside a sensor, an effect's position is a number."""
    if "kind" not in table:
        return (table["name"],)
    return (table["kind"], table.get("sleeve") or table.get("sensor") or table.get("position"), table.get("other"))


def _remove(document: TOMLDocument, key: str) -> None:
    for table in reversed(list(_tables(document[key]))):
        _hand_on_comments(document, table)
    del document[key]


def _tables(item: Any) -> Iterator[Table]:
    """The table or tables of one top-level key, in the order of the file."""
    if isinstance(item, AoT):
        yield from item.body
    elif isinstance(item, Table):
        yield item


def _hand_on_comments(document: TOMLDocument, leaving: Any) -> None:
    """Keep the comments below a table that goes: they introduce the next one, but TOML counts them to this one."""
    preceding = None
    for item in document.values():
        for table in _tables(item):
            if table is leaving and preceding is not None:
                for _, comment in _tail(table):
                    if isinstance(comment, Comment):
                        preceding.add(comment)
            preceding = table


def _tail(table: Table) -> list[tuple[Any, Any]]:
    """The comments and blank lines after the last key of a table, as tomlkit pairs them with no key."""
    body = table.value.body
    after_keys = max((i for i, (key, _) in enumerate(body) if key is not None), default=-1) + 1
    return body[after_keys:]
