"""The rig as its owner describes it: frozen, validated data. Units are SI throughout.

Its tables are ``models.rig_parts``; reading and writing the TOML file is ``models.rig_file``; what the numbers do is
``models.plant``.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import log
from typing import Annotated, Any, NamedTuple, TypeVar

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from models.rig_checks import misfits
from models.rig_parts import (
    Beam,
    EffectEntry,
    Excitation,
    ExcitationQuantity,
    Finite,
    NonNegative,
    Oscillator,
    Part,
    Positive,
    Sensor,
    SensorQuantity,
    Sleeve,
    Term,
    term,
)

__all__ = [
    "Beam",
    "EffectEntry",
    "Excitation",
    "ExcitationQuantity",
    "Finite",
    "NonNegative",
    "Oscillator",
    "Part",
    "Positive",
    "Rig",
    "RigParameter",
    "Sensor",
    "SensorQuantity",
    "Sleeve",
    "next_named",
    "quantities_of",
]

Fraction = Annotated[float, Field(gt=0, le=1, allow_inf_nan=False, strict=True)]


@dataclass(frozen=True)
class RigParameter:
    """One number of the rig that the identification may move.

    Attributes:
        path: its place in the rig, e.g. ``youngs_modulus``, ``rayleigh_damping[0]`` or ``sleeves[0].clearance``.
        label: how the report calls it, e.g. ``clearance of sleeve 1``.
        unit: SI unit of ``value`` and ``std``.
        value: as the rig file says.
        std: one standard deviation of the owner's tolerance.
    """

    path: str
    label: str
    unit: str
    value: float
    std: float

    @property
    def tolerance(self) -> float:
        """The standard deviation as a share of the value."""
        return self.std / self.value

    def deviations(self, value: float) -> float:
        """How many standard deviations a value is away, counted in logarithms as the fit counts.

        Args:
            value: another one, positive like this.
        """
        return log(value / self.value) / self.tolerance


class Rig(Part):
    """The whole description. Every other file names its parts by the names given here."""

    structure: Annotated[
        Beam | Oscillator,
        Field(discriminator="kind"),
        Term(
            "structure",
            "",
            'a rig has one [structure] table, whose kind is "beam" or "oscillator"',
            'write [structure] with kind = "beam" or kind = "oscillator"',
        ),
    ]
    tolerances: Annotated[
        dict[str, Fraction],
        Term(
            "tolerance",
            "",
            "a tolerance is one standard deviation as a fraction of the value, above 0 and up to 1",
            'for 3 % write "sleeves.clearance" = 0.03, a dotted key in quotes; leave out what is certain',
        ),
    ] = Field(default_factory=dict)
    sleeves: Annotated[
        tuple[Sleeve, ...],
        Term("sleeves", "", "sleeves are a list of tables", "head each one with [[sleeves]], in double brackets"),
    ] = ()
    excitation: Annotated[
        Excitation | None,
        Term("excitation", "", "the excitation is one table", "head it with [excitation], in single brackets"),
    ] = None
    sensors: Annotated[
        tuple[Sensor, ...],
        Term("sensors", "", "sensors are a list of tables", "head each one with [[sensors]], in double brackets"),
    ] = ()
    effects: Annotated[
        tuple[EffectEntry, ...],
        Term("effects", "", "effects are a list of tables", "head each one with [[effects]], in double brackets"),
    ] = ()

    @model_validator(mode="after")
    def _parts_fit_together(self) -> "Rig":
        found = list(misfits(self))
        if found:
            code = "misfit"
            raise PydanticCustomError(
                code, "{given}; {expected}; {mend}", {**vars(found[0]), "further": len(found) - 1}
            )
        return self

    def sleeve(self, name: str) -> Sleeve:
        """The sleeve of that name.

        Raises:
            KeyError: there is none.
        """
        return next_named(self.sleeves, name)

    def sensor(self, name: str) -> Sensor:
        """The sensor of that name.

        Raises:
            KeyError: there is none.
        """
        return next_named(self.sensors, name)

    def parameters(self) -> tuple[RigParameter, ...]:
        """The toleranced numbers that are not 0, each on its own, in the order of ``tolerances``."""
        return tuple(
            parameter
            for key, fraction in self.tolerances.items()
            for parameter in self._toleranced(key, fraction)
            if parameter.value != 0.0
        )

    def _toleranced(self, key: str, fraction: float) -> Iterator[RigParameter]:
        """One parameter per structure value, per element of a list of numbers, or per sleeve."""
        field = key.removeprefix("sleeves.")
        if field != key:
            words = term(Sleeve, field)
            for i, sleeve in enumerate(self.sleeves):
                value = getattr(sleeve, field)
                label = f"{words.noun} of {sleeve.name}"
                yield RigParameter(f"sleeves[{i}].{field}", label, words.unit, value, fraction * value)
            return
        value, part = getattr(self.structure, key), type(self.structure)
        if isinstance(value, tuple):
            for i, element in enumerate(value):
                words = term(part, key, i)
                yield RigParameter(f"{key}[{i}]", words.noun, words.unit, element, fraction * element)
        else:
            words = term(part, key)
            yield RigParameter(key, words.noun, words.unit, value, fraction * value)

    def with_values(self, values: Mapping[str, float]) -> "Rig":
        """A new rig with some numbers replaced and nothing checked again, for the inner loop of a fit.

        Args:
            values: path as in ``RigParameter.path``, of any number of the structure or a sleeve, to its SI value.

        Raises:
            KeyError: the rig has no number of that path.
        """
        of_structure: dict[str, Any] = {}
        of_sleeves: dict[int, dict[str, Any]] = {}
        for path, value in values.items():
            address = _address(path)
            part = self._part(address)
            changed = of_structure if address.sleeve is None else of_sleeves.setdefault(address.sleeve, {})
            old = changed.get(address.field, vars(part).get(address.field))
            changed[address.field] = _replaced(old, address, float(value))
        sleeves = list(self.sleeves)
        for i, changed in of_sleeves.items():
            sleeves[i] = sleeves[i].model_copy(update=changed)
        structure = self.structure.model_copy(update=of_structure)
        return self.model_copy(update={"structure": structure, "sleeves": tuple(sleeves)})

    def _part(self, address: "_Address") -> Part:
        if address.sleeve is None:
            return self.structure
        if address.sleeve < len(self.sleeves):
            return self.sleeves[address.sleeve]
        raise KeyError(address.path)


class _Address(NamedTuple):
    """A path taken apart: the sleeve's index (None for the structure), the field, the element of a list of numbers."""

    path: str
    sleeve: int | None
    field: str
    element: int | None


@lru_cache(maxsize=4096)
def _address(path: str) -> _Address:
    match = re.fullmatch(r"(?:sleeves\[(\d+)\]\.)?([a-z_]+)(?:\[(\d+)\])?", path)
    if match is None:
        raise KeyError(path)
    sleeve, field, element = match.groups()
    return _Address(path, None if sleeve is None else int(sleeve), field, None if element is None else int(element))


def _replaced(old: Any, address: _Address, value: float) -> Any:
    """The field's new value: the number itself, or the list of numbers with one of them replaced."""
    if isinstance(old, tuple) and address.element is not None and address.element < len(old):
        return (*old[: address.element], value, *old[address.element + 1 :])
    if isinstance(old, float) and address.element is None:
        return value
    raise KeyError(address.path)


Named = TypeVar("Named", Sleeve, Sensor)


def next_named(parts: tuple[Named, ...], name: str) -> Named:
    """The part of that name among ``parts``.

    Raises:
        KeyError: there is none.
    """
    for part in parts:
        if part.name == name:
            return part
    raise KeyError(name)


def quantities_of(sensors: Iterable[Sensor], names: Iterable[str]) -> tuple[str, ...]:
    """What the sensors of these names measure.

    Args:
        sensors: of a rig.
        names: of some of them, in any order.
    """
    measured = {sensor.name: sensor.quantity for sensor in sensors}
    return tuple(measured[name] for name in names)
