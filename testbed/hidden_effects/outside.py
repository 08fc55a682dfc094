"""Laws outside the library, for cases that a diagnosis has to leave unexplained. None of them enters ``EFFECTS``."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp, pi, sin, tanh
from typing import ClassVar, Self

from models.effects.protocol import Effect, Scene, parameter
from models.general_laws import Memory
from models.single_law import SingleLaw


@dataclass(frozen=True)
class _OutsideLaw(SingleLaw):
    """A law at a position; the subclass says which."""

    def in_words(self) -> str:
        """The formula."""
        return str(type(self).__doc__)


@dataclass(frozen=True)
class OneSidedStop(_OutsideLaw):
    """F = -stiffness max(0, q - wall): a stop on one side, away from the sleeves."""

    kind: ClassVar[str] = "one_sided_stop"
    source: ClassVar[str] = "S. W. Shaw, P. J. Holmes, J. Sound Vib. 90 (1983) 129"

    stiffness: float = parameter("k", "N/m", lower=0.0, neutral=0.0)
    wall: float = parameter("q_w", "m", scale="linear", fitted=False)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Met at 40 % of the largest displacement."""
        yield cls(scene.place, scene.force / scene.displacement, scene.rest + 0.4 * scene.displacement)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (stiffness, wall)."""
        return -p[0] * max(0.0, q - p[1])


@dataclass(frozen=True)
class GrowingDamping(_OutsideLaw):
    """F = -damping ((q - centre) / reach)^2 v: a damping that grows with the displacement."""

    kind: ClassVar[str] = "growing_damping"
    source: ClassVar[str] = "B. van der Pol, Phil. Mag. 2 (1926) 978, without its negative part"

    damping: float = parameter("c", "N s/m", lower=0.0, neutral=0.0)
    reach: float = parameter("d", "m", fitted=False)
    centre: float = parameter("q_0", "m", scale="linear", fitted=False)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """A tenth of the excitation at half the largest displacement."""
        yield cls(scene.place, 0.1 * scene.force / scene.velocity, 0.5 * scene.displacement, scene.rest)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (damping, reach, centre)."""
        share = (q - p[2]) / p[1]
        return -p[0] * share * share * v


@dataclass(frozen=True)
class FrictionSpot(_OutsideLaw):
    """F = -friction_force exp(-((q - spot) / width)^2) tanh(v / slip_velocity): dry friction at one displacement."""

    kind: ClassVar[str] = "friction_spot"
    source: ClassVar[str] = "E. J. Berger, Appl. Mech. Rev. 55 (2002) 535, section 2: friction that depends on place"

    friction_force: float = parameter("F_c", "N", lower=0.0, neutral=0.0)
    spot: float = parameter("q_s", "m", scale="linear", fitted=False)
    width: float = parameter("w", "m", fitted=False)
    slip_velocity: float = parameter("v_s", "m/s", lower=1e-9)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """A third of the largest displacement above rest, a fifth of it wide."""
        above, width = scene.displacement / 3.0, scene.displacement / 5.0
        yield cls(scene.place, 0.3 * scene.force, scene.rest + above, width, 0.1 * scene.velocity)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (friction_force, spot, width, slip_velocity)."""
        away = (q - p[1]) / p[2]
        return -p[0] * exp(-away * away) * tanh(v / p[3])


@dataclass(frozen=True)
class PulsatingSpring(_OutsideLaw):
    """F = -stiffness (q - centre) sin(2 pi frequency t): a stiffness that varies periodically."""

    kind: ClassVar[str] = "pulsating_spring"
    source: ClassVar[str] = "A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (1979), section 5.1"

    stiffness: float = parameter("k", "N/m", lower=0.0, neutral=0.0)
    frequency: float = parameter("f", "Hz")
    centre: float = parameter("q_0", "m", scale="linear", fitted=False)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Some three turns a second: slower than the first mode, many in a record."""
        yield cls(scene.place, 0.1 * scene.force / scene.displacement, 3.0, scene.rest)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (stiffness, frequency, centre)."""
        return -p[0] * (q - p[2]) * sin(2.0 * pi * p[1] * t)


@dataclass(frozen=True)
class FadingFriction(_OutsideLaw):
    """F = -friction_force tanh(v / slip_velocity) exp(-|v| / fading_velocity): friction that is gone at speed."""

    kind: ClassVar[str] = "fading_friction"
    source: ClassVar[str] = "B. Armstrong-Helouvry et al., Automatica 30 (1994) 1083, eq. (2), without its Coulomb part"

    friction_force: float = parameter("F_s", "N", lower=0.0, neutral=0.0)
    slip_velocity: float = parameter("v_s", "m/s", lower=1e-9)
    fading_velocity: float = parameter("v_f", "m/s", lower=1e-9)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Gone at half the rms speed."""
        yield cls(scene.place, 0.3 * scene.force, 0.05 * scene.velocity, 0.5 * scene.velocity)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (friction_force, slip_velocity, fading_velocity)."""
        return -p[0] * tanh(v / p[1]) * exp(-abs(v) / p[2])


@dataclass(frozen=True)
class RelaxingSpring(_OutsideLaw):
    """F = -stiffness z, dz/dt = v - z / relaxation_time: Maxwell's spring and dashpot in series."""

    kind: ClassVar[str] = "relaxing_spring"
    source: ClassVar[str] = "R. S. Lakes, Viscoelastic Materials (2009), section 2.6"

    stiffness: float = parameter("k", "N/m", lower=0.0, neutral=0.0)
    relaxation_time: float = parameter("tau", "s", lower=1e-6)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Relaxed in the time in which the place moves as far as it goes."""
        yield cls(scene.place, 0.3 * scene.force / scene.displacement, scene.displacement / scene.velocity)

    law = staticmethod(Memory.law)
    rate = staticmethod(Memory.rate)


@dataclass(frozen=True)
class OneWayFriction(_OutsideLaw):
    """F = -friction_force max(0, tanh(v / slip_velocity)): dry friction in one direction, as a pawl's."""

    kind: ClassVar[str] = "one_way_friction"
    source: ClassVar[str] = "K. Popp, P. Stelter, Phil. Trans. R. Soc. A 332 (1990) 89, of one sign of the velocity"

    friction_force: float = parameter("F_c", "N", lower=0.0, neutral=0.0)
    slip_velocity: float = parameter("v_s", "m/s", lower=1e-9)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Slipping at a tenth of the rms speed."""
        yield cls(scene.place, 0.3 * scene.force, 0.1 * scene.velocity)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (friction_force, slip_velocity)."""
        return -p[0] * max(0.0, tanh(v / p[1]))


@dataclass(frozen=True)
class BrokenSpring(_OutsideLaw):
    """F = -stiffness (q - centre) before break_time, none after it: a spring that gives way in each test."""

    kind: ClassVar[str] = "broken_spring"
    source: ClassVar[str] = "F. Gustafsson, Adaptive Filtering and Change Detection (2000), chapter 1: an abrupt change"

    stiffness: float = parameter("k", "N/m", lower=0.0, neutral=0.0)
    centre: float = parameter("q_0", "m", scale="linear", fitted=False)
    break_time: float = parameter("t_b", "s", fitted=False)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """Gone after a fifth of the longest record."""
        yield cls(scene.place, 0.3 * scene.force / scene.displacement, scene.rest, 0.2 * scene.duration)

    @staticmethod
    def law(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """N, with p = (stiffness, centre, break_time)."""
        return -p[0] * (q - p[1]) if t < p[2] else 0.0


@dataclass(frozen=True)
class CreepingSpring(RelaxingSpring):
    """F = -stiffness z, dz/dt = v - z |z| / (reach relaxation_time): a spring that creeps, and the faster the more."""

    kind: ClassVar[str] = "creeping_spring"
    source: ClassVar[str] = "F. H. Norton, The Creep of Steel at High Temperatures (1929): a power of the stress"

    reach: float = parameter("d", "m", fitted=False)

    @classmethod
    def trials(cls, scene: Scene) -> Iterator[Self]:
        """As fast as a linear one, at half the largest displacement."""
        time = scene.displacement / scene.velocity
        yield cls(scene.place, 0.3 * scene.force / scene.displacement, time, 0.5 * scene.displacement)

    @staticmethod
    def rate(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG004
        """m/s, with p = (stiffness, relaxation_time, reach)."""
        return v - z * abs(z) / (p[1] * p[2])


OUTSIDE_LAWS: tuple[type[Effect], ...] = (
    OneSidedStop,
    GrowingDamping,
    FrictionSpot,
    PulsatingSpring,
    FadingFriction,
    RelaxingSpring,
    OneWayFriction,
    BrokenSpring,
    CreepingSpring,
)
"""In the order in which the cases take turns. Of the first six, which all batches up to seed 43201 have, the diagnosis
holds five within the laws that it tries beyond the library (``models.general_laws``), since that seed; of the last
three, which were added with that, none up to seed 49711, and since then the first."""

HELD_BY_NONE: tuple[type[Effect], ...] = (PulsatingSpring, BrokenSpring, CreepingSpring)
"""Those that none of the laws more general than the library's holds within it: with a clock, or with a state that is
neither a friction's nor a linear memory's."""
