"""How far simulators are apart on the same cases of a study."""

from collections.abc import Callable, Iterable, Sequence
from typing import Protocol, TypeVar


class Case(Protocol):
    """A row of a study: one law and restitution in one simulator."""

    @property
    def law(self) -> str:
        """Key of ``STUDY_LAWS``."""

    @property
    def set(self) -> float:
        """Restitution that the law's numbers were chosen for."""

    @property
    def simulator(self) -> str:
        """Which."""


Row = TypeVar("Row", bound=Case)


def largest_by_law(
    rows: Sequence[Row], level: Callable[[Row], float], shares: Callable[[Row, Row], Iterable[float]]
) -> dict[str, float]:
    """The largest difference from the modal model by law.

    Args:
        rows: of all simulators.
        level: what tells cases of one law and restitution apart, such as a speed.
        shares: differences of a row from the modal model's, each as a share.
    """
    known = {(row.law, row.set, level(row)): row for row in rows if row.simulator == "modal"}
    worst: dict[str, float] = {}
    for row in rows:
        differences = shares(row, known[row.law, row.set, level(row)])
        worst[row.law] = max(worst.get(row.law, 0.0), *differences)
    return worst
