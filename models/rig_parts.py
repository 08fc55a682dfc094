"""The tables of a rig file: frozen, validated parts in SI units, each key with the words that explain it.

A part checks its own values; whether the parts fit together is ``models.rig_checks``.
"""

import sys
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False, strict=True)]
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
ExcitationQuantity = Literal["force", "base_acceleration", "base_velocity", "base_displacement"]
SensorQuantity = Literal["acceleration", "velocity", "displacement", "angular_velocity"]


@dataclass(frozen=True)
class Term:
    """What an engineer should read about a key: its noun, its unit, the rule for its value, how to mend a breach."""

    noun: str
    unit: str
    rule: str
    mend: str


SETTING = Term(
    "setting",
    "",
    "a setting is a finite number, a text, true or false, or a list of these",
    "see the table of effects for what this kind takes",
)


def term(part: type[BaseModel], key: str, element: int | None = None) -> Term:
    """The words for a key of a part, or for one element of it where the key holds several numbers.

    Raises:
        StopIteration: the key carries no words, which a test excludes.
    """
    field = part.model_fields[key]
    metadata = field.metadata if element is None else get_args(field.annotation)[element].__metadata__
    return next(item for item in metadata if isinstance(item, Term))


def _printable(name: str) -> str:
    if not name.isprintable() or name != name.strip() or not name:
        code = "name"
        raise PydanticCustomError(code, "not a printable name")
    return name


def _frozen_setting(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return tuple(_frozen_setting(item) for item in value)
    if isinstance(value, str) or (isinstance(value, int | float) and abs(value) <= sys.float_info.max):
        return value
    code = "setting"
    raise PydanticCustomError(code, "not a finite number, a text, true or false, or a list of these")


Name = Annotated[str, AfterValidator(_printable)]
Setting = Annotated[Any, AfterValidator(_frozen_setting)]
NodeNumber = Annotated[int, Field(ge=0, strict=True)]
Sensitivity = Annotated[str, Field(pattern=r"^\s*(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[^\s\d/][^\s/]*\s*/\s*\S+\s*$")]

NAME = Term("name", "", "a name is a printable text without blanks around it", 'write it in quotes, as in "P1"')
NODE = Term(
    "node",
    "",
    "a node is the whole number that the records carry, 0 or more",
    "copy it from the records or leave it out",
)
SENSITIVITY = Term(
    "sensitivity",
    "",
    "a sensitivity is a number and a unit per unit",
    'write it as in "100 mV/g", or leave it out where the records carry units',
)
KIND = Term("kind", "", 'a structure\'s kind is "beam" or "oscillator"', "choose one of these two")
GRAVITY = Term("gravity", "m/s^2", "gravity is a finite number", "write 9.81 on the ground and 0 in orbit")


class Part(BaseModel):
    """A frozen table of the rig file; unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Beam(Part):
    """A solid round cantilever; ``rayleigh_damping`` is (eta1 1/s, eta2 s) of C = eta1 M + eta2 K."""

    uncertain: ClassVar[tuple[str, ...]] = ("youngs_modulus", "density", "diameter", "length", "rayleigh_damping")

    kind: Annotated[Literal["beam"], KIND]
    length: Annotated[Positive, Term("length", "m", "a length is above 0", "measure from the clamp to the tip")]
    diameter: Annotated[Positive, Term("diameter", "m", "a diameter is above 0", "give the solid round section's")]
    youngs_modulus: Annotated[
        Positive, Term("Young's modulus", "Pa", "a Young's modulus is above 0", "for steel write 210e9")
    ]
    density: Annotated[Positive, Term("density", "kg/m^3", "a density is above 0", "for steel write 7850.0")]
    rayleigh_damping: Annotated[
        tuple[
            Annotated[
                NonNegative, Term("Rayleigh damping eta1", "1/s", "eta1 is 0 or more", "write 0 for none of this part")
            ],
            Annotated[
                NonNegative, Term("Rayleigh damping eta2", "s", "eta2 is 0 or more", "write 0 for none of this part")
            ],
        ],
        Term(
            "Rayleigh damping",
            "",
            "Rayleigh damping is a list of two numbers, eta1 in 1/s and eta2 in s",
            "write it as in [1.2, 6e-6]",
        ),
    ] = (0.0, 0.0)
    gravity: Annotated[Finite, GRAVITY] = 9.81


class Oscillator(Part):
    """One degree of freedom: mass kg, stiffness N/m (0 allowed), damping N s/m."""

    uncertain: ClassVar[tuple[str, ...]] = ("mass", "stiffness", "damping")

    kind: Annotated[Literal["oscillator"], KIND]
    mass: Annotated[Positive, Term("mass", "kg", "a mass is above 0", "weigh what moves")]
    stiffness: Annotated[
        NonNegative, Term("stiffness", "N/m", "a stiffness is 0 or more", "write 0 for a mass that nothing holds")
    ]
    damping: Annotated[NonNegative, Term("damping", "N s/m", "a damping is 0 or more", "write 0 for none")]
    gravity: Annotated[Finite, GRAVITY] = 0.0


class Sleeve(Part):
    """A support sleeve: where it is, its radial clearance m, its contact law with stiffness N/m and damping N s/m."""

    uncertain: ClassVar[tuple[str, ...]] = ("clearance", "stiffness", "damping")

    name: Annotated[Name, NAME]
    position: Annotated[
        Positive, Term("position", "m", "a sleeve's position is above 0", "measure from the clamp towards the tip")
    ]
    clearance: Annotated[
        NonNegative, Term("clearance", "m", "a clearance is 0 or more", "for a preload, use gap_offset")
    ]
    law: Annotated[str, Term("law", "", "a law is the name of a contact law", 'write it as in "kelvin_voigt"')] = (
        "kelvin_voigt"
    )
    stiffness: Annotated[
        Positive, Term("stiffness", "N/m", "a contact's stiffness is above 0", "without contact, leave the sleeve out")
    ]
    damping: Annotated[
        NonNegative, Term("damping", "N s/m", "a contact's damping is 0 or more", "write 0 for none")
    ] = 0.0


class Excitation(Part):
    """What drives the rig, and where (a driven base has no position)."""

    name: Annotated[Name, NAME] = "excitation"
    node: Annotated[NodeNumber | None, NODE] = None
    position: Annotated[
        Positive | None,
        Term("position", "m", "an excitation's position is above 0", "for a driven base, change quantity instead"),
    ] = None
    quantity: Annotated[
        ExcitationQuantity,
        Term(
            "quantity",
            "",
            "an excitation's quantity is force, base_acceleration, base_velocity or base_displacement",
            "choose one of these four",
        ),
    ] = "force"
    sensitivity: Annotated[Sensitivity | None, SENSITIVITY] = None


class Sensor(Part):
    """One channel: a name, a node number, a position from the clamp (none on an oscillator) and what it measures."""

    name: Annotated[Name, NAME]
    node: Annotated[NodeNumber | None, NODE] = None
    position: Annotated[
        NonNegative | None,
        Term("position", "m", "a sensor's position is 0 or more", "measure from the clamp towards the tip"),
    ] = None
    quantity: Annotated[
        SensorQuantity,
        Term(
            "quantity",
            "",
            "a sensor's quantity is acceleration, velocity, displacement or angular_velocity",
            "choose one of these four",
        ),
    ] = "acceleration"
    sensitivity: Annotated[Sensitivity | None, SENSITIVITY] = None


class EffectEntry(BaseModel):
    """One ``[[effects]]`` table as written: a kind, a place, and the kind's own keys (checked by the registry)."""

    model_config = ConfigDict(frozen=True, extra="allow")
    __pydantic_extra__: dict[str, Setting] = Field(init=False)

    kind: Annotated[
        Name, Term("kind", "", "an effect's kind is the name of an effect", 'write it as in "squeeze_film"')
    ]
    sleeve: Annotated[
        Name | None, Term("sleeve", "", "an effect's sleeve is the name of a sleeve", 'write it as in "sleeve 1"')
    ] = None
    sensor: Annotated[
        Name | None, Term("sensor", "", "an effect's sensor is the name of a sensor", 'write it as in "P1"')
    ] = None
    other: Annotated[
        Name | None, Term("other", "", "an effect's other sensor is the name of a sensor", 'write it as in "P2"')
    ] = None
    position: Annotated[
        Positive | None,
        Term("position", "m", "an effect's position is above 0", "measure from the clamp towards the tip"),
    ] = None

    @property
    def place(self) -> dict[str, Any]:
        """The place keys that the table gives; beside a sensor, ``position`` is a setting (``sensor_position``)."""
        keys = ("sleeve", "sensor", "other") if self.sensor is not None else ("sleeve", "other", "position")
        return {key: value for key in keys if (value := getattr(self, key)) is not None}

    @property
    def settings(self) -> dict[str, Any]:
        """The kind's own keys: parameters and options such as ``against``."""
        own = dict(self.model_extra or {})
        if self.sensor is not None and self.position is not None:
            own["position"] = self.position
        return own
