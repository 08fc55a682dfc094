"""Which cases there are, in which order: each beginning of the order has the whole mix."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count, islice
from typing import Any

from models.effects import EFFECTS, Effect
from models.errors import InputError
from models.rig_checks import nearest
from testbed.hidden_effects.outside import OUTSIDE_LAWS
from testbed.hidden_effects.sets import SETS, Batch

NOTHING, TWO, OUTSIDE = "nothing", "two", "outside"
"""Classes besides the kinds of the library: no effect, two of them, a law that the library does not hold."""

ONE = "one"

PATTERN = (
    NOTHING, ONE, ONE, TWO, ONE, NOTHING, ONE, ONE, OUTSIDE, ONE,
    NOTHING, ONE, ONE, NOTHING, TWO, ONE, ONE, NOTHING, ONE, OUTSIDE,
)  # fmt: skip
"""A quarter with nothing hidden, 55 % with one effect, a tenth each with two and with one outside the library."""

PATTERN_MORE_OUTSIDE = (
    OUTSIDE, ONE, NOTHING, ONE, OUTSIDE, ONE, NOTHING, TWO, ONE, OUTSIDE,
    NOTHING, ONE, ONE, OUTSIDE, NOTHING, ONE, TWO, OUTSIDE, ONE, NOTHING,
)  # fmt: skip
"""A quarter with one outside the library and 40 % with one effect: of those outside there were too few for a share."""


KINDS: Mapping[str, type[Effect]] = {
    kind: cls
    for kind, cls in EFFECTS.items()
    if "beam" in cls.structures and any(about.fitted for about in cls.parameters().values())
}
"""Of the library, that a beam can have, with a size by which a case is drawn: sensors are exchanged or they are not."""


@dataclass(frozen=True)
class Task:
    """One case by name.

    Attributes:
        case_set: key of ``SETS``.
        seed: of its batch.
        kind: of the registry, or ``NOTHING``, ``TWO`` or ``OUTSIDE``.
        number: from 0, within the kind.
    """

    case_set: str
    seed: int
    kind: str
    number: int

    @classmethod
    def of(cls, case: Mapping[str, Any]) -> "Task":
        """The task of a case.

        Args:
            case: as its file holds it.
        """
        return cls(case["set"], case["seed"], case["kind"], case["number"])

    @property
    def about(self) -> dict[str, Any]:
        """What its file says of which case it is."""
        return {"case": self.name, "set": self.case_set, "seed": self.seed, "kind": self.kind, "number": self.number}

    @property
    def name(self) -> str:
        """Of the case and its file."""
        return f"{self.case_set}-{self.seed}-{self.kind}-{self.number}"


def planned(case_set: str, cases: int, only: Sequence[str] = ()) -> tuple[Task, ...]:
    """The first cases of the set, batch after batch, in each the library's kinds in turn.

    Args:
        case_set: key of ``SETS``.
        cases: how many.
        only: classes or kinds to which each batch is thinned; all where it is empty.

    Raises:
        InputError: a kind that is none.
    """
    known = (NOTHING, TWO, OUTSIDE, *KINDS)
    for kind in only:
        if kind not in known:
            near = nearest(kind, known)
            mend = f"did you mean {near}?" if near else "name one of them"
            raise InputError(f"--only {kind}", f"the classes and kinds are {', '.join(known)}", mend)
    order = (
        Task(case_set, seed, kind, number)
        for seed, batch in SETS[case_set].batches.items()
        for kind, number in islice(_begun(batch), batch.cases)
        if not only or kind in only
    )
    return tuple(islice(order, cases))


def _begun(batch: Batch) -> Iterator[tuple[str, int]]:
    """Kinds and numbers without those that never ended."""
    return (each for each in _order(batch) if each not in batch.left_out)


def _order(batch: Batch) -> Iterator[tuple[str, int]]:
    kinds, laws = tuple(KINDS), [law.kind for law in OUTSIDE_LAWS[: batch.n_laws]]
    first = kinds.index(batch.first_kind) if batch.first_kind else 0
    kinds = (*kinds[first:], *kinds[:first])
    drawn = dict.fromkeys((NOTHING, ONE, TWO, OUTSIDE), 0)
    if batch.first_law:
        drawn[OUTSIDE] = laws.index(batch.first_law)
    pattern = PATTERN_MORE_OUTSIDE if batch.more_outside else PATTERN
    for place in count():
        group = pattern[place % len(pattern)]
        number = drawn[group]
        drawn[group] += 1
        yield (kinds[number % len(kinds)], number // len(kinds)) if group == ONE else (group, number)
