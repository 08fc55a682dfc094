"""All forces behind one port of a cable, as one Python function of the motion there."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from models.point_forces import PointForce

ITERATIONS = 12
NUDGE = 1e-6
SETTLED = 1e-13


@dataclass(eq=False)
class PortLaw:
    """The forces at one port, with the internal states that some of them have.

    A state follows its rate by the trapezoidal rule from the last whole step, so that within a step the force is a pure
    function of the motion at its end, as Newton's iteration wants it.

    Attributes:
        forces: what acts here.
    """

    forces: Sequence[PointForce]
    _time: float = 0.0
    _rates: list[float] = field(default_factory=list)
    _states: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._rates, self._states = [0.0] * len(self.forces), [0.0] * len(self.forces)

    @property
    def has_states(self) -> bool:
        """Whether some force here has an internal state."""
        return any(force.rate is not None for force in self.forces)

    def __call__(self, t: float, q: float, v: float) -> float:
        """Force on the structure, N, at the end of the present step."""
        return sum(self.each(t, q, v))

    def each(self, t: float, q: float, v: float) -> list[float]:
        """Force of each law, N."""
        return [
            _contact(force, t, q, v)
            if force.contact is not None
            else force.law(t, q, v, 0.0 if force.rate is None else self._state(number, t, q, v), force.values)
            for number, force in enumerate(self.forces)
        ]

    def settle(self, t: float, q: float, v: float) -> None:
        """End the present step here."""
        for number, force in enumerate(self.forces):
            if force.rate is not None:
                state = self._state(number, t, q, v)
                self._states[number], self._rates[number] = state, force.rate(t, q, v, state, force.values)
        self._time = t

    def _state(self, number: int, t: float, q: float, v: float) -> float:
        force, half = self.forces[number], 0.5 * (t - self._time)
        assert force.rate is not None
        state, known = self._states[number], self._states[number] + half * self._rates[number]
        for _ in range(ITERATIONS):
            rate = force.rate(t, q, v, state, force.values)
            slope = (force.rate(t, q, v, state + NUDGE, force.values) - rate) / NUDGE
            step = (known + half * rate - state) / (1.0 - half * min(0.0, slope))
            state += step
            if abs(step) < SETTLED:
                break
        return state


def _contact(force: PointForce, t: float, q: float, v: float) -> float:
    assert force.contact is not None
    clearance, offset, growth = force.contact
    side = 1.0 if q >= offset else -1.0
    penetration, rate = side * (q - offset) - clearance - growth * t, side * v - growth
    if force.bilateral:
        return -side * force.law(t, penetration, rate, 0.0, force.values)
    if penetration <= 0.0:
        return 0.0
    return -side * max(0.0, force.law(t, penetration, rate, 0.0, force.values))
