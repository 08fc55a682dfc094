"""The laws of the study: each set for a restitution, and what its closed form says will come of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, pi, sqrt

from models.ball.restitution import RULES, Rule, damping_ratio, obtained, restitution_of
from models.contact.dissipating import Dissipating
from models.contact.hertz import Hertz
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.protocol import ContactLaw
from models.effects.squeeze_film import WALL, SqueezeFilm
from models.ports import PointLaw, Port


@dataclass(frozen=True)
class Meeting:
    """What meets at a stop.

    Attributes:
        mass: kg, that is stopped.
        stiffness: k of the stop, N/m^n.
        exponent: n.
        room: m, from amid the gap to the stop.
        speed: m/s, for which a restitution is set.
        position: of the stop along a beam, m from the clamp; None for a ball.
    """

    mass: float
    stiffness: float
    exponent: float
    room: float
    speed: float
    position: float | None = None


@dataclass(frozen=True)
class Stop:
    """A law with its numbers, and the grease in the gap where there is some."""

    law: ContactLaw
    films: tuple[PointLaw, ...] = ()


@dataclass(frozen=True)
class StudyLaw:
    """A way to lose energy at a stop, or not to.

    Attributes:
        name: as the tables have it.
        source: where it was published.
        valid: for what it is meant.
        stop: the stop whose numbers are to give a restitution at the meeting's speed.
        expected: restitution of that stop in closed form, struck at another speed, m/s.
        linear: whether it is one of a spring, whatever the meeting's exponent.
        lossless: whether it cannot be set to lose anything.
    """

    name: str
    source: str
    valid: str
    stop: Callable[[float, Meeting], Stop]
    expected: Callable[[float, Meeting, float], float]
    linear: bool = False
    lossless: bool = False


def _by_rule(rule: Rule) -> StudyLaw:
    """N = k p^n (1 + a dp/dt) with an author's a."""

    def stop(restitution: float, meeting: Meeting) -> Stop:
        dissipation = rule.dissipation(restitution) / meeting.speed
        return Stop(Dissipating(meeting.stiffness, dissipation, meeting.exponent))

    def expected(restitution: float, meeting: Meeting, speed: float) -> float:
        return obtained(rule.dissipation(restitution) * speed / meeting.speed)

    return StudyLaw(rule.author, rule.source, rule.valid, stop, expected)


def _spring_and_dashpot(restitution: float, meeting: Meeting) -> Stop:
    damping = 2.0 * damping_ratio(restitution) * sqrt(meeting.stiffness * meeting.mass)
    return Stop(KelvinVoigt(meeting.stiffness, damping))


def _film_damping(restitution: float, meeting: Meeting) -> float:
    """C, N s/m, of the grease that takes the set share of the speed on the way to the stop and back.

    In the gap the film takes the speed (c room / m) dr / (1 - r^2)^(3/2) over each dr, whatever the speed.
    """
    return (1.0 - restitution) * meeting.mass * meeting.speed / (2.0 * (IN_GAP + AT_WALL) * meeting.room)


THICKEST: float = (1.0 - WALL**2) ** -1.5
"""Times the damping amid the gap, beyond ``WALL`` of the room."""

IN_GAP, AT_WALL = WALL / sqrt(1.0 - WALL**2), (1.0 - WALL) * THICKEST
"""Integrals of the film's damping over the room up to there, and from there on."""


def _greased(restitution: float, meeting: Meeting) -> Stop:
    film = _film_damping(restitution, meeting)
    port = Port(meeting.position)
    grease = PointLaw(port, SqueezeFilm.force, (film, meeting.room, 0.0), owner="squeeze_film")
    return Stop(KelvinVoigt(meeting.stiffness, 0.0), (grease,))


def _expected_of_film(restitution: float, meeting: Meeting, speed: float) -> float:
    """Through the film, against spring and film until the spring lets go, and back through the film."""
    film = _film_damping(restitution, meeting)
    taken = film * meeting.room * (IN_GAP + AT_WALL) / meeting.mass
    zeta = THICKEST * film / (2.0 * sqrt(meeting.stiffness * meeting.mass))
    rebound = exp(-zeta * pi / sqrt(1.0 - zeta**2)) if zeta < 1.0 else 0.0
    return max(0.0, (speed - taken) * rebound - taken) / speed


STUDY_LAWS: Mapping[str, StudyLaw] = {
    "kelvin_voigt": StudyLaw(
        "Kelvin and Voigt",
        "Granular Matter 9 (2007) 465",
        "slow parts and wet contacts; the force jumps where contact begins",
        _spring_and_dashpot,
        lambda e, meeting, speed: restitution_of(damping_ratio(e)),  # noqa: ARG005
        linear=True,
    ),
    "hertz": StudyLaw(
        "Hertz",
        "Johnson, Contact Mechanics (1985), section 4.2",
        "smooth elastic bodies, no loss",
        lambda e, meeting: Stop(Hertz(meeting.stiffness, 0.0, meeting.exponent)),  # noqa: ARG005
        lambda e, meeting, speed: 1.0,  # noqa: ARG005
        lossless=True,
    ),
    **{name: _by_rule(rule) for name, rule in RULES.items()},
    "squeeze_film": StudyLaw(
        "squeeze film",
        "Booker, CRC Handbook of Lubrication II (1983) 121",
        "grease that fills the gap; takes a speed, not a share of it",
        _greased,
        _expected_of_film,
        linear=True,
    ),
}
