"""Whether the parts of a rig fit together: places on the structure, unique names, known tolerances."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING

from models.rig_parts import Beam, EffectEntry, Excitation, Oscillator, Sensor, Sleeve

if TYPE_CHECKING:
    from models.rig import Rig

PlacedPart = Sleeve | Excitation | Sensor | EffectEntry


@dataclass(frozen=True)
class Misfit:
    """One breach, in the three parts of an ``InputError``: what was given (with its key), the rule, how to mend it."""

    given: str
    expected: str
    mend: str


def misfits(rig: "Rig") -> Iterator[Misfit]:
    """Every way in which the parts of a rig contradict each other, in the order of the file."""
    yield from _unknown_tolerances(rig)
    if isinstance(rig.structure, Oscillator):
        yield from _places_on_an_oscillator(rig)
    else:
        yield from _places_on_a_beam(rig, rig.structure)
    yield from _repeated("sleeves", "name", [sleeve.name for sleeve in rig.sleeves])
    yield from _repeated("sensors", "name", [sensor.name for sensor in rig.sensors])
    yield from _repeated("sensors", "node", [sensor.node for sensor in rig.sensors])
    yield from _unknown_names(rig)


def nearest(key: str, known: Iterable[str]) -> str | None:
    """The known key that reads most like the given one; None where none is near enough to be meant."""
    return next(iter(get_close_matches(key, known, n=1)), None)


def _unknown_tolerances(rig: "Rig") -> Iterator[Misfit]:
    known = list(rig.structure.uncertain)
    if isinstance(rig.structure, Beam):
        known += [f"sleeves.{key}" for key in Sleeve.uncertain]
    for key in rig.tolerances:
        if key not in known:
            near = nearest(key, known)
            yield Misfit(
                f'tolerances has the unknown key "{key}"',
                f"the numbers of this rig that can have a tolerance are {', '.join(known)}",
                f'the nearest one is "{near}"' if near else "take one of them, or leave it out",
            )


def _placed(rig: "Rig") -> Iterator[tuple[str, PlacedPart]]:
    """Every part that may have a position, with its path in the file."""
    for i, sleeve in enumerate(rig.sleeves):
        yield f"sleeves[{i}]", sleeve
    if rig.excitation is not None:
        yield "excitation", rig.excitation
    for i, sensor in enumerate(rig.sensors):
        yield f"sensors[{i}]", sensor
    for i, effect in enumerate(rig.effects):
        yield f"effects[{i}]", effect


def _places_on_an_oscillator(rig: "Rig") -> Iterator[Misfit]:
    for path, part in _placed(rig):
        if isinstance(part, Sleeve):
            yield Misfit(
                f'{path} is "{part.name}", on an oscillator',
                "an oscillator has no sleeves",
                "remove this table, or describe the structure as a beam",
            )
        elif part.position is not None:
            yield Misfit(
                f"{path}.position = {part.position} m, on an oscillator",
                "an oscillator has no length to measure a position along",
                "remove this key, or describe the structure as a beam",
            )


def _places_on_a_beam(rig: "Rig", beam: Beam) -> Iterator[Misfit]:
    for path, part in _placed(rig):
        if part.position is not None and part.position > beam.length:
            yield Misfit(
                f"{path}.position = {part.position} m",
                f"a position lies within the beam, 0 to {beam.length} m",
                "measure from the clamp, in metres, or correct structure.length",
            )
        if isinstance(part, Excitation):
            yield from _excitation_of_a_beam(part)
        if isinstance(part, Sensor) and part.position is None:
            yield Misfit(
                f"{path}.position is missing",
                "a sensor on a beam has a position",
                f'add the distance of "{part.name}" from the clamp, in metres',
            )


def _excitation_of_a_beam(excitation: Excitation) -> Iterator[Misfit]:
    if excitation.quantity == "force" and excitation.position is None:
        yield Misfit(
            "excitation.position is missing",
            "a force on a beam acts at a position",
            "add its distance from the clamp, in metres; for a driven base, change quantity instead",
        )
    if excitation.quantity != "force" and excitation.position is not None:
        yield Misfit(
            f'excitation.position = {excitation.position} m beside quantity = "{excitation.quantity}"',
            "a driven base moves clamp and sleeves together and has no position",
            'remove position, or write quantity = "force"',
        )


def _repeated(table: str, key: str, values: list[str] | list[int | None]) -> Iterator[Misfit]:
    for value, count in Counter(value for value in values if value is not None).items():
        if count > 1:
            first, second = [i for i, other in enumerate(values) if other == value][:2]
            shown = f'"{value}"' if isinstance(value, str) else value
            yield Misfit(
                f"{table}[{second}].{key} = {shown}, as {table}[{first}].{key}",
                f"each {key} stands once in [[{table}]]",
                f"give one of the two another {key}",
            )


def _unknown_names(rig: "Rig") -> Iterator[Misfit]:
    for i, effect in enumerate(rig.effects):
        named = (
            ("sleeve", "sleeve", effect.sleeve, rig.sleeves),
            ("sensor", "sensor", effect.sensor, rig.sensors),
            ("other", "sensor", effect.other, rig.sensors),
        )
        for key, part_of, name, parts in named:
            known = [part.name for part in parts]
            if name is not None and name not in known:
                yield Misfit(
                    f'effects[{i}].{key} = "{name}"',
                    f"an effect's {part_of} is one of this rig's: {', '.join(known) or 'there is none'}",
                    f"write one of these names, or add the {part_of}",
                )
