"""The ball before it strikes, and what is seen of the strike."""

from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.contact.protocol import ContactLaw
from models.plant import Plant
from models.ports import Contact, PointLaw
from models.rig import Excitation, Sensor
from models.structure import Structure

STEPS = 1000
"""In a lossless impact, of every simulator."""

LONGEST = 40
"""Lossless impacts that a strike may take from the start until the ball is back."""


@dataclass(frozen=True)
class Ball:
    """A mass between two stops, moving towards one of them, without gravity.

    Attributes:
        mass: kg.
        speed: m/s, towards the stop.
        law: of the stops.
        room: m, to each of them.
        time: s that a lossless impact takes.
        films: other forces on the ball, such as grease in the gap.
    """

    mass: float
    speed: float
    law: ContactLaw
    room: float
    time: float
    films: tuple[PointLaw, ...] = ()

    @property
    def plant(self) -> Plant:
        """The ball as an oscillator without a spring."""
        structure = Structure(0.0, 0.0, 0.0, self.mass, (0.0, 0.0), 0.0)
        stop = Contact("stop", None, self.law, self.room)
        sensor = Sensor(name="ball", quantity="displacement")
        return Plant(structure, (stop,), self.films, Excitation(quantity="force"), (sensor,), ())

    @property
    def step(self) -> float:
        """S."""
        return self.time / STEPS

    @property
    def n_steps(self) -> int:
        """Until the ball is back at the latest."""
        return LONGEST * STEPS


@dataclass(frozen=True, eq=False)
class Strike:
    """A ball on its way to a stop and back to where it came from.

    Attributes:
        ball: what struck.
        time: (N,) s.
        place: (N,) m, from where it came.
        speed: (N,) m/s.
        force: (N,) N of the stop on the ball; positive back.
    """

    ball: Ball
    time: FloatArray
    place: FloatArray
    speed: FloatArray
    force: FloatArray

    @classmethod
    def until_back(cls, ball: Ball, motion: FloatArray) -> "Strike":
        """The part of a motion that ends as the ball is back, or all of it.

        Args:
            ball: what struck.
            motion: (4, M) time, place, speed and force as in the attributes.
        """
        _, place, speed, _ = motion
        back = np.flatnonzero((place[1:] <= 0.0) & (speed[1:] < 0.0))
        time, place, speed, force = motion[:, : int(back[0]) + 2] if len(back) else motion
        return cls(ball, time, place, speed, force)

    @property
    def restitution(self) -> float:
        """Speed with which the ball is back, over that with which it came."""
        return float(-self.speed[-1] / self.ball.speed)

    @property
    def peak_force(self) -> float:
        """Largest force of the stop, N."""
        return float(self.force.max())

    @property
    def contact_time(self) -> float:
        """Time, s, during which the stop pushes."""
        pushed = np.flatnonzero(self.force > 0.0)
        return float(self.time[pushed[-1]] - self.time[pushed[0]]) if len(pushed) else 0.0

    @property
    def energy_lost(self) -> float:
        """Share of the ball's energy."""
        return 1.0 - self.restitution**2
