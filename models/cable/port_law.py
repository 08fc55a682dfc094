"""All forces behind one port of a cable, as one Python function of the motion there."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from models.point_forces import PointForce, closed_part

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
        step: s.
        felt: N, each force as last asked for.
    """

    forces: Sequence[PointForce]
    step: float
    felt: list[float] = field(default_factory=list)
    _now: tuple[float, float, float] = (0.0, 0.0, 0.0)
    _time: float = 0.0
    _rates: list[float] = field(default_factory=list)
    _states: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """Forget what was; states are 0 at rest."""
        self._time, self._rates, self._states = 0.0, [0.0] * len(self.forces), [0.0] * len(self.forces)

    @property
    def has_states(self) -> bool:
        """Whether some force here has an internal state."""
        return any(force.rate is not None for force in self.forces)

    def __call__(self, t: float, q: float, v: float) -> float:
        """Force on the structure, N, at the end of the present step."""
        self._now = (t, q, v)
        self.felt = [
            _contact(force, t, self.step, q, v)
            if force.contact is not None
            else force.law(t, q, v, 0.0 if force.rate is None else self._state(number, t, q, v), force.values)
            for number, force in enumerate(self.forces)
        ]
        return sum(self.felt)

    def settle(self) -> None:
        """End the present step where the forces were last asked for."""
        t, q, v = self._now
        for number, force in enumerate(self.forces):
            if force.rate is not None:
                state = self._state(number, t, q, v)
                self._states[number], self._rates[number] = state, force.rate(t, q, v, state, force.values)
        self._time = t

    def _state(self, number: int, t: float, q: float, v: float) -> float:
        """An internal state at the end of the present step, by Newton's iteration."""
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


def _contact(force: PointForce, t: float, h: float, q: float, v: float) -> float:
    """Mean force of a contact on the structure, N, over a step h about t: it grows steadily as the contact closes.

    A dashpot jumps as it begins to push, and a step that ends within the jump would have no solution.
    """
    assert force.contact is not None
    clearance, offset, growth = force.contact
    side = 1.0 if q >= offset else -1.0
    p, rate = side * (q - offset) - clearance - growth * t, side * v - growth
    if force.bilateral:
        return -side * force.law(t, p, rate, 0.0, force.values)
    share, amid = closed_part(p, rate, h)
    return -side * share * max(0.0, force.law(t, amid, rate, 0.0, force.values)) if share else 0.0
