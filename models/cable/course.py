"""What drives a cable, as functions of time that Exudyn may ask for at any moment."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from models.arrays import FloatArray


def _none() -> FloatArray:
    return np.zeros(0)


@dataclass(eq=False)
class Course:
    """The drive, straight between whole steps; while the state at rest is sought, only what holds the cable acts.

    Attributes:
        step: s.
        force: (M,) N at every step; empty for none.
        base: (3, M) displacement, velocity and acceleration of the base; (3, 0) where it stands still.
        angle: of the force from the rig's plane, rad.
        held: N where the cable is held until the motion begins.
        settling: whether the state at rest is sought.
    """

    step: float = 1.0
    force: FloatArray = field(default_factory=_none)
    base: FloatArray = field(default_factory=lambda: np.zeros((3, 0)))
    angle: float = 0.0
    held: float = 0.0
    settling: bool = True

    def __post_init__(self) -> None:
        self._base = [self._between(row) for row in self.base]

    @property
    def base_moves(self) -> bool:
        """Whether it does."""
        return bool(self.base.shape[1])

    def force_as_load(self, share: float) -> Callable[[object, float, float], float]:
        """A share of the force as Exudyn asks for it, three times a step."""
        at = self._between(share * self.force)
        return lambda mbs, t, value: at(t)  # noqa: ARG005

    def base_at(self, t: float, order: int) -> float:
        """Displacement, velocity or acceleration of the base (order 0, 1, 2) at a time, s."""
        return self._base[order](t)

    def _between(self, row: FloatArray) -> Callable[[float], float]:
        """What a row of values at every step is at a time, s; Exudyn asks for it a hundred thousand times a second."""
        values: list[float] = row.tolist()
        rate, last = 1.0 / self.step, len(values) - 2

        def at(t: float) -> float:
            if self.settling or not values:
                return 0.0
            place = t * rate
            k = min(int(place), last)
            return values[k] + (place - k) * (values[k + 1] - values[k])

        return at
