"""From a ``[[effects]]`` table of a rig file to an effect, and back."""

from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from models.effects.protocol import Effect, Parameter, Place
from models.errors import InputError
from models.rig import EffectEntry, Rig


def build_effect(entry: EffectEntry, rig: Rig, registry: Mapping[str, type[Effect]]) -> Effect:
    """The effect that a rig file's table describes.

    Args:
        entry: the table.
        rig: whose sleeves, sensors and structure it must fit.
        registry: kind -> class.

    Raises:
        InputError: an unknown kind, a wrong place, an unknown or missing key, a value outside its bounds.
    """
    cls = registry.get(entry.kind)
    if cls is None:
        near = get_close_matches(entry.kind, registry, n=1)
        raise InputError(
            f"effects: kind = {entry.kind!r}",
            f"the library has {', '.join(sorted(registry))}",
            f"did you mean {near[0]!r}?" if near else "see the list of effects in the documentation",
        )
    if rig.structure.kind not in cls.structures:
        raise InputError(
            f"effects: {entry.kind} on structure.kind = {rig.structure.kind!r}",
            f"{entry.kind} acts on {' and '.join(cls.structures)}",
            "remove this effect or change the structure",
        )
    return cls(place=_place(entry, cls, rig), **_settings(entry, cls))


def entry_of(effect: Effect) -> EffectEntry:
    """The table that describes this effect; what is left at its default is written too, so that files stay complete."""
    keys = [*effect.options, *effect.parameters()]
    settings: dict[str, Any] = {key: getattr(effect, key) for key in keys}
    place = effect.place
    where = place if place.sleeve is None else replace(place, position=None)
    return EffectEntry(kind=effect.kind, **_without_none(vars(where)), **settings)


def _without_none(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def _place(entry: EffectEntry, cls: type[Effect], rig: Rig) -> Place:
    given = _without_none({"sleeve": entry.sleeve, "position": entry.position, "sensor": entry.sensor})
    allowed = tuple(p for p in cls.places if rig.structure.kind == "beam" or p == "sensor")
    if len(given) != (1 if allowed else 0) or any(key not in allowed for key in given):
        raise InputError(
            f"effects: {entry.kind} with {', '.join(f'{k} = {v!r}' for k, v in given.items()) or 'no place'}",
            f"{entry.kind} takes exactly one of {', '.join(allowed)}" if allowed else f"{entry.kind} takes no place",
            "see the table of effects for the place it takes",
        )
    if entry.sleeve is not None:
        return Place(sleeve=entry.sleeve, position=_named(rig.sleeves, entry.sleeve, entry.kind, "sleeve").position)
    if entry.sensor is not None:
        _named(rig.sensors, entry.sensor, entry.kind, "sensor")
        return Place(sensor=entry.sensor)
    if entry.position is not None and rig.structure.kind == "beam" and entry.position > rig.structure.length:
        raise InputError(
            f"effects: {entry.kind} at position = {entry.position:g} m",
            f"the beam ends at {rig.structure.length:g} m",
            "give a position between the clamp and the free end",
        )
    return Place(position=entry.position)


def _named(parts: tuple[Any, ...], name: str, kind: str, what: str) -> Any:
    for part in parts:
        if part.name == name:
            return part
    names = ", ".join(repr(part.name) for part in parts) or "none"
    raise InputError(f"effects: {kind} with {what} = {name!r}", f"the rig's {what}s are {names}", "name one of them")


def _settings(entry: EffectEntry, cls: type[Effect]) -> dict[str, Any]:
    parameters, given = cls.parameters(), entry.settings
    known = [*cls.options, *parameters]
    for key in given:
        if key not in known:
            near = get_close_matches(key, known, n=1)
            raise InputError(
                f"effects: {entry.kind}.{key}",
                f"{entry.kind} has {', '.join(known) or 'no keys'}",
                f"did you mean {near[0]!r}?" if near else "remove it",
            )
    settings: dict[str, Any] = {}
    for key, choices in cls.options.items():
        settings[key] = _option(entry.kind, key, given.get(key, choices[0]), choices)
    for key, about in parameters.items():
        if key in given:
            settings[key] = _value(entry.kind, key, given[key], about)
        elif not cls.has_default(key):
            raise InputError(f"effects: {entry.kind} without {key}", f"it needs {', '.join(parameters)}", f"add {key}")
    return settings


def _option(kind: str, key: str, value: Any, choices: tuple[str, ...]) -> str:
    if value not in choices:
        raise InputError(f"effects: {kind}.{key} = {value!r}", f"{key} is one of {', '.join(choices)}", "choose one")
    return str(value)


def _value(kind: str, key: str, value: Any, about: Parameter) -> float | tuple[float, ...]:
    numbers = value if isinstance(value, (list, tuple)) else [value]
    for number in numbers:
        is_number = isinstance(number, (int, float)) and not isinstance(number, bool)
        if not is_number or not about.lower <= number <= about.upper:
            raise InputError(
                f"effects: {kind}.{key} = {number!r}",
                f"a number between {about.lower:g} and {about.upper:g}, {about.unit}",
                "correct the value",
            )
    return tuple(float(n) for n in numbers) if isinstance(value, (list, tuple)) else float(value)
