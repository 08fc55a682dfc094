"""From a unit label, or the rig's sensitivity, to the factor that makes SI of a channel."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

from models.errors import InputError
from models.rig import Excitation, Rig, Sensor
from testbed.records.recording import Tag

if TYPE_CHECKING:
    import pint

SI_UNITS = {
    "acceleration": "m/s^2",
    "velocity": "m/s",
    "displacement": "m",
    "angular_velocity": "rad/s",
    "force": "N",
}

_TERM = r"[^\W\d]+(?:(?:\^|\*\*)?-?\d|⁻?[¹²³])?"
_LABEL = re.compile(rf"[\s(]*(?:1|°|{_TERM})(?:[\s()/*·.]+(?:°|{_TERM}))*[\s)]*")
"""Units with exponents of one digit: all that a channel needs, and nothing that takes long to evaluate."""

_LONGEST_LABEL = 40
_GRAVITY = re.compile(r"(?<![^\W\d])([mµμu]?)g(?:_?[0n])?(?!\w)")
_BARE_EXPONENT = re.compile(r"(?<=[^\W\d_])(-?\d)")
_SENSITIVITY = re.compile(r"\s*([\d.]+(?:[eE][+-]?\d+)?)\s*([^/]+?)\s*/\s*(.+?)\s*")
_NOT_ANGULAR = ("hertz", "count", "becquerel")


@dataclass(frozen=True)
class Measured:
    """What the rig says of a channel: whose it is, its quantity, and its sensitivity where the records hold volts."""

    name: str
    quantity: str
    sensitivity: str | None

    @classmethod
    def of(cls, part: Sensor | Excitation) -> "Measured":
        """The part's words; a base quantity is measured like any other."""
        return cls(part.name, part.quantity.removeprefix("base_"), part.sensitivity)


@cache
def _registry() -> "pint.UnitRegistry[Any]":
    import pint

    return pint.UnitRegistry()


@lru_cache(maxsize=256)
def _unit(label: str) -> "pint.Unit | None":
    """The unit of a label, in which g is gravity and never the gram; None if it is not one."""
    text = label.strip()
    if len(text) > _LONGEST_LABEL or not _LABEL.fullmatch(text):
        return None
    text = _BARE_EXPONENT.sub(r"^\1", _GRAVITY.sub(r"\1standard_gravity", text))
    try:
        return _registry().parse_units(text)
    except Exception:  # noqa: BLE001 - pint lets the exceptions of its tokenizer through
        return None


def _factor(unit: "pint.Unit", to: "pint.Unit") -> float | None:
    """By how much to multiply, or None between different dimensions."""
    if unit.dimensionality != to.dimensionality:
        return None
    return float(_registry().Quantity(1.0, unit).to(to).magnitude)


def _factor_to_si(unit: "pint.Unit", quantity: str) -> float | None:
    # A rate of turning is 1/s to pint, and so are things that are none.
    if quantity == "angular_velocity" and any(word in str(unit) for word in _NOT_ANGULAR):
        return None
    return _factor(unit, _registry().parse_units(SI_UNITS[quantity]))


def is_unit(label: str) -> bool:
    """Whether a label is the unit of a time or of a quantity that is measured, in volts or counts too.

    Args:
        label: as a file has it.
    """
    unit = _unit(label)
    if unit is None:
        return False
    is_time = unit.dimensionality == _registry().second.dimensionality
    return is_time or _is_electrical(unit) or quantity_of(Tag(unit=label)) is not None


def quantity_of(tag: Tag) -> str | None:
    """The quantity that a channel's unit, or else its file, says it is; None for volts, unknown units and silence."""
    unit = _unit(tag.unit) if tag.unit is not None else None
    if unit is not None:
        for quantity in SI_UNITS:
            if _factor_to_si(unit, quantity) is not None:
                return quantity
    return tag.quantity


def label_factor(tag: Tag, quantity: str) -> float | None:
    """The factor to SI by a channel's own label alone; None where it has none, or that of volts or another quantity.

    Args:
        tag: the file's words.
        quantity: what the channel measures.
    """
    unit = _unit(tag.unit) if tag.unit is not None else None
    return None if unit is None else _factor_to_si(unit, quantity)


def seconds(label: str | None, where: str) -> float:
    """The factor from a time base's unit to seconds.

    Raises:
        InputError: the label is no unit of time.
    """
    if label is None:
        return 1.0
    unit = _unit(label)
    factor = None if unit is None else _factor(unit, _registry().parse_units("s"))
    if factor is None:
        raise InputError(f'{where}: time in "{label}"', "a time base has a unit of time", "write time [s]")
    return factor


def si_factor(tag: Tag, measured: Measured, file: str, unlabelled: Mapping[str, float]) -> tuple[float, str | None]:
    """The factor from a channel's samples to SI, and a finding where a unit had to be assumed.

    Args:
        tag: the file's words, sign excluded.
        measured: the rig's words.
        file: its name, for errors.
        unlabelled: quantity -> factor that the file states for channels without label.

    Raises:
        InputError: an unknown unit, a unit of another quantity, or volts without sensitivity.
    """
    where = f"{file}: channel {tag.shown}"
    if tag.unit is None:
        return _assumed_factor(tag, measured, where, unlabelled)
    unit = _unit(tag.unit)
    if unit is None:
        raise InputError(
            f'{where} has the unknown unit "{tag.unit}"',
            f"{measured.name} is {_a(measured.quantity)}, in {SI_UNITS[measured.quantity]} or a unit like it",
            "correct the label in the file",
        )
    factor = _factor_to_si(unit, measured.quantity)
    if factor is not None:
        return factor, None
    if quantity_of(Tag(unit=tag.unit)) is None and measured.sensitivity is not None:
        return _through_sensitivity(unit, tag.unit, measured, where), None
    if _is_electrical(unit):
        raise InputError(
            f'{where} is in "{tag.unit}" and the rig gives {measured.name} no sensitivity',
            "a record in volts or counts needs the sensitivity of each channel",
            f'add sensitivity = "100 {tag.unit}/{_common(measured.quantity)}", with the right number, '
            f"to {measured.name} in the rig file",
        )
    raise _mismatch(f'in "{tag.unit}"', measured, where)


def frf_factor(
    response: Tag, reference: Tag, sensor: Measured, excitation: Measured, *, file: str, unlabelled: Mapping[str, float]
) -> float:
    """The factor from an FRF's values to SI: one label may hold both units, as in ``g/N``.

    Raises:
        InputError: as ``si_factor``.
    """
    both = _unit(response.unit) if response.unit is not None else None
    if both is not None:
        units = _registry().parse_units
        factor = _factor(both, units(SI_UNITS[sensor.quantity]) / units(SI_UNITS[excitation.quantity]))
        if factor is not None:
            return factor
    above, _ = si_factor(response, sensor, file, unlabelled)
    below, _ = si_factor(reference, excitation, file, unlabelled)
    return above / below


def _assumed_factor(
    tag: Tag, measured: Measured, where: str, unlabelled: Mapping[str, float]
) -> tuple[float, str | None]:
    if tag.quantity not in (None, measured.quantity):
        raise _mismatch(f"{_a(tag.quantity)}", measured, where)
    if measured.quantity in unlabelled:
        return unlabelled[measured.quantity], None
    if measured.sensitivity is not None:
        label = _sensitivity(measured)[1]
        unit = _unit(label)
        assert unit is not None
        factor = _through_sensitivity(unit, label, measured, where)
        return factor, f"{where} has no unit; read as {label} through the sensitivity {measured.sensitivity}"
    return 1.0, f"{where} has no unit; read as {SI_UNITS[measured.quantity]}"


def _through_sensitivity(unit: "pint.Unit", label: str, measured: Measured, where: str) -> float:
    number, electrical, per = _sensitivity(measured)
    above, below = _unit(electrical), _unit(per)
    assert above is not None
    assert below is not None
    to_electrical, to_si = _factor(unit, above), _factor_to_si(below, measured.quantity)
    if to_electrical is None or to_si is None:
        raise InputError(
            f'{where} is in "{label}" and {measured.name} has sensitivity = "{measured.sensitivity}"',
            f"the sensitivity leads from the record's unit to {_a(measured.quantity)}",
            "correct the sensitivity in the rig file or the unit in the record",
        )
    return to_electrical / number * to_si


def _sensitivity(measured: Measured) -> tuple[float, str, str]:
    """Number, electrical unit and mechanical unit of, e.g., ``100 mV/g``."""
    match = _SENSITIVITY.fullmatch(measured.sensitivity or "")
    if match and _unit(match[2]) is not None and _unit(match[3]) is not None:
        try:
            number = float(match[1])
        except ValueError:
            number = 0.0
        if number > 0:
            return number, match[2], match[3]
    raise InputError(
        f'{measured.name}: sensitivity = "{measured.sensitivity}"',
        'a sensitivity is a number above 0 and two known units, as in "100 mV/g"',
        "correct it in the rig file",
    )


def check_sensitivities(rig: Rig) -> None:
    """Whether each sensitivity of a rig leads to the quantity of its channel, though no record may need it.

    Args:
        rig: whose sensors and excitation have sensitivities.

    Raises:
        InputError: one is no sensitivity, or of another quantity.
    """
    driven = [] if rig.excitation is None else [Measured.of(rig.excitation)]
    for measured in (*map(Measured.of, rig.sensors), *driven):
        if measured.sensitivity is None:
            continue
        per = _unit(_sensitivity(measured)[2])
        if per is None or _factor_to_si(per, measured.quantity) is None:
            raise InputError(
                f'{measured.name}: sensitivity = "{measured.sensitivity}"',
                f"{measured.name} measures {_a(measured.quantity)}, so its sensitivity is per "
                f"{_common(measured.quantity)} or a unit like it",
                "correct sensitivity or quantity in the rig file",
            )


def _is_electrical(unit: "pint.Unit") -> bool:
    registry = _registry()
    return unit.dimensionality == registry.volt.dimensionality or unit == registry.count


def _common(quantity: str) -> str:
    return "g" if quantity == "acceleration" else SI_UNITS[quantity]


def _a(quantity: str | None) -> str:
    words = str(quantity).replace("_", " ")
    return f"an {words}" if words[0] in "aeiou" else f"a {words}"


def _mismatch(found: str, measured: Measured, where: str) -> InputError:
    return InputError(
        f"{where} is {found}",
        f"the rig says {measured.name} is {_a(measured.quantity)}, in {SI_UNITS[measured.quantity]} or a unit like it",
        "correct the unit in the file, or quantity or sensitivity in the rig file",
    )
