"""One cause in all sleeves of a rig at once, each with numbers of its own: sleeves are greased, worn and made alike.

What sits in every sleeve is not found sleeve by sleeve: grease in one of two explains so little of what both do that a
dashpot between them looks better. So the same kind is tried in all of them together, and what is found falls apart into
its members, each of which then has to stand on its own.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.evidence import Ranked
from identification.fit import Fit
from identification.hypothesis import EffectUnknown, OwnNumber, PlaceUnknown, Unknown
from models.arrays import FloatArray
from models.effects import Effect, Registry
from models.effects.protocol import Parameter, Place, Scene
from models.rig import Rig


@dataclass(frozen=True)
class InAllSleeves(Effect):
    """Members of one kind, one a sleeve; the place is the first one's."""

    member: ClassVar[type[Effect]]
    sleeves: ClassVar[tuple[Place, ...]]

    members: tuple[Effect, ...] = ()

    @classmethod
    def part_kind(cls) -> str:
        """Kind of the members."""
        return cls.member.kind

    @classmethod
    def sits_at(cls, place: Place) -> tuple[Place, ...]:  # noqa: ARG003
        """All sleeves."""
        return cls.sleeves

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """The member's own trial values for the motion in one sleeve, the same in all."""
        for trial in cls.member.trials(scene):
            yield cls(cls.sleeves[0], members=tuple(replace(trial, place=place) for place in cls.sleeves))

    @property
    def valley(self) -> str:
        """That of the members."""
        return self.members[0].valley

    def is_variant_of(self, other: Effect) -> bool:
        """Whether the members differ by an option or a valley."""
        assert isinstance(other, InAllSleeves)
        return self.members[0].is_variant_of(other.members[0])

    def parts(self) -> tuple[Effect, ...]:
        """The members."""
        return self.members

    def scaled(self, factor: float) -> Self:
        """Every member ``factor`` times as large."""
        return replace(self, members=tuple(member.scaled(factor) for member in self.members))

    def refined(self) -> Iterator[Self]:
        """Every member in more detail."""
        for finer in zip(*(member.refined() for member in self.members), strict=True):
            yield replace(self, members=finer)

    def in_words(self) -> str:
        """The members one by one."""
        return "; ".join(f"in {member.place.sleeve} {member.in_words()}" for member in self.members)

    def label(self) -> str:
        """Kind and place."""
        return f"{self.member.kind} in all sleeves"

    @property
    def n_numbers(self) -> int:
        """Those of the members."""
        return sum(member.n_numbers for member in self.members)

    def fitted_values(self) -> FloatArray:
        """(n,) the members' fitted parameters one after the other."""
        return np.concatenate([member.fitted_values() for member in self.members])

    def fitted_parameters(self) -> tuple[tuple[str, Parameter], ...]:
        """(name, parameter) for each entry of ``fitted_values``."""
        return tuple(row for member in self.members for row in member.fitted_parameters())

    def with_fitted(self, values: FloatArray) -> Self:
        """The same with other values, in the order of ``fitted_values``."""
        ends = np.cumsum([len(member.fitted_values()) for member in self.members])[:-1]
        pairs = zip(self.members, np.split(values, ends), strict=True)
        return replace(self, members=tuple(member.with_fitted(part) for member, part in pairs))


def in_all_sleeves(registry: Registry, rig: Rig) -> Registry:
    """The kinds that can sit in a sleeve, each in all sleeves of a rig; none where it has one sleeve.

    Args:
        registry: of kinds.
        rig: with its sleeves.
    """
    if len(rig.sleeves) < 2:
        return {}
    places = tuple(Place(sleeve=sleeve.name, position=sleeve.position) for sleeve in rig.sleeves)
    return {
        f"{name} in all sleeves": type(
            f"{kind.__name__}InAllSleeves",
            (InAllSleeves,),
            {
                "kind": f"{name} in all sleeves",
                "family": kind.family,
                "places": ("sleeve",),
                "source": kind.source,
                "signature": kind.signature,
                "member": kind,
                "sleeves": places,
                "__doc__": InAllSleeves.__doc__,
            },
        )
        for name, kind in registry.items()
        if "sleeve" in kind.places
    }


def fallen_apart(found: Fit, rounds: Sequence[list[Ranked]]) -> tuple[Fit, list[list[Ranked]]]:
    """A fit with the members in place of what is in all sleeves, and for each effect the round that added it.

    Args:
        found: the fit.
        rounds: one an effect.
    """
    whole = found.hypothesis.effects
    if all(len(effect.parts()) == 1 for effect in whole):
        return found, list(rounds)
    parts = tuple(part for effect in whole for part in effect.parts())
    begun = [ranked for effect, ranked in zip(whole, rounds, strict=False) for _ in effect.parts()]
    unknowns = tuple(_of_part(unknown, whole) for unknown in found.unknowns)
    return (
        replace(found, hypothesis=replace(found.hypothesis, effects=parts), unknowns=unknowns),
        [*begun, *rounds[len(whole) :]],
    )


def _of_part(unknown: Unknown, whole: Sequence[Effect]) -> Unknown:
    """The same number, counted from the parts."""
    if not isinstance(unknown, EffectUnknown | PlaceUnknown | OwnNumber) or unknown.effect < 0:
        return unknown
    part = sum(len(effect.parts()) for effect in whole[: unknown.effect])
    if not isinstance(unknown, EffectUnknown):
        return replace(unknown, effect=part)
    entry = unknown.entry
    for member in whole[unknown.effect].parts():
        if entry < len(member.fitted_values()):
            break
        part, entry = part + 1, entry - len(member.fitted_values())
    return replace(unknown, effect=part, entry=entry)
