"""The rig of the article, as far as its tables tell: an assumed geometry that has the measured natural frequencies.

The article prints neither dimensions nor stiffnesses. Assumed are a round steel rod, where its two sleeves sit and how
far the clamp gives; sought are the length, the stiffness of both contacts and the mass at the tip. At the clearance of
calibration both sleeves carry the rod at rest, so all four numbers act in the linearised model.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Literal

import numpy as np
from scipy.optimize import least_squares

from models.arrays import FloatArray
from models.linear import linearised, natural_modes
from models.modal import ModalModel, build_modal
from models.plant import build_plant
from models.rig import Beam, EffectEntry, Excitation, Rig, Sensor, Sleeve
from testbed.article.published import published

DIAMETER, YOUNGS_MODULUS, DENSITY, GRAVITY = 0.02, 210e9, 7850.0, 9.81
"""Assumed: a round steel rod, m, Pa, kg/m^3, on the ground, m/s^2."""

SLEEVES_AT = (0.294, 0.513)
"""Assumed, as shares of the length: between them the rod lies on both sleeves up to the clearance of calibration."""

CLAMP_GROUP = 3.6
"""Assumed: rotational stiffness of the clamp in units of E I / L."""

RAYLEIGH = (1.2, 6e-6)
"""Assumed: damping of the rod, 1/s and s."""

CONTACT_DAMPING = 20.0
"""Assumed: of both contacts, N s/m, constant, as the initial model has it."""

TOLERANCES = {
    "youngs_modulus": 0.01,
    "rayleigh_damping": 0.1,
    "sleeves.clearance": 0.02,
    "sleeves.stiffness": 0.1,
    "sleeves.damping": 0.3,
}
"""Assumed: one standard deviation of what the owner of the rig knows, as fractions."""

POINTS_AT = (0.1, 0.2, *SLEEVES_AT, 0.4, 0.65, 0.82, 1.0)
"""Assumed: the eight points, as shares of the length; the article measures at both sleeves, in front and at the end."""

TIP = f"P{len(POINTS_AT)}"
"""Name of the last point."""

FORCE_AT = 0.65
"""Assumed: where the shaker pushes."""

CALIBRATED_AT = 5e-4
"""Clearance, m, at which the linearised model has the measured frequencies."""

BAND = 400.0
"""Hz below which the linearised model is right: twice the fourth frequency."""

GUESS = (1.45, 33.0, 82.0, 0.17)
"""Length, m, contact stiffnesses in E I / L^3, mass of the tip over the rod's: where the search begins."""

Drive = Literal["table", "force"]
"""The whole rig on a shaker table, or a shaker on the rod."""


@dataclass(frozen=True)
class Geometry:
    """What the calibration found.

    Attributes:
        length: of the rod, m.
        contact_groups: stiffness of each contact in units of E I / L^3.
        tip_share: mass at the tip over that of the rod.
    """

    length: float
    contact_groups: tuple[float, float]
    tip_share: float

    @cached_property
    def bending_stiffness(self) -> float:
        """E I, N m^2."""
        return YOUNGS_MODULUS * pi * DIAMETER**4 / 64.0

    @cached_property
    def line_mass(self) -> float:
        """Of the rod, kg/m."""
        return DENSITY * pi * DIAMETER**2 / 4.0

    @cached_property
    def rate(self) -> float:
        """E I / (rho A L^4), 1/s^2: the square of the circular frequency that all others are multiples of."""
        return self.bending_stiffness / (self.line_mass * self.length**4)

    @cached_property
    def sag(self) -> float:
        """What the rod alone would sag at its tip without sleeves, clamped stiffly, m: the unit of the clearances."""
        return GRAVITY / (8.0 * self.rate)

    def rig(self, clearance: float, drive: Drive) -> Rig:
        """The rig as its owner describes it: constant damping in the contacts, no grease.

        Args:
            clearance: of both sleeves, m.
            drive: which of the two tests.
        """
        force_unit, length = self.bending_stiffness / self.length**3, self.length
        places = sorted(POINTS_AT)
        return Rig(
            structure=Beam(
                kind="beam",
                length=length,
                diameter=DIAMETER,
                youngs_modulus=YOUNGS_MODULUS,
                density=DENSITY,
                rayleigh_damping=RAYLEIGH,
                gravity=GRAVITY,
            ),
            tolerances=TOLERANCES,
            sleeves=tuple(
                Sleeve(
                    name=f"sleeve {number}",
                    position=share * length,
                    clearance=clearance,
                    stiffness=group * force_unit,
                    damping=CONTACT_DAMPING,
                )
                for number, (share, group) in enumerate(zip(SLEEVES_AT, self.contact_groups, strict=True), start=1)
            ),
            excitation=(
                Excitation(name="table", quantity="base_acceleration")
                if drive == "table"
                else Excitation(name="shaker", position=FORCE_AT * length)
            ),
            sensors=tuple(
                Sensor(name=f"P{number}", position=share * length) for number, share in enumerate(places, start=1)
            ),
            effects=(
                EffectEntry(
                    kind="clamp_compliance",
                    rotational_stiffness=CLAMP_GROUP * self.bending_stiffness / length,
                ),
                EffectEntry(kind="point_mass", position=length, mass=self.tip_share * self.line_mass * length),
            ),
        )


def calibrated() -> Geometry:
    """The geometry whose linearised model has the frequencies measured at ``CALIBRATED_AT``."""
    wanted = next(np.array(test.measured_freqs) for test in published() if test.clearance == CALIBRATED_AT)

    def misses(logs: FloatArray) -> FloatArray:
        return np.asarray(np.log(natural_freqs(_geometry(logs).rig(CALIBRATED_AT, "force")) / wanted))

    return _geometry(least_squares(misses, np.zeros(len(GUESS)), xtol=1e-12, ftol=1e-14).x)


def _geometry(logs: FloatArray) -> Geometry:
    length, first, second, tip_share = (np.array(GUESS) * np.exp(logs)).tolist()
    return Geometry(length, (first, second), tip_share)


def natural_freqs(rig: Rig) -> FloatArray:
    """(4,) Hz, of small motion about rest.

    Args:
        rig: of this study.
    """
    return natural_modes(linearised(at_rest(rig)), (), BAND).natural_freqs[:4]


def at_rest(rig: Rig) -> ModalModel:
    """The modal model, which knows where the rod lies at rest.

    Args:
        rig: of this study.
    """
    return build_modal(build_plant(rig), BAND)
