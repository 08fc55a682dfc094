"""All forces behind one port of a cable, as one Python function of the motion there."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from models.point_forces import PointForce, about_centre, closed_part
from models.ports import Port

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
        felt: N, each force as last asked for, always in this list.
    """

    forces: Sequence[PointForce]
    step: float
    felt: list[float] = field(default_factory=list)
    _now: tuple[float, float, float] = (0.0, 0.0, 0.0)
    _time: float = 0.0
    _rates: list[float] = field(default_factory=list)
    _states: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._asked = [self._asked_of(number, force) for number, force in enumerate(self.forces)]
        self.felt[:] = [0.0] * len(self.forces)
        self.begin()

    def _asked_of(self, number: int, force: PointForce) -> Callable[[float, float, float], float]:
        """One force as a function of time, place and speed; Exudyn asks a hundred thousand times a second."""
        if force.contact is not None:
            return _contact(force, self.step)
        law, values = force.law, force.values
        if force.rate is None:
            return lambda t, q, v: law(t, q, v, 0.0, values)
        return lambda t, q, v: law(t, q, v, self._state(number, t, q, v), values)

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
        self.felt[:] = [asked(t, q, v) for asked in self._asked]
        return sum(self.felt)

    def asked(self) -> Callable[[float, float, float], float]:
        """What Exudyn calls: this law, or a shorter way to the same force where one without a state acts alone."""
        if len(self.forces) != 1 or self.has_states:
            return self
        (only,), felt = self._asked, self.felt

        def alone(t: float, q: float, v: float) -> float:
            felt[0] = force = only(t, q, v)
            return force

        return alone

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


class RoundLaw:
    """A contact that is round in space: a law of the radius, whose force points to the centre.

    Args:
        force: the contact as it acts in the plane, with its partner across it.
        step: s.

    Attributes:
        ports: in the plane and across it.
        felt: N, the forces at these ports as last asked for, always in this list.
    """

    def __init__(self, force: PointForce, step: float) -> None:
        assert force.contact is not None
        assert isinstance(force.port, Port)
        assert force.partner is not None
        self.ports = (force.port, force.partner)
        self.felt, self._offset, self._bilateral = [0.0, 0.0], force.contact[1], force.bilateral
        self._radial = _contact(force, step)

    def __call__(self, t: float, place: tuple[float, float], speed: tuple[float, float]) -> tuple[float, float]:
        """Forces on the structure in the rig's plane and across it, N.

        Args:
            t: s.
            place: in the plane and across it, m.
            speed: likewise, m/s.
        """
        r, up, aside = about_centre(place[0] - self._offset, place[1], *speed)
        at, around = self._offset + r, 0.0
        force = self._radial(t, at, speed[0] * up + speed[1] * aside)
        if self._bilateral:  # without a gap it is a bushing, whose dashpot acts around too
            around = self._radial(t, at, speed[1] * up - speed[0] * aside) - self._radial(t, at, 0.0)
        self.felt[:] = found = force * up - around * aside, force * aside + around * up
        return found


def _contact(force: PointForce, step: float) -> Callable[[float, float, float], float]:
    """Mean force of a contact on the structure, N, over a step about now: it grows steadily as the contact closes.

    A dashpot jumps as it begins to push, and a step that ends within the jump would have no solution.
    """
    assert force.contact is not None
    (clearance, offset, growth), law, values, half = force.contact, force.law, force.values, 0.5 * step

    def both_ways(t: float, q: float, v: float) -> float:
        side = 1.0 if q >= offset else -1.0
        grows = growth if t > 0.0 else 0.0  # the record starts from where the beam rested before
        return -side * law(t, side * (q - offset) - clearance - growth * t, side * v - grows, 0.0, values)

    def pushing(t: float, q: float, v: float) -> float:
        side = 1.0 if q >= offset else -1.0
        rate, p = side * v - (growth if t > 0.0 else 0.0), side * (q - offset) - clearance - growth * t
        if p <= -half * abs(rate):
            return 0.0
        share, amid = closed_part(p, rate, step)
        return -side * share * max(0.0, law(t, amid, rate, 0.0, values))

    return both_ways if force.bilateral else pushing
