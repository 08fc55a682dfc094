"""A ball that strikes a stop with every law, at every restitution and speed, in every simulator."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from identification.progress import Progress
from models.ball import STRIKES, Ball, Strike, striker
from models.ball.restitution import hardness
from testbed.contact_laws.agreement import largest_by_law
from testbed.contact_laws.laws import STUDY_LAWS, Meeting, StudyLaw

RESTITUTIONS = (0.1, 0.3, 0.5, 0.7, 0.9, 0.95)
SPEEDS = (0.1, 0.5, 1.0)
"""m/s; restitutions are set for the middle one."""

MASS, STIFFNESS, EXPONENT = 1.0, 1e6, 1.5
"""Kg; N/m of a spring, and the exponent of the laws that have one, as hard as the spring at the middle speed."""

ROOM = 5e-4
"""M of gap that grease fills."""

CLOSE = 1e-3
"""Share of the depth from where a ball starts that meets no grease."""


@dataclass(frozen=True)
class BallRow:
    """One law, restitution and speed in one simulator.

    Attributes:
        law: key of ``STUDY_LAWS``.
        set: restitution that the law's numbers were chosen for.
        speed: m/s.
        expected: restitution in closed form.
        simulator: which.
        obtained: restitution.
        peak: largest force over that of a lossless impact.
        duration: time in contact over that of a lossless impact.
        lost: share of the energy.
    """

    law: str
    set: float
    speed: float
    expected: float
    simulator: str
    obtained: float
    peak: float
    duration: float
    lost: float


def meeting_of(law: StudyLaw) -> Meeting:
    """What meets at the stop of the study, as hard for every law at the middle speed.

    Args:
        law: linear or not.
    """
    linear = Meeting(MASS, STIFFNESS, 1.0, ROOM, SPEEDS[1])
    if law.linear:
        return linear
    _, wanted, _ = hardness(MASS, SPEEDS[1], STIFFNESS, 1.0)
    _, force, _ = hardness(MASS, SPEEDS[1], STIFFNESS, EXPONENT)
    # The largest force grows with k^(1 / (n + 1)) at one energy.
    return replace(linear, stiffness=STIFFNESS * (wanted / force) ** (EXPONENT + 1.0), exponent=EXPONENT)


def strikes(law: StudyLaw, restitution: float, speed: float, simulators: Sequence[str]) -> dict[str, Strike]:
    """One strike in each simulator.

    Args:
        law: whose stop is struck.
        restitution: set for the middle speed.
        speed: m/s.
        simulators: keys of ``STRIKES``.
    """
    meeting = meeting_of(law)
    depth, _, lasts = hardness(meeting.mass, speed, meeting.stiffness, meeting.exponent)
    stop = law.stop(restitution, meeting)
    room = meeting.room if stop.films else CLOSE * depth
    ball = Ball(meeting.mass, speed, stop.law, room, lasts, stop.films)
    return {name: striker(name)(ball) for name in simulators}


def ball_study(progress: Progress, simulators: Sequence[str] = tuple(STRIKES)) -> list[BallRow]:
    """Every law at every restitution and speed.

    Args:
        progress: told what is being done.
        simulators: which.
    """
    rows = []
    for key, law in STUDY_LAWS.items():
        progress(f"a ball against {law.name} in {', '.join(simulators)}")
        for restitution in (1.0,) if law.lossless else RESTITUTIONS:
            for speed in SPEEDS:
                meeting = meeting_of(law)
                _, force, lasts = hardness(meeting.mass, speed, meeting.stiffness, meeting.exponent)
                expected = law.expected(restitution, meeting, speed)
                for name, strike in strikes(law, restitution, speed, simulators).items():
                    about = (strike.restitution, strike.peak_force / force, strike.contact_time / lasts)
                    rows.append(BallRow(key, restitution, speed, expected, name, *about, strike.energy_lost))
    return rows


def disagreement(rows: Sequence[BallRow]) -> dict[str, float]:
    """Largest difference between the simulators by law, of all that is measured, relative to the modal model's value.

    Args:
        rows: of all simulators.
    """

    def shares(row: BallRow, modal: BallRow) -> Iterator[float]:
        for name in ("obtained", "peak", "duration", "lost"):
            one, other = getattr(row, name), getattr(modal, name)
            yield abs(one - other) / max(abs(other), LEAST)

    return largest_by_law(rows, lambda row: row.speed, shares)


LEAST = 0.01
"""A restitution, or a share of the energy, below which differences count as if it were so large."""
