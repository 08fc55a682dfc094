"""From pydantic's account of a bad rig file to the one error its owner reads: key, value, rule and mend."""

import json
from collections.abc import Callable
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from models.errors import InputError
from models.rig import Beam, EffectEntry, Excitation, Oscillator, Rig, Sensor, Sleeve
from models.rig_checks import nearest
from models.rig_parts import SETTING, Term, term

_PARTS: dict[str, type[BaseModel]] = {
    "beam": Beam,
    "oscillator": Oscillator,
    "sleeves": Sleeve,
    "excitation": Excitation,
    "sensors": Sensor,
    "effects": EffectEntry,
}
_HEADS = {"sleeves": "[[sleeves]]", "sensors": "[[sensors]]", "effects": "[[effects]]"}
_LONGEST_VALUE = 60

Words = tuple[str, str, str]


def first_fault(file: str, error: ValidationError) -> InputError:
    """The first problem of a rig as an input error that also says how many there are.

    Args:
        file: the name of the rig file, which begins the message.
        error: what validating the file's content raised.
    """
    # The spelling is what the owner of a misspelt key has to hear about first.
    details = sorted(_once(error.errors(include_url=False)), key=lambda detail: detail["type"] != "extra_forbidden")
    first = details[0]
    given, expected, mend = _WORDS.get(first["type"], _breach)(first)
    further = len(details) - 1 + first.get("ctx", {}).get("further", 0)
    if further:
        mend += f" ({further} further problem{'s' if further > 1 else ''} in this file)"
    return InputError(f"{file}: {given}", expected, mend)


def _once(details: list[ErrorDetails]) -> list[ErrorDetails]:
    """All problems but the missing keys that stand there misspelt: each of those is an unknown one already."""
    unknown = [detail for detail in details if detail["type"] == "extra_forbidden"]
    meant = {(*detail["loc"][:-1], nearest(_key(detail), list(_part(detail).model_fields))) for detail in unknown}
    return [detail for detail in details if detail["type"] != "missing" or detail["loc"] not in meant]


def _location(detail: ErrorDetails) -> tuple[int | str, ...]:
    """The keys and indices down to the problem, without the kind that pydantic puts after ``structure``."""
    loc = detail["loc"]
    return (loc[0], *loc[2:]) if loc[0] == "structure" else loc


def _path(location: tuple[int | str, ...]) -> str:
    path = str(location[0])
    for step in location[1:]:
        path += f"[{step}]" if isinstance(step, int) else f".{step}" if "." not in step else f'."{step}"'
    return path


def _key(detail: ErrorDetails) -> str:
    return next(str(step) for step in reversed(detail["loc"]) if isinstance(step, str))


def _table(detail: ErrorDetails) -> str:
    loc = _location(detail)
    return _HEADS.get(str(loc[0]), f"[{loc[0]}]") if len(loc) > 1 else "the rig file"


def _part(detail: ErrorDetails) -> type[BaseModel]:
    """The model whose key is at fault: the rig itself where a table as a whole is."""
    loc = detail["loc"]
    table = loc[1] if loc[0] == "structure" and len(loc) > 1 else loc[0]
    names_a_key = any(isinstance(step, str) for step in _location(detail)[1:])
    return _PARTS.get(str(table), Rig) if names_a_key else Rig


def _term(detail: ErrorDetails) -> Term:
    part, key, last = _part(detail), _key(detail), detail["loc"][-1]
    if part is Rig:
        return term(Rig, str(detail["loc"][0]))
    if key not in part.model_fields:
        return SETTING
    return term(part, key, last) if isinstance(last, int) else term(part, key)


def _shown(value: Any) -> str:
    """A value as it stands in a TOML file."""
    if isinstance(value, bool | str):
        text = json.dumps(value, ensure_ascii=False)
    elif isinstance(value, list):
        text = f"[{', '.join(_shown(item) for item in value)}]"
    elif isinstance(value, dict):
        text = "{...}"
    else:
        text = str(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."


def _given(detail: ErrorDetails) -> str:
    path, value = _path(_location(detail)), detail["input"]
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    unit = _term(detail).unit if is_number else ""
    return f"{path} = {_shown(value)} {unit}".rstrip()


def _breach(detail: ErrorDetails) -> Words:
    mend = _term(detail).mend
    if detail["loc"][0] == "tolerances" and not isinstance(detail["input"], dict):
        key = _path(_location(detail)[1:])
        written = f'"{key}"' if "." in key else key
        mend = f"for 3 % write {written} = 0.03; leave out what is certain"
    return _given(detail), _term(detail).rule, mend


def _not_a_number(detail: ErrorDetails) -> Words:
    if _part(detail) is Rig:
        return _breach(detail)
    unit = _term(detail).unit
    rule = f"{_key(detail)} is a finite number{unit and f' in {unit}'}"
    return _given(detail), rule, "write a plain number, without quotes, nan or inf"


def _missing(detail: ErrorDetails) -> Words:
    given = f"{_path(_location(detail))} is missing"
    if isinstance(detail["loc"][-1], int):
        whole = term(_part(detail), _key(detail))
        return given, whole.rule, whole.mend
    return given, _term(detail).rule, f"add {_key(detail)} to {_table(detail)}"


def _unknown(detail: ErrorDetails) -> Words:
    known = list(_part(detail).model_fields)
    near = nearest(_key(detail), known)
    return (
        f"{_path(_location(detail))} is unknown",
        f"the keys of {_table(detail)} are {', '.join(known)}",
        f"the nearest one is {_HEADS.get(near, near)}" if near else "take one of them, or remove it",
    )


def _unknown_structure(detail: ErrorDetails) -> Words:
    kind = detail["input"].get("kind")
    given = "structure.kind is missing" if kind is None else f"structure.kind = {_shown(kind)}"
    return given, _term(detail).rule, _term(detail).mend


def _misfit(detail: ErrorDetails) -> Words:
    return detail["ctx"]["given"], detail["ctx"]["expected"], detail["ctx"]["mend"]


_WORDS: dict[str, Callable[[ErrorDetails], Words]] = {
    "float_type": _not_a_number,
    "finite_number": _not_a_number,
    "missing": _missing,
    "extra_forbidden": _unknown,
    "union_tag_invalid": _unknown_structure,
    "union_tag_not_found": _unknown_structure,
    "misfit": _misfit,
}
