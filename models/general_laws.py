"""Laws more general than any kind of effect: curves over speed and displacement, and a force that remembers.

None of them is a cause that an engineer could name, so none enters ``EFFECTS``. One that explains the records clearly
better than the kind that was found says that the law is another. Curves are straight between their knots, as in the
surfaces of S. F. Masri, T. K. Caughey, J. Appl. Mech. 46 (1979) 433, here fitted to what is measured, with all other
numbers of the rig.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import copysign, pi, tanh
from typing import ClassVar, Self

from models.effects.protocol import Scene, StructureKind, parameter
from models.single_law import SingleLaw


@dataclass(frozen=True)
class GeneralLaw(SingleLaw):
    """A point law along the beam, or on an oscillator; the subclass says which."""

    structures: ClassVar[tuple[StructureKind, ...]] = ("beam", "oscillator")

    @classmethod
    def pieces(cls, scene: Scene) -> Iterator[Self]:
        """Small forces of which any law of this kind is nearly a sum.

        Args:
            scene: the motion at the place.
        """
        raise NotImplementedError

    @property
    def n_numbers(self) -> int:
        """How many a fit determines; each value of a curve is one."""
        return len(self.fitted_values())


@dataclass(frozen=True)
class _Curve(GeneralLaw):
    """A law whose force is a curve of values at knots, times a force; the subclass says over what.

    Attributes:
        force: at a value of 1, N.
        values: at the knots.
    """

    shapes: ClassVar[tuple[tuple[float, ...], ...]]

    force: float = parameter("F", "N", fitted=False)
    values: tuple[float, ...] = parameter("f_i", "-", scale="linear", spread=1.0, neutral=0.0, table=True, step=0.03)

    @classmethod
    def with_values(cls, scene: Scene, values: Sequence[float]) -> Self:
        """The curve through values, laid over the motion at a place.

        Args:
            scene: the motion.
            values: at the knots.
        """
        raise NotImplementedError

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Every shape, at 3 and 30 % of the excitation."""
        for share in SHARES:
            for shape in cls.shapes:
                yield cls.with_values(scene, [share * value for value in shape])

    @classmethod
    def pieces(cls, scene: Scene) -> Iterator[Self]:
        """One knot after the other."""
        n = len(cls.shapes[0])
        for knot in range(n):
            yield cls.with_values(scene, [SHARES[0] if i == knot else 0.0 for i in range(n)])


SHARES = (0.03, 0.3)
"""Of the excitation's rms."""


@dataclass(frozen=True)
class _OverSpeed(_Curve):
    """A curve over the speed.

    Attributes:
        speed: rms, m/s.
    """

    speed: float = parameter("v_1", "m/s", fitted=False, default=1.0)

    @classmethod
    def with_values(cls, scene: Scene, values: Sequence[float]) -> Self:
        """Over the rms speed."""
        return cls(scene.place, scene.force, tuple(values), scene.velocity)


@dataclass(frozen=True)
class SpeedCurve(_OverSpeed):
    """A resistance that is any function of the speed, the same both ways."""

    kind: ClassVar[str] = "resistance over speed"
    source: ClassVar[str] = "S. F. Masri, T. K. Caughey, J. Appl. Mech. 46 (1979) 433"
    shapes: ClassVar[tuple[tuple[float, ...], ...]] = (
        (1.0, 1.0, 1.0, 1.0, 1.0),
        (0.03, 0.1, 0.3, 1.0, 3.0),
        (0.2, 0.3, 0.55, 1.0, 1.7),
        (0.5, 1.0, 0.7, 0.3, 0.1),
    )

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (force, values at ``SPEEDS``, speed); constant beyond the last."""
        s, below, before = abs(v) / p[6], 0.0, 0.0
        for i in range(5):
            if s < SPEEDS[i]:
                before += (p[1 + i] - before) * (s - below) / (SPEEDS[i] - below)
                break
            below, before = SPEEDS[i], p[1 + i]
        return -copysign(1.0, v) * p[0] * before

    def in_words(self) -> str:
        """What it does."""
        return "a resistance that changes with the speed in its own way"


SPEEDS = (0.03, 0.1, 0.3, 1.0, 3.0)
"""Knots of a curve over the speed, in rms speeds."""


@dataclass(frozen=True)
class DirectedSpeedCurve(_OverSpeed):
    """A resistance that is any function of the velocity, another either way, as a pawl's or a valve's."""

    kind: ClassVar[str] = "resistance over speed, another either way"
    source: ClassVar[str] = "J. C. Dixon, The Shock Absorber Handbook (2007): bump and rebound differ"
    shapes: ClassVar[tuple[tuple[float, ...], ...]] = (
        (1.0, 1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 0.01),
        (0.01, 0.01, 0.01, 0.01, 1.0, 1.0, 1.0, 1.0),
        (0.03, 0.3, 1.0, 3.0, 0.01, 0.1, 0.3, 1.0),
        (0.01, 0.1, 0.3, 1.0, 0.03, 0.3, 1.0, 3.0),
    )

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (force, values at ``DIRECTED_SPEEDS`` forwards, backwards, speed); constant beyond the last."""
        first = 1 if v > 0.0 else 5
        s, below, before = abs(v) / p[9], 0.0, 0.0
        for i in range(4):
            if s < DIRECTED_SPEEDS[i]:
                before += (p[first + i] - before) * (s - below) / (DIRECTED_SPEEDS[i] - below)
                break
            below, before = DIRECTED_SPEEDS[i], p[first + i]
        return -copysign(1.0, v) * p[0] * before

    def in_words(self) -> str:
        """What it does."""
        return "a resistance that changes with the speed in its own way, and another way back"


DIRECTED_SPEEDS = (0.03, 0.3, 1.0, 3.0)
"""Knots of such a curve, in rms speeds."""


@dataclass(frozen=True)
class _OverDisplacement(_Curve):
    """A curve over the displacement from rest.

    Attributes:
        reach: the largest displacement from rest, m.
        rest: m.
    """

    reach: float = parameter("d", "m", fitted=False, default=1.0)
    rest: float = parameter("q_0", "m", scale="linear", fitted=False, default=0.0)


@dataclass(frozen=True)
class SpringCurve(_OverDisplacement):
    """A spring whose force is any function of the displacement from rest, another on either side."""

    kind: ClassVar[str] = "force over displacement"
    source: ClassVar[str] = "S. F. Masri, T. K. Caughey, J. Appl. Mech. 46 (1979) 433"
    shapes: ClassVar[tuple[tuple[float, ...], ...]] = (
        (0.2, 0.5, 1.0, 0.2, 0.5, 1.0),
        (0.01, 0.12, 1.0, 0.01, 0.12, 1.0),
        (0.5, 0.9, 1.0, 0.5, 0.9, 1.0),
        (0.01, 0.2, 1.0, 0.01, 0.01, 0.01),
        (0.01, 0.01, 0.01, 0.01, 0.2, 1.0),
    )

    @classmethod
    def with_values(cls, scene: Scene, values: Sequence[float]) -> Self:
        """Over the largest displacement from rest."""
        return cls(scene.place, scene.force, tuple(values), scene.displacement, scene.rest)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (force, values above rest at ``REACHES``, below, reach, rest); straight on beyond the last."""
        u = (q - p[8]) / p[7]
        first = 1 if u > 0.0 else 4
        s, below, before, force = abs(u), 0.0, 0.0, 0.0
        for i in range(3):
            slope = (p[first + i] - before) / (REACHES[i] - below)
            force = before + slope * (s - below)
            if s < REACHES[i]:
                break
            below, before = REACHES[i], p[first + i]
        return -copysign(1.0, u) * p[0] * force

    def in_words(self) -> str:
        """What it does."""
        return "a spring with a curve of its own"


REACHES = (0.2, 0.5, 1.0)
"""Knots of a spring's curve on either side, in largest displacements."""


@dataclass(frozen=True)
class DampingCurve(_OverDisplacement):
    """A dashpot whose damping is any function of the displacement."""

    kind: ClassVar[str] = "damping over displacement"
    source: ClassVar[str] = "S. F. Masri, T. K. Caughey, J. Appl. Mech. 46 (1979) 433"
    shapes: ClassVar[tuple[tuple[float, ...], ...]] = (
        (1.0, 1.0, 1.0, 1.0, 1.0),
        (1.0, 0.25, 0.03, 0.25, 1.0),
        (0.1, 0.5, 1.0, 0.5, 0.1),
    )

    speed: float = parameter("v_1", "m/s", fitted=False, default=1.0)

    @classmethod
    def with_values(cls, scene: Scene, values: Sequence[float]) -> Self:
        """Over the largest displacement from rest, the force that of the rms speed."""
        return cls(scene.place, scene.force, tuple(values), scene.displacement, scene.rest, scene.velocity)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (force, values from below to above, reach, rest, speed); constant beyond the ends."""
        s = min(max(2.0 * (q - p[7]) / p[6] + 2.0, 0.0), 4.0)
        i = min(int(s), 3)
        return -(p[0] / p[8]) * v * (p[1 + i] + (p[2 + i] - p[1 + i]) * (s - i))

    def in_words(self) -> str:
        """What it does."""
        return "a damping that changes with the displacement"


@dataclass(frozen=True)
class FrictionCurve(_OverDisplacement):
    """Dry friction whose force is any function of the displacement."""

    kind: ClassVar[str] = "friction over displacement"
    source: ClassVar[str] = "E. J. Berger, Appl. Mech. Rev. 55 (2002) 535, section 2: friction that depends on place"
    shapes: ClassVar[tuple[tuple[float, ...], ...]] = (
        (1.0, 1.0, 1.0, 1.0, 1.0),
        (1.0, 0.5, 0.03, 0.5, 1.0),
        (0.03, 0.1, 1.0, 0.1, 0.03),
        (0.03, 0.03, 0.1, 1.0, 0.1),
        (0.1, 1.0, 0.1, 0.03, 0.03),
    )

    slip_velocity: float = parameter("v_s", "m/s", lower=1e-9, default=1.0)

    @classmethod
    def with_values(cls, scene: Scene, values: Sequence[float]) -> Self:
        """Over the largest displacement from rest, slipping at a tenth of the rms speed."""
        return cls(scene.place, scene.force, tuple(values), scene.displacement, scene.rest, 0.1 * scene.velocity)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (force, values from below to above, reach, rest, slip velocity); constant beyond the ends."""
        s = min(max(2.0 * (q - p[7]) / p[6] + 2.0, 0.0), 4.0)
        i = min(int(s), 3)
        return -p[0] * tanh(v / p[8]) * (p[1 + i] + (p[2 + i] - p[1 + i]) * (s - i))

    def in_words(self) -> str:
        """What it does."""
        return "a friction that changes with the displacement"


@dataclass(frozen=True)
class Memory(GeneralLaw):
    """F = -stiffness z, dz/dt = v - z / relaxation_time: the simplest force that depends on what was before."""

    kind: ClassVar[str] = "force with a memory"
    source: ClassVar[str] = "J. D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 1: a spring that creeps"

    stiffness: float = parameter("k", "N/m", lower=0.0, neutral=0.0)
    relaxation_time: float = parameter("tau", "s", lower=1e-6)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """3 and 30 % of the excitation at the largest displacement, from fast to slow."""
        for share in SHARES:
            for time in _times(scene):
                yield cls(scene.place, share * scene.force / scene.displacement, time)

    @classmethod
    def pieces(cls, scene: Scene) -> Iterator[Self]:
        """Weak ones, from fast to slow."""
        for time in _times(scene):
            yield cls(scene.place, SHARES[0] * scene.force / scene.displacement, time)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Force, N, with p = (stiffness, relaxation_time)."""
        return -p[0] * z

    @staticmethod
    def rate(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """dz/dt, m/s, with p = (stiffness, relaxation_time)."""
        return v - z / p[1]

    def in_words(self) -> str:
        """What it does."""
        return f"a spring whose force fades within {1e3 * self.relaxation_time:.3g} ms, neither spring nor dashpot"


@dataclass(frozen=True)
class Lag(_Curve):
    """A spring, a dashpot and a force with a memory, each of either sign: a linear law without inertia that remembers.

    A spring k that answers later by T is nearly one: the spring, and a memory of -2 k for T / 2 (Pade, order 1).

    Attributes:
        reach: the largest displacement from rest, m.
        rest: m.
        speed: rms, m/s.
        relaxation_time: of the memory, s.
    """

    kind: ClassVar[str] = "linear force that lags"
    source: ClassVar[str] = "W. N. Findley, J. S. Lai, K. Onaran, Creep and Relaxation (1976), section 5.4"
    shapes: ClassVar[tuple[tuple[float, ...], ...]] = ((1.0, 0.0, 1.0), (1.0, 0.0, -2.0), (0.0, 1.0, 1.0))

    reach: float = parameter("d", "m", fitted=False, default=1.0)
    rest: float = parameter("q_0", "m", scale="linear", fitted=False, default=0.0)
    speed: float = parameter("v_1", "m/s", fitted=False, default=1.0)
    relaxation_time: float = parameter("tau", "s", lower=1e-6, default=1.0)

    @classmethod
    def with_values(cls, scene: Scene, values: Sequence[float], relaxation_time: float = 1.0) -> Self:
        """Over the largest displacement from rest and the rms speed, for a time in s."""
        return cls(
            scene.place, scene.force, tuple(values), scene.displacement, scene.rest, scene.velocity, relaxation_time
        )

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Every shape, from fast to slow."""
        for trial in super().trials(scene):
            for time in _times(scene):
                yield cls.with_values(scene, trial.values, time)

    @classmethod
    def pieces(cls, scene: Scene) -> Iterator[Self]:
        """A weak spring, a weak dashpot, and weak memories from fast to slow."""
        spring, dashpot, memory = ([SHARES[0] if i == one else 0.0 for i in range(3)] for one in range(3))
        yield cls.with_values(scene, spring)
        yield cls.with_values(scene, dashpot)
        for time in _times(scene):
            yield cls.with_values(scene, memory, time)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """Force, N, with p = (force, values of spring, dashpot and memory, reach, rest, speed, relaxation_time)."""
        return -p[0] * ((p[1] * (q - p[5]) + p[3] * z) / p[4] + p[2] * v / p[6])

    @staticmethod
    def rate(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """dz/dt, m/s, with the same numbers."""
        return v - z / p[7]

    def in_words(self) -> str:
        """What it does."""
        return f"a linear force that remembers the motion for {1e3 * self.relaxation_time:.3g} ms"


def _times(scene: Scene) -> list[float]:
    """Relaxation times, s: a third of a radian of the third mode's motion to three of the first's."""
    freqs = scene.natural_freqs[:3] or (1.0 / scene.duration,)
    slow, fast = 3.0 / (2.0 * pi * freqs[0]), 1.0 / (3.0 * 2.0 * pi * freqs[-1])
    return [fast * (slow / fast) ** (i / (N_TIMES - 1)) for i in range(N_TIMES)]


N_TIMES = 5
"""Relaxation times that are tried."""

GENERAL_LAWS: dict[str, type[GeneralLaw]] = {
    kind.kind: kind for kind in (SpeedCurve, DirectedSpeedCurve, SpringCurve, DampingCurve, FrictionCurve, Memory, Lag)
}
"""Name -> class."""
