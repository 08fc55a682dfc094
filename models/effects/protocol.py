"""What an effect is: parameters, a place, a source, and one pure piece of physics.

An effect overrides exactly one of the hooks of its family; the defaults change nothing. Nothing else in the project
knows the kinds: whoever needs one asks ``models.effects.EFFECTS``.
"""

from abc import ABC
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from functools import cache
from math import inf
from typing import Any, ClassVar, Literal, Self

import numpy as np

from models.arrays import FloatArray
from models.ports import Contact, Frame, PointLaw, Port
from models.rig import Sensor
from models.structure import Structure

Family = Literal["point force", "structure", "time", "measurement"]
PlaceKind = Literal["sleeve", "position", "sensor", "sensor pair"]
StructureKind = Literal["beam", "oscillator"]
Scale = Literal["log", "linear"]


@dataclass(frozen=True)
class Place:
    """Where an effect sits: a sleeve, a sensor or two, a position (m from the clamp), or nowhere in particular.

    ``position`` is also filled in for a sleeve by ``models.plant``, so that every point law knows its coordinate.
    ``other`` is the second sensor of a pair, after the first in the order of the rig.
    """

    sleeve: str | None = None
    position: float | None = None
    sensor: str | None = None
    other: str | None = None

    def __str__(self) -> str:
        """As an engineer says it: ``at sleeve 2``, ``at 0.830 m``, ``on P3``, or nothing."""
        if self.sleeve is not None:
            return f"at {self.sleeve}"
        if self.sensor is not None:
            return f"on {self.sensor}" + ("" if self.other is None else f" and {self.other}")
        return "" if self.position is None else f"at {self.position:.3f} m"


@dataclass(frozen=True)
class Parameter:
    """One number of an effect, as the vocabulary, the fit and the report know it.

    Attributes:
        symbol: as in the formula.
        unit: SI, ``-`` for a ratio.
        lower, upper: bounds.
        scale: ``log`` for a positive scale parameter, ``linear`` otherwise.
        spread: one standard deviation of the prior, in e-folds (log) or in the parameter's own unit (linear).
        fitted: False for a number that the data do not determine (a width, the times of a table).
        table: a tuple of numbers instead of one.
        step: difference for numerical derivatives, in spreads.
        on_beam: a place, m from the clamp, which ends with the beam.
        neutral: value at which the effect is not there, and from which its size is proportional to the distance (from
            infinity: to the inverse); None where there is no such value.
    """

    symbol: str
    unit: str
    lower: float = -inf
    upper: float = inf
    scale: Scale = "log"
    spread: float = 2.0
    fitted: bool = True
    table: bool = False
    neutral: float | None = None
    step: float = 0.01
    on_beam: bool = False


def parameter(
    symbol: str,
    unit: str,
    *,
    lower: float = -inf,
    upper: float = inf,
    scale: Scale = "log",
    spread: float = 2.0,
    fitted: bool = True,
    table: bool = False,
    neutral: float | None = None,
    step: float = 0.01,
    on_beam: bool = False,
    default: Any = MISSING,
) -> Any:
    """A dataclass field that is a parameter of an effect (see ``Parameter``)."""
    about = Parameter(symbol, unit, lower, upper, scale, spread, fitted, table, neutral, step, on_beam)
    return field(metadata={"parameter": about}, default=default)


@dataclass(frozen=True)
class Scene:
    """What the given model says about the motion at a place, from which an effect chooses trial values.

    Displacement, velocity, force and duration are positive, whatever the record; without an excitation channel the
    force is the modal mass times the acceleration.

    Attributes:
        place: where the effect would sit.
        contact: the sleeve's contact, or None where the place is no sleeve.
        structure: the linear structure.
        displacement: largest |q - mean| at the place, m.
        velocity: rms of v at the place, relative to the base, m/s.
        force: rms of the excitation as a force, N (for a driven base, modal mass times acceleration).
        penetration: largest penetration at the sleeve, m; 0 where there is none.
        duration: of the longest record, s.
        driven_base: whether the base moves, so that ``against = "ground"`` is another effect than ``"base"``.
        rest: displacement at rest, gravity's sag included, m.
        ground_velocity: rms of the absolute velocity, m/s, where the base is driven.
        natural_freqs: of the first modes about rest, Hz.
        sensor_position: where the place's sensor should be, m from the clamp; None where the place is no sensor.
        lines: frequencies, Hz, of single lines in the records that the model does not explain, the strongest first.
        loudness: rms of the measured channels over the model's, the median of all.
        lag: by how much the place's channel is later than the model's, as far as they are most alike then, s; 0 where
            the place is no single sensor, or no lag is told.
    """

    place: Place
    contact: Contact | None
    structure: Structure
    displacement: float
    velocity: float
    force: float
    penetration: float
    duration: float
    driven_base: bool
    rest: float = 0.0
    ground_velocity: float = 0.0
    natural_freqs: tuple[float, ...] = ()
    sensor_position: float | None = None
    lines: tuple[float, ...] = ()
    loudness: float = 1.0
    lag: float = 0.0

    def reached(self) -> tuple[float, ...]:
        """Distances from rest that the motion comes to hard, often and hardly, m: of a wall that acts at all."""
        return tuple(share * self.displacement for share in REACHED)


REACHED = (0.3, 0.6, 0.9)
"""Shares of the largest displacement."""


@dataclass(frozen=True)
class Measurement:
    """What a change of the measurement chain sees of a record.

    Attributes:
        sensors: names, in the order of the channels.
        fs: Hz.
        free: values of this record's own parameters (``record_parameters``), by name.
    """

    sensors: tuple[str, ...]
    fs: float
    free: Mapping[str, float]


@dataclass(frozen=True)
class Signature:
    """Where an effect shows in the data, in plain words.

    Attributes:
        frequency: what it does to the spectrum.
        level: at which level of the excitation it shows.
        time: when in a record.
        place: where along the structure, or on which channels.
    """

    frequency: str
    level: str
    time: str
    place: str


@dataclass(frozen=True)
class Effect(ABC):
    """Base of all effects: the place; subclasses add their parameters with ``parameter(...)``.

    Class attributes:
        kind: name in the vocabulary.
        family: which of the four kinds of physics.
        places: what the place may be; empty for an effect over the whole beam or the whole measurement.
        structures: what it can be added to.
        source: citation.
        signature: where it shows in the data.
        options: keys that choose a variant, each with its values, the default first; they are fields too.
        record_parameters: numbers that every record has for itself (a phase), by name.
        unique: at most one of this kind can sit at a place (two springs in parallel are one spring; two absorbers of
            different frequencies are two).
    """

    kind: ClassVar[str]
    family: ClassVar[Family]
    places: ClassVar[tuple[PlaceKind, ...]] = ()
    structures: ClassVar[tuple[StructureKind, ...]] = ("beam",)
    source: ClassVar[str]
    signature: ClassVar[Signature]
    options: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    record_parameters: ClassVar[Mapping[str, Parameter]] = {}
    unique: ClassVar[bool] = True

    place: Place

    @classmethod
    @cache
    def parameters(cls) -> dict[str, Parameter]:
        """The effect's parameters by name, in the order of the fields."""
        return {f.name: f.metadata["parameter"] for f in _own_fields(cls) if "parameter" in f.metadata}

    @classmethod
    def has_default(cls, name: str) -> bool:
        """Whether a table may leave this parameter out."""
        return any(f.name == name and f.default is not MISSING for f in _own_fields(cls))

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Values worth trying when nothing is known but the scene: few, but of all that could hide in the data."""
        raise NotImplementedError

    @property
    def valley(self) -> str:
        """In which of several valleys its numbers lie, if a fit hardly crosses from one to another; empty if in one."""
        return ""

    def is_variant_of(self, other: "Effect") -> bool:
        """Whether it differs from another one of its kind in more than numbers and place: by an option or a valley.

        Args:
            other: of the same kind.
        """
        return self.valley != other.valley or not self.has_options_of(other)

    def has_options_of(self, other: "Effect") -> bool:
        """Whether all its options are those of another one of its kind.

        Args:
            other: of the same kind.
        """
        return all(getattr(self, key) == getattr(other, key) for key in self.options)

    @classmethod
    def sits_at(cls, place: Place) -> tuple[Place, ...]:
        """Where an effect of this kind acts that is tried at a place."""
        return (place,)

    @classmethod
    def part_kind(cls) -> str:
        """Kind of the effects that act."""
        return cls.kind

    def parts(self) -> tuple["Effect", ...]:
        """The effects that act: itself, or the members of which it is made."""
        return (self,)

    def change_structure(self, structure: Structure) -> Structure:
        """The linear structure with this effect in it."""
        return structure

    def change_contact(self, contact: Contact) -> Contact:
        """The contact of the effect's sleeve with this effect in it."""
        return contact

    def as_sleeve_numbers(self, contact: Contact) -> Mapping[str, float]:  # noqa: ARG002
        """Numbers of its sleeve, by their keys in a rig file, that do what it does in the mean; empty where none does.

        Args:
            contact: of its sleeve, without it.
        """
        return {}

    @classmethod
    def from_sleeve_number(cls, place: Place, contact: Contact, key: str, value: float) -> Self | None:  # noqa: ARG003
        """The effect that does what a number of its sleeve does, the inverse of ``as_sleeve_numbers``; or None.

        Args:
            place: the sleeve.
            contact: of the sleeve, without it.
            key: of the number in a rig file.
            value: of the number, SI.
        """
        return None

    def point_laws(self, contact: Contact | None, structure: Structure) -> tuple[PointLaw, ...]:  # noqa: ARG002
        """Forces on the structure; ``contact`` is that of the effect's sleeve, with all changes, or None."""
        return ()

    def change_excitation(self, excitation: FloatArray) -> FloatArray:
        """(N,) the true excitation from the channel as measured."""
        return excitation

    @classmethod
    def is_of_excitation(cls) -> bool:
        """Whether it changes the excitation from what its channel reads."""
        return cls.change_excitation is not Effect.change_excitation

    def change_sensors(self, sensors: tuple[Sensor, ...], structure: Structure) -> tuple[Sensor, ...]:  # noqa: ARG002
        """The sensors where they really are on the structure."""
        return sensors

    def change_channels(self, channels: FloatArray, measurement: Measurement) -> FloatArray:  # noqa: ARG002
        """(n, N) the channels as read, from the true motion."""
        return channels

    def looks_back(self) -> float:
        """Seconds of true motion before a sample that what is read then depends on."""
        return 0.0

    def base_acceleration(self, time: FloatArray, free: Mapping[str, float]) -> FloatArray | None:  # noqa: ARG002
        """(N,) an unmeasured acceleration of the base at ``time``, s from the record's start, m/s^2, or None."""
        return None

    def port(self, contact: Contact | None, frame: Frame = "base") -> Port:
        """Where the effect's force acts: at its sleeve's contact, else at its position (None on an oscillator)."""
        return Port(self.place.position if contact is None else contact.position, frame=frame)

    def scaled(self, factor: float) -> Self:
        """The same effect, ``factor`` times as large, as far as its parameters have a neutral value."""
        values = self.fitted_values()
        for i, (_, about) in enumerate(self.fitted_parameters()):
            if about.neutral is None:
                continue
            away = values[i] / factor if about.neutral == inf else about.neutral + factor * (values[i] - about.neutral)
            values[i] = min(max(away, about.lower), about.upper)
        return self.with_fitted(values)

    def refined(self) -> Iterator[Self]:
        """The same effect described in more detail, where its parameters allow (a table with more entries)."""
        return iter(())

    def in_words(self) -> str:
        """One line for the report: when it acts and what it does, in plain words."""
        raise NotImplementedError

    def label(self) -> str:
        """Kind and place, as tables show it: ``squeeze_film at sleeve 2``."""
        options = "".join(f" {key} {getattr(self, key)}" for key in self.options)
        return f"{self.kind}{options} {self.place}".strip()

    @property
    def n_numbers(self) -> int:
        """How many a fit determines; a table is one."""
        return len({name for name, _ in self.fitted_parameters()})

    def fitted_values(self) -> FloatArray:
        """(n,) the fitted parameters in a row; a vector parameter takes as many entries as it has."""
        rows = [np.atleast_1d(getattr(self, name)) for name, about in self.parameters().items() if about.fitted]
        return np.concatenate(rows).astype(float) if rows else np.empty(0)

    def fitted_parameters(self) -> tuple[tuple[str, Parameter], ...]:
        """(name, parameter) for each entry of ``fitted_values``."""
        return tuple(
            (name, about)
            for name, about in self.parameters().items()
            if about.fitted
            for _ in np.atleast_1d(getattr(self, name))
        )

    def with_fitted(self, values: FloatArray) -> Self:
        """The same effect with other values, in the order of ``fitted_values``."""
        changes: dict[str, Any] = {}
        start = 0
        for name, about in self.parameters().items():
            if not about.fitted:
                continue
            old = getattr(self, name)
            if isinstance(old, tuple):
                changes[name] = tuple(float(x) for x in values[start : start + len(old)])
                start += len(old)
            else:
                changes[name] = float(values[start])
                start += 1
        return replace(self, **changes)


def _own_fields(cls: type[Effect]) -> tuple[Field[Any], ...]:
    return fields(cls)
