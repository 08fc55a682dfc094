"""A hypothesis about the rig: numbers of the rig file, effects besides, and the state each record starts from.

An ``Unknown`` is one number of it that a fit may move, in a coordinate in which one unit is about one standard
deviation of what is known beforehand.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, inf, log

import numpy as np

from models.arrays import FloatArray
from models.effects import EFFECTS, Effect, Registry
from models.effects.protocol import Parameter
from models.plant import Plant, build_plant, contact_of
from models.record import Record
from models.rig import Beam, Rig, RigParameter
from models.simulate import Motion, Response, Settings, motion_at, simulate


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """The rig as given, with other values for its toleranced numbers, more effects, and moving starts.

    Attributes:
        rig: as its owner describes it.
        values: path -> value, for numbers that differ from the rig file.
        effects: besides those of the rig file.
        starts: record name -> (2n,) modal state at its first sample; from rest where absent.
        motions: record name -> how it moves at its first sample, of a part of a record that begins late.
        offsets: record name -> what its excitation channel reads at rest, SI; 0 where absent.
        own: record name -> the record's own numbers of effects (``Effect.record_parameters``), by name.
        registry: kind -> class.
    """

    rig: Rig
    values: Mapping[str, float] = field(default_factory=dict)
    effects: tuple[Effect, ...] = ()
    starts: Mapping[str, FloatArray] = field(default_factory=dict)
    motions: Mapping[str, Motion] = field(default_factory=dict)
    offsets: Mapping[str, float] = field(default_factory=dict)
    own: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    registry: Registry = field(default_factory=lambda: EFFECTS, repr=False)

    @cached_property
    def updated_rig(self) -> Rig:
        """The rig with the values of this hypothesis, still without its effects."""
        return self.rig.with_values(self.values) if self.values else self.rig

    def plant(self) -> Plant:
        """What is simulated, built once."""
        return self._plant

    @cached_property
    def _plant(self) -> Plant:
        return build_plant(self.updated_rig, self.effects, self.registry)

    def looks_back(self, sensors: Sequence[str]) -> float:
        """Seconds of true motion before a sample that what these sensors read then depends on."""
        return max((e.looks_back() for e in self.plant().effects if e.place.sensor in sensors), default=0.0)

    def simulated(self, record: Record, settings: Settings, plant: Plant | None = None) -> Response:
        """The response to a record's excitation, less its offset, from the record's start.

        Args:
            record: measured.
            settings: resolution.
            plant: of this hypothesis, if it is at hand.
        """
        start, own = self.start_of(record.name), self.own.get(record.name)
        return simulate(plant or self.plant(), record, settings, start, own, self.offsets.get(record.name, 0.0))

    def motion_at(self, record: Record, sample: int, settings: Settings, plant: Plant | None = None) -> Motion:
        """How the structure moves at a sample of a record.

        Args:
            record: measured.
            sample: counted from 0.
            settings: resolution.
            plant: of this hypothesis, if it is at hand.
        """
        start, own = self.start_of(record.name), self.own.get(record.name)
        zero = self.offsets.get(record.name, 0.0)
        return motion_at(plant or self.plant(), record, sample, settings, start, own, zero)

    def start_of(self, name: str) -> FloatArray | Motion | None:
        """State or motion at a record's first sample, None from rest."""
        return self.starts.get(name, self.motions.get(name))

    def at_zero(self, record: Record) -> Record:
        """The record with its excitation less what its channel reads at rest."""
        offset = self.offsets.get(record.name, 0.0)
        if not offset or record.excitation is None:
            return record
        return replace(record, excitation=record.excitation - offset)

    def with_effects(self, *effects: Effect) -> "Hypothesis":
        """With more effects."""
        return replace(self, effects=(*self.effects, *effects))

    def with_effect_at(self, index: int, effect: Effect) -> "Hypothesis":
        """With an effect in the place of one of its own."""
        return replace(self, effects=(*self.effects[:index], effect, *self.effects[index + 1 :]))

    def without_effect(self, index: int) -> "Hypothesis":
        """Without one of its effects."""
        return replace(self, effects=(*self.effects[:index], *self.effects[index + 1 :]))

    def handed_back(self, index: int) -> "Hypothesis":
        """Without one of its effects, its sleeve's own numbers saying as much of what it said as their tolerances let.

        A number that an effect stands for is moved by nothing, and without the effect may lie in another valley.
        """
        less = self.without_effect(index)
        places = {sleeve.name: i for i, sleeve in enumerate(self.rig.sleeves)}
        for part in self.effects[index].parts():
            if part.place.sleeve is None:
                continue
            numbers = part.as_sleeve_numbers(contact_of(less.updated_rig.sleeve(part.place.sleeve)))
            said = {f"sleeves[{places[part.place.sleeve]}].{key}": value for key, value in numbers.items()}
            for parameter in self.rig.parameters():
                if said.get(parameter.path, 0.0) > 0.0:
                    less = RigUnknown(parameter).set(less, parameter.deviations(said[parameter.path]))
        return less


LARGEST_SIGMA = 4.0
"""A number further from the rig file than this is not a matter of tolerance: something is missing or wrong."""


class Unknown(ABC):
    """One number that a fit may move.

    Attributes:
        step: difference for numerical derivatives, in the unknown's own coordinate.
        prior: whether 0 +- 1 in its own coordinate is known beforehand.
        record: the only record that it moves, or None for all.
    """

    step: float
    prior: bool
    record: str | None

    @abstractmethod
    def get(self, hypothesis: Hypothesis) -> float:
        """Its coordinate in a hypothesis."""

    @abstractmethod
    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """The hypothesis with this coordinate, kept within bounds."""


@dataclass(frozen=True)
class RigUnknown(Unknown):
    """A toleranced number of the rig file, in standard deviations from the given value, kept near its tolerance.

    Counted in logarithms: what only a product of two numbers tells leaves a straight valley, not a curved one.
    """

    parameter: RigParameter
    step: float = 0.05
    prior: bool = True
    record: str | None = None

    def get(self, hypothesis: Hypothesis) -> float:
        """Standard deviations from the rig file."""
        return self.parameter.deviations(hypothesis.values.get(self.parameter.path, self.parameter.value))

    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """Kept within ``LARGEST_SIGMA``."""
        x = min(max(x, -LARGEST_SIGMA), LARGEST_SIGMA)
        value = self.parameter.value * exp(x * self.parameter.tolerance)
        return replace(hypothesis, values={**hypothesis.values, self.parameter.path: value})


@dataclass(frozen=True)
class EffectUnknown(Unknown):
    """One fitted number of the effect with this index, in spreads of its prior (log), or in a unit near its size.

    Attributes:
        trial: around which the prior lies: the value at which a factor changes nothing, or where the fit began.
        unit: of a linear number.
    """

    effect: int
    entry: int
    about: Parameter
    trial: float
    unit: float
    step: float = 0.01
    prior: bool = False
    record: str | None = None

    def get(self, hypothesis: Hypothesis) -> float:
        """Spreads from the trial value, or units from 0."""
        value = float(hypothesis.effects[self.effect].fitted_values()[self.entry])
        if self.about.scale == "linear":
            return value / self.unit
        return log(max(value, SMALLEST) / max(self.trial, SMALLEST)) / self.about.spread

    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """Kept within the parameter's bounds."""
        linear = self.about.scale == "linear"
        value = x * self.unit if linear else max(self.trial, SMALLEST) * exp(min(x * self.about.spread, LARGEST_LOG))
        effect = hypothesis.effects[self.effect]
        values = effect.fitted_values()
        values[self.entry] = min(max(value, self.about.lower), self.about.upper)
        return _with_effect(hypothesis, self.effect, effect.with_fitted(values))


SMALLEST, LARGEST_LOG = 1e-30, 69.0


@dataclass(frozen=True)
class PlaceUnknown(Unknown):
    """Where along the beam the effect with this index sits, in twentieths of the length."""

    effect: int
    length: float
    step: float = 0.02
    prior: bool = False
    record: str | None = None

    @property
    def unit(self) -> float:
        """A twentieth of the length, m."""
        return self.length / 20.0

    def get(self, hypothesis: Hypothesis) -> float:
        """Twentieths of the length from the clamp."""
        return (hypothesis.effects[self.effect].place.position or 0.0) / self.unit

    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """Kept on the beam, off the clamp."""
        position = min(max(x * self.unit, 0.02 * self.length), self.length)
        effect = hypothesis.effects[self.effect]
        moved = replace(effect, place=replace(effect.place, position=position))
        return _with_effect(hypothesis, self.effect, moved)


@dataclass(frozen=True)
class StartUnknown(Unknown):
    """One entry of the modal state at a record's first sample, in units of a typical size."""

    entry: int
    n: int
    scale: float
    record: str
    step: float = 1e-3
    prior: bool = False

    def get(self, hypothesis: Hypothesis) -> float:
        """Entry over its typical size."""
        start = hypothesis.starts.get(self.record)
        return 0.0 if start is None else float(start[self.entry]) / self.scale

    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """Unbounded."""
        old = hypothesis.starts.get(self.record)
        start = np.zeros(self.n) if old is None else old.copy()
        start[self.entry] = x * self.scale
        return replace(hypothesis, starts={**hypothesis.starts, self.record: start})


@dataclass(frozen=True)
class OffsetUnknown(Unknown):
    """What a record's excitation channel reads at rest, in units of a typical size."""

    scale: float
    record: str
    step: float = 1e-3
    prior: bool = False

    def get(self, hypothesis: Hypothesis) -> float:
        """Offset over its typical size."""
        return hypothesis.offsets.get(self.record, 0.0) / self.scale

    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """Unbounded."""
        return replace(hypothesis, offsets={**hypothesis.offsets, self.record: x * self.scale})


@dataclass(frozen=True)
class OwnNumber(Unknown):
    """A number that one record has for itself of the effect with this index, in its own unit.

    Attributes:
        effect: index among the hypothesis's effects; -1 for an effect of the rig file.
        name: of the number.
    """

    effect: int
    name: str
    about: Parameter
    record: str
    step: float = 0.02
    prior: bool = False

    def get(self, hypothesis: Hypothesis) -> float:
        """The number; 0 where nobody has looked for it."""
        return hypothesis.own.get(self.record, {}).get(self.name, 0.0)

    def set(self, hypothesis: Hypothesis, x: float) -> Hypothesis:
        """Unbounded: a phase may go round."""
        return with_own_number(hypothesis, self.record, self.name, x)


def with_own_number(hypothesis: Hypothesis, record: str, name: str, value: float) -> Hypothesis:
    """With another value for a number of a record's own.

    Args:
        hypothesis: to change.
        record: its name.
        name: of the number.
        value: in its own unit.
    """
    return replace(hypothesis, own={**hypothesis.own, record: {**hypothesis.own.get(record, {}), name: value}})


def _with_effect(hypothesis: Hypothesis, index: int, effect: Effect) -> Hypothesis:
    effects = list(hypothesis.effects)
    effects[index] = effect
    return replace(hypothesis, effects=tuple(effects))


def rig_unknowns(rig: Rig) -> tuple[Unknown, ...]:
    """The toleranced numbers of a rig file."""
    return tuple(RigUnknown(parameter) for parameter in rig.parameters())


def but_for_effects(unknowns: Iterable[Unknown]) -> tuple[Unknown, ...]:
    """Those of a fit's unknowns that are no number of an effect."""
    return tuple(unknown for unknown in unknowns if getattr(unknown, "effect", -1) < 0)


def effect_unknowns(hypothesis: Hypothesis, *, places: bool = True) -> tuple[Unknown, ...]:
    """The fitted numbers of the hypothesis's effects, and where along the beam they sit."""
    unknowns: list[Unknown] = []
    for index, effect in enumerate(hypothesis.effects):
        for entry, (value, (_, about)) in enumerate(
            zip(effect.fitted_values(), effect.fitted_parameters(), strict=True)
        ):
            unit = max(abs(float(value)), 1e-3 * about.spread)
            known = about.scale == "log"
            bounded = _on_beam(about, hypothesis.rig)
            trial = float(value) if about.neutral is None or about.neutral in (0.0, inf) else about.neutral
            unknowns.append(EffectUnknown(index, entry, bounded, trial, unit, about.step, prior=known))
        if places and free_place(effect) and isinstance(hypothesis.rig.structure, Beam):
            unknowns.append(PlaceUnknown(index, hypothesis.rig.structure.length))
        unknowns += own_numbers(effect, index, [name for name in hypothesis.own if _has(hypothesis, name, effect)])
    return tuple(unknowns)


def _on_beam(about: Parameter, rig: Rig) -> Parameter:
    """The parameter, a place along the beam bounded by its end."""
    if not (about.on_beam and isinstance(rig.structure, Beam)):
        return about
    return replace(about, upper=min(about.upper, rig.structure.length))


def _has(hypothesis: Hypothesis, record: str, effect: Effect) -> bool:
    """Whether the effect's numbers of a record's own have been looked for."""
    return set(effect.record_parameters) <= set(hypothesis.own[record])


def own_numbers(effect: Effect, index: int, records: Sequence[str]) -> list[Unknown]:
    """The numbers of an effect that each record has for itself.

    Args:
        effect: of the hypothesis, or of the rig file.
        index: among the hypothesis's effects; -1 for an effect of the rig file.
        records: names.
    """
    return [OwnNumber(index, name, about, r) for r in records for name, about in effect.record_parameters.items()]


def own_unknowns(hypothesis: Hypothesis) -> tuple[Unknown, ...]:
    """The fitted numbers and the place of the last effect, and what each record has for itself of it."""
    last = len(hypothesis.effects) - 1
    rows = effect_unknowns(hypothesis)
    return tuple(u for u in rows if isinstance(u, EffectUnknown | PlaceUnknown | OwnNumber) and u.effect == last)


def free_place(effect: Effect) -> bool:
    """It sits at a position that a fit may move, not at a sleeve or on a sensor."""
    return effect.place.position is not None and effect.place.sleeve is None


def numbers_with_place(effect: Effect) -> int:
    """Numbers of an effect that a fit determines, with its place along the beam where that is free.

    Args:
        effect: of a model.
    """
    return effect.n_numbers + free_place(effect)


def coordinates(hypothesis: Hypothesis, unknowns: Sequence[Unknown]) -> FloatArray:
    """(n,) coordinates of the unknowns."""
    return np.array([unknown.get(hypothesis) for unknown in unknowns])


def at_coordinates(hypothesis: Hypothesis, unknowns: Sequence[Unknown], x: FloatArray) -> Hypothesis:
    """The hypothesis with other coordinates."""
    for unknown, value in zip(unknowns, x, strict=True):
        hypothesis = unknown.set(hypothesis, float(value))
    return hypothesis
