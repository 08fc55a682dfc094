"""Where point laws act: linear functionals of the displacement field, and the laws attached to them."""

from dataclasses import dataclass, replace
from typing import Literal, Self

from models.contact.protocol import ContactLaw
from models.law import LawFunction

Frame = Literal["base", "ground"]


@dataclass(frozen=True)
class Port:
    """A place where a law reads the motion and returns a force: q = d^n u/dx^n at ``position``.

    Attributes:
        position: m from the clamp; None on an oscillator.
        derivative: 0 displacement (force N), 1 slope (moment N m), 2 curvature (N m^2).
        frame: whether q and v are relative to the base or absolute.
        across: at right angles to the rig's plane, in which all else is; simulators that move in space know it.
        spread: one of many that stand for a force along the beam, which none of them bends by itself.
    """

    position: float | None
    derivative: int = 0
    frame: Frame = "base"
    across: bool = False
    spread: bool = False

    @property
    def is_concentrated(self) -> bool:
        """A force there bends the beam as a force at one point does."""
        return self.derivative == 0 and not self.spread


@dataclass(frozen=True)
class PointLaw:
    """A force on the structure that depends on time and on the motion at one port.

    Attributes:
        port: where.
        force: F(t, q, v, z, p), on the structure, positive along q.
        parameters: p.
        rate: dz/dt(t, q, v, z, p) of the internal state, or None; z is 0 at rest.
        owner: what the report calls it, e.g. ``squeeze_film at sleeve 2``.
        yields: the last of p is for the model to fill in: what its port yields to a unit force, all modes together.
    """

    port: Port
    force: LawFunction
    parameters: tuple[float, ...]
    rate: LawFunction | None = None
    owner: str = ""
    yields: bool = False

    def yielding(self, flexibility: float) -> "PointLaw":
        """The law with what its port yields to a unit force in a model, where it asks for that.

        The curvature under a force on the curvature has no limit as a model is refined, so a law that acts on it has
        to know the model's own.

        Args:
            flexibility: of the port, its own unit per N times the port's own unit.
        """
        return replace(self, parameters=(*self.parameters[:-1], flexibility)) if self.yields else self


@dataclass(frozen=True)
class Contact:
    """One sleeve as the beam meets it: contact where p = |q - offset| - clearance(t) > 0, pushing back, never pulling.

    Attributes:
        sleeve: its name.
        position: m from the clamp; None on an oscillator.
        law: normal force from penetration and its rate; with no clearance it acts in both directions.
        clearance: radial gap at the record's start, m.
        offset: the sleeve's centre above the beam's unloaded axis, m.
        clearance_rate: growth of the clearance, m/s.
    """

    sleeve: str
    position: float | None
    law: ContactLaw
    clearance: float
    offset: float = 0.0
    clearance_rate: float = 0.0

    def later(self, seconds: float) -> Self:
        """As a record meets it that begins so much later."""
        clearance = self.clearance + self.clearance_rate * seconds
        return replace(self, law=self.law.later(seconds), clearance=clearance)
