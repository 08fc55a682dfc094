"""A contact whose damping changes during the record: grease that moves, warms or leaves."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from models.contact.hertz import Hertz
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.time_varying import TimeVarying
from models.effects.protocol import Effect, Family, PlaceKind, Scene, Signature, parameter
from models.errors import InputError
from models.ports import Contact

MOST_ENTRIES = 33
"""Of a table that is refined: more would tell a vibration, and no grease."""


@dataclass(frozen=True)
class TimeVaryingDamping(Effect):
    """The contact's damping is c(t), straight between the values and constant outside; its spring stays.

    Raises:
        InputError: times that do not grow, or not one value for each.
    """

    kind: ClassVar[str] = "time_varying_damping"
    family: ClassVar[Family] = "time"
    places: ClassVar[tuple[PlaceKind, ...]] = ("sleeve",)
    source: ClassVar[str] = "Actuators 14 (2025) 58, section 2: damping of a greased clearance as a function of time"
    signature: ClassVar[Signature] = Signature(
        frequency="resonances that the sleeve holds are wider or sharper, and not alike early and late",
        level="only in contact: at every level where the beam rests on the sleeve, else once the gap is closed",
        time="changes through the record: the same excitation is answered differently",
        place="modes that move at the sleeve",
    )

    times: tuple[float, ...] = parameter("t_i", "s", lower=0.0, scale="linear", fitted=False, table=True)
    values: tuple[float, ...] = parameter("c_i", "N s/m", lower=0.0, spread=1.0, table=True)

    def __post_init__(self) -> None:
        if not self.times or len(self.times) != len(self.values):
            raise InputError(
                f"{self.label()}: {len(self.times)} times and {len(self.values)} values",
                "a table has one value for each of its times, and at least one",
                "give both lists the same length",
            )
        if any(later <= earlier for earlier, later in zip(self.times, self.times[1:], strict=False)):
            raise InputError(
                f"{self.label()}: times = {list(self.times)}",
                "the times of a table grow",
                "sort the times, each with its value",
            )

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Rising, falling, hump and dip over the longest record, from 0.3 to 3 times the present damping."""
        assert scene.contact is not None
        law = scene.contact.law
        present = law.damping_at(scene.penetration, scene.velocity) or scene.force / scene.velocity
        for shape in ((0.3, 3.0), (3.0, 0.3), (0.5, 3.0, 0.5), (2.0, 0.3, 2.0), (0.3, 1.0, 3.0, 1.0, 0.3)):
            spacing = scene.duration / (len(shape) - 1)
            yield cls(
                scene.place,
                times=tuple(i * spacing for i in range(len(shape))),
                values=tuple(ratio * present for ratio in shape),
            )

    def refined(self) -> Iterator[Self]:
        """The table with one more entry between each two, and with three: what is odd about a middle shows then."""
        for parts in (2, 4):
            n = parts * (len(self.times) - 1) + 1
            if n > MOST_ENTRIES:
                return
            knots = np.linspace(self.times[0], self.times[-1], n)
            values = np.interp(knots, self.times, self.values)
            yield replace(self, times=tuple(knots.tolist()), values=tuple(values.tolist()))

    def change_contact(self, contact: Contact) -> Contact:
        """The contact with the table as its dashpot."""
        law = contact.law
        return replace(contact, law=TimeVarying(law.stiffness, self.times, self.values, law.power))

    def as_sleeve_numbers(self, contact: Contact) -> Mapping[str, float]:
        """The mean of the table as a damping that stays, where the sleeve's law has a dashpot."""
        return {"damping": float(np.mean(self.values))} if isinstance(contact.law, KelvinVoigt | Hertz) else {}

    def in_words(self) -> str:
        """When it acts and what it does."""
        table = ", ".join(f"{c:.3g} at {t:.3g} s" for t, c in zip(self.times, self.values, strict=True))
        return f"only in contact, and not always alike: the damping is {table} (N s/m)"
