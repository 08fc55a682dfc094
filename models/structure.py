"""The linear structure that the effects change: what it is made of, before any matrix is formed."""

from dataclasses import dataclass, replace
from math import inf, pi
from typing import Self

from models.errors import DivergenceError
from models.rig import Beam, Oscillator


@dataclass(frozen=True)
class Hinge:
    """Extra rotational flexibility of a stretch of beam, lumped at its centre.

    Attributes:
        position: m from the clamp.
        flexibility: rad/(N m), from loss * width / ((1 - loss) E I).
    """

    position: float
    flexibility: float


@dataclass(frozen=True)
class Absorber:
    """A small oscillator hanging on the structure.

    Attributes:
        position: m from the clamp; None on an oscillator.
        mass: kg.
        frequency: Hz, of the absorber on a fixed base.
        damping_ratio: of the absorber on a fixed base.
    """

    position: float | None
    mass: float
    frequency: float
    damping_ratio: float

    @property
    def coefficients(self) -> tuple[float, float]:
        """Its spring, N/m, and its dashpot, N s/m."""
        omega = 2.0 * pi * self.frequency
        return self.mass * omega**2, 2.0 * self.damping_ratio * omega * self.mass


@dataclass(frozen=True)
class Structure:
    """A cantilever, or one degree of freedom, with everything linear that is attached to it.

    Positions are m from the clamp, None on an oscillator.

    Attributes:
        length: m; 0 on an oscillator.
        diameter: m; 0 on an oscillator.
        bending_stiffness: E I, N m^2; on an oscillator its stiffness, N/m.
        line_mass: rho A, kg/m; on an oscillator its mass, kg.
        rayleigh: (eta1 1/s, eta2 s) of C = eta1 M + eta2 K; on an oscillator (c/m, 0).
        gravity: m/s^2, downwards.
        clamp_stiffness: rotational stiffness of the clamp, N m/rad; infinite for a built-in end.
        axial_force: N, tension positive.
        damping_scale: factor on the damping ratio of every mode of the structure without sleeves.
        loss_factor: structural loss factor that replaces ``rayleigh`` by zeta = loss_factor / 2, or None.
        masses, springs, dashpots: (position, kg | N/m | N s/m) of points attached.
        hinges: local losses of bending stiffness.
        absorbers: attached oscillators.
        stiffness_rate: growth of the bending stiffness, 1/s: E I (1 + stiffness_rate t), t from each record's start;
            what the material's viscosity takes follows. Everything at rest is that of the start.
    """

    length: float
    diameter: float
    bending_stiffness: float
    line_mass: float
    rayleigh: tuple[float, float]
    gravity: float
    clamp_stiffness: float = inf
    axial_force: float = 0.0
    damping_scale: float = 1.0
    loss_factor: float | None = None
    masses: tuple[tuple[float | None, float], ...] = ()
    springs: tuple[tuple[float | None, float], ...] = ()
    dashpots: tuple[tuple[float | None, float], ...] = ()
    hinges: tuple[Hinge, ...] = ()
    absorbers: tuple[Absorber, ...] = ()
    stiffness_rate: float = 0.0

    @classmethod
    def of(cls, owner: Beam | Oscillator) -> Self:
        """The bare structure of a rig file."""
        if isinstance(owner, Oscillator):
            return cls(0.0, 0.0, owner.stiffness, owner.mass, (owner.damping / owner.mass, 0.0), owner.gravity)
        area, inertia = pi * owner.diameter**2 / 4, pi * owner.diameter**4 / 64
        return cls(
            length=owner.length,
            diameter=owner.diameter,
            bending_stiffness=owner.youngs_modulus * inertia,
            line_mass=owner.density * area,
            rayleigh=owner.rayleigh_damping,
            gravity=owner.gravity,
        )

    @property
    def is_beam(self) -> bool:
        """A beam, not an oscillator."""
        return self.length > 0

    @property
    def viscosity(self) -> float:
        """Of the material, s: stress from strain rate over stress from strain; 0 where a loss factor replaces it."""
        return 0.0 if self.loss_factor is not None else self.damping_scale * self.rayleigh[1]

    def at(self, time: float) -> Self:
        """As it is some time after the record's start, s, and stays."""
        grown = self.bending_stiffness * (1.0 + self.stiffness_rate * time)
        return replace(self, bending_stiffness=grown, stiffness_rate=0.0)

    def later(self, seconds: float) -> Self:
        """As a record meets it that begins so much later.

        Raises:
            DivergenceError: the stiffness has drifted to nothing by then.
        """
        check_drift(self.stiffness_rate, seconds)
        return replace(self.at(seconds), stiffness_rate=self.stiffness_rate / (1.0 + self.stiffness_rate * seconds))

    def with_mass(self, position: float | None, mass: float) -> Self:
        """With a point mass, kg, that moves with the structure."""
        return replace(self, masses=(*self.masses, (position, mass)))

    def with_spring(self, position: float | None, stiffness: float) -> Self:
        """With a spring, N/m, to the base."""
        return replace(self, springs=(*self.springs, (position, stiffness)))

    def with_dashpot(self, position: float | None, damping: float) -> Self:
        """With a dashpot, N s/m, to the base."""
        return replace(self, dashpots=(*self.dashpots, (position, damping)))


def check_drift(rate: float, duration: float) -> None:
    """Refuse a bending stiffness of which a record leaves nothing.

    Args:
        rate: of the bending stiffness, 1/s.
        duration: of the record, s.

    Raises:
        DivergenceError: E I falls to nothing or below.
    """
    if 1.0 + rate * duration <= 0.0:
        raise DivergenceError(
            f"stiffness_drift: at {rate:g} of itself a second the bending stiffness is gone {-1.0 / rate:.4g} s after "
            f"the start of a record of {duration:.4g} s; a smaller rate or a shorter record leaves some of it"
        )
