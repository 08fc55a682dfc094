"""From a ``[[effects]]`` table of a rig file to an effect, and back."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import Any

from models.effects.protocol import Effect, Parameter, Place, PlaceKind
from models.errors import InputError
from models.rig import Beam, EffectEntry, Rig
from models.rig_checks import nearest

KEYS: Mapping[PlaceKind, tuple[str, ...]] = {
    "sleeve": ("sleeve",),
    "position": ("position",),
    "sensor": ("sensor",),
    "sensor pair": ("sensor", "other"),
}
"""What a table gives for each kind of place."""


def build_effect(
    entry: EffectEntry, rig: Rig, registry: Mapping[str, type[Effect]], table: str | None = None
) -> Effect:
    """The effect that a file's table describes.

    Args:
        entry: the table.
        rig: whose sleeves, sensors and structure it must fit.
        registry: kind -> class.
        table: what errors call it; by default its place in the rig file.

    Raises:
        InputError: an unknown kind, a wrong place, an unknown or missing key, a value outside its bounds.
    """
    if table is None:
        table = f"effects[{rig.effects.index(entry)}]" if entry in rig.effects else "new effect"
    cls = registry.get(entry.kind)
    if cls is None:
        raise _unknown(f'{table}.kind = "{entry.kind}"', entry.kind, registry)
    if rig.structure.kind not in cls.structures:
        raise InputError(
            f'{table}.kind = "{entry.kind}" on structure.kind = "{rig.structure.kind}"',
            f"{entry.kind} acts on {' and '.join(f'{kind}s' for kind in cls.structures)} only",
            "remove this effect or change the structure",
        )
    settings = _settings(table, entry, cls)
    if isinstance(rig.structure, Beam):
        for key, about in cls.parameters().items():
            if about.on_beam:
                _check_on_beam(f"{table}.{key}", settings[key], rig.structure)
    return cls(place=_place(table, entry, cls, rig), **settings)


def entry_of(effect: Effect) -> EffectEntry:
    """The table that describes this effect; what is left at its default is written too, so that files stay complete."""
    keys = [*effect.options, *effect.parameters()]
    settings: dict[str, Any] = {key: getattr(effect, key) for key in keys}
    place = effect.place
    where = place if place.sleeve is None else replace(place, position=None)
    return EffectEntry(kind=effect.kind, **_without_none(vars(where)), **settings)


def _without_none(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def _unknown(given: str, kind: str, registry: Mapping[str, type[Effect]]) -> InputError:
    """What to say of a kind that the library does not have: the nearest one, or all where none is near."""
    near = nearest(kind, registry)
    if near:
        expected = f'the nearest of the library\'s {len(registry)} kinds is "{near}"'
        return InputError(given, expected, "write that one, or see all with testbed effects")
    return InputError(given, f"the library has {', '.join(sorted(registry))}", "choose one of them")


def _place(table: str, entry: EffectEntry, cls: type[Effect], rig: Rig) -> Place:
    # Beside a sensor a position is the kind's own key, not its place.
    position = entry.position if entry.sensor is None else None
    given = _without_none({"sleeve": entry.sleeve, "position": position, "sensor": entry.sensor, "other": entry.other})
    allowed = tuple(KEYS[p] for p in cls.places if rig.structure.kind == "beam" or p == "sensor")
    if tuple(given) not in (allowed or ((),)):
        shown = " and ".join(f"{key} = {_shown(value)}" for key, value in given.items())
        raise InputError(
            f"{table}: {entry.kind} with {shown or 'no place'}",
            _rule_of_places(entry.kind, allowed, rig),
            f"give {_either(allowed)}" if allowed else f"remove {' and '.join(given)}",
        )
    if entry.sleeve is not None:
        sleeve = _named(table, "sleeve", entry.sleeve, rig.sleeves)
        return Place(sleeve=entry.sleeve, position=sleeve.position)
    if entry.sensor is not None and entry.other is not None:
        return _pair(table, entry.sensor, entry.other, rig)
    if entry.sensor is not None:
        return Place(sensor=_named(table, "sensor", entry.sensor, rig.sensors).name)
    if position is not None and isinstance(rig.structure, Beam):
        _check_on_beam(f"{table}.position", position, rig.structure)
    return Place(position=position)


def _pair(table: str, sensor: str, other: str, rig: Rig) -> Place:
    """Two sensors, in the order of the rig: either may be named first."""
    for key, name in (("sensor", sensor), ("other", other)):
        _named(table, key, name, rig.sensors)
    if sensor == other:
        raise InputError(
            f'{table}: sensor = other = "{sensor}"', "a pair is two sensors", "name the second one under other"
        )
    first, second = (each.name for each in rig.sensors if each.name in (sensor, other))
    return Place(sensor=first, other=second)


def _check_on_beam(key: str, position: float, beam: Beam) -> None:
    if position > beam.length:
        raise InputError(
            f"{key} = {position:g} m",
            f"the beam ends at {beam.length:g} m",
            "give a position between the clamp and the free end",
        )


def _either(allowed: tuple[tuple[str, ...], ...]) -> str:
    return " or ".join(" and ".join(keys) for keys in allowed)


def _rule_of_places(kind: str, allowed: tuple[tuple[str, ...], ...], rig: Rig) -> str:
    if allowed:
        return f"{kind} takes {'one ' if len(allowed) == 1 else 'either '}{_either(allowed)}"
    return f"{kind} takes no place" if isinstance(rig.structure, Beam) else f"on an oscillator {kind} takes no place"


def _named(table: str, key: str, name: str, parts: tuple[Any, ...]) -> Any:
    for part in parts:
        if part.name == name:
            return part
    names = ", ".join(f'"{part.name}"' for part in parts) or "none"
    group = "sensors" if key == "other" else f"{key}s"
    raise InputError(f'{table}.{key} = "{name}"', f"the rig's {group} are {names}", "name one of them")


def _settings(table: str, entry: EffectEntry, cls: type[Effect]) -> dict[str, Any]:
    parameters, given = cls.parameters(), entry.settings
    known: dict[str, Any] = {**cls.options, **parameters}
    for key in given:
        if key not in known:
            near = nearest(key, known)
            raise InputError(
                f"{table}.{key} = {_shown(given[key])}",
                f"{entry.kind} has {', '.join(known) or 'no numbers'}",
                f'did you mean "{near}"?' if near else f"remove {key}",
            )
    settings: dict[str, Any] = {}
    for key, choices in cls.options.items():
        settings[key] = _option(f"{table}.{key}", given.get(key, choices[0]), choices)
    for key, about in parameters.items():
        if key in given:
            settings[key] = _value(table, entry.kind, key, given[key], about)
        elif not cls.has_default(key):
            unit = "" if about.unit == "-" else f", in {about.unit}"
            raise InputError(
                f"{table}: {entry.kind} without {key}", f"it needs {', '.join(parameters)}", f"add {key}{unit}"
            )
    return settings


def _option(key: str, value: Any, choices: tuple[str, ...]) -> str:
    if value not in choices:
        raise InputError(f"{key} = {_shown(value)}", f"it is one of {', '.join(choices)}", "choose one of them")
    return str(value)


def _value(table: str, kind: str, key: str, value: Any, about: Parameter) -> float | tuple[float, ...]:
    is_table = isinstance(value, list | tuple)
    numbers = tuple(value) if is_table else (value,)
    if is_table == about.table and all(_is_within(number, about) for number in numbers):
        return tuple(float(number) for number in numbers) if is_table else float(value)
    raise InputError(
        f"{table}.{key} = {_shown(value)}",
        f"{kind}'s {key} is {'a list of numbers, each' if about.table else 'one number,'} {_rule_of_bounds(about)}",
        "correct the value",
    )


def _is_within(number: Any, about: Parameter) -> bool:
    is_number = isinstance(number, int | float) and not isinstance(number, bool)
    return is_number and about.lower <= number <= about.upper


def _rule_of_bounds(about: Parameter) -> str:
    unit = "" if about.unit == "-" else f" {about.unit}"
    if about.upper < inf:
        return f"between {about.lower:g} and {about.upper:g}{unit}"
    return f"of at least {about.lower:g}{unit}" if about.lower > -inf else "of any size"


def _shown(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(_shown(item) for item in value)}]"
    return f'"{value}"' if isinstance(value, str) else f"{value}"
