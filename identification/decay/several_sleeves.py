"""The dampings of several sleeves at once from the damping ratios of as many modes or more."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from identification.decay.course import NORMAL_95
from identification.decay.sleeve_poles import Dashpots, nearest_modes, ratio_slopes, ratios_of
from models.arrays import FloatArray
from models.errors import InputError
from models.linear import Linearised

ALIKE = 1e-6
"""Ratio of the smallest to the largest singular value of the weighted slopes below which sleeves cannot be told
apart."""


@dataclass(frozen=True, eq=False)
class SleeveDampings:
    """Dampings of sleeves that explain damping ratios best.

    Attributes:
        sleeves: names.
        values: (n_sleeves,) N s/m.
        covariance: (n_sleeves, n_sleeves), wider where modes contradict one another.
        slopes: (n_modes, n_sleeves) derivatives of the damping ratios, 1/(N s/m).
        left: (n_modes,) identified minus computed ratios, in standard deviations.
    """

    sleeves: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray
    slopes: FloatArray
    left: FloatArray

    @property
    def stds(self) -> FloatArray:
        """(n_sleeves,) N s/m."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def intervals(self) -> FloatArray:
        """(n_sleeves, 2) 95 % intervals, from 0 on, N s/m."""
        return np.asarray(
            np.maximum(self.values[:, None] + NORMAL_95 * self.stds[:, None] * np.array([-1.0, 1.0]), 0.0)
        )


def several_dampings(
    linear: Linearised, sleeves: tuple[str, ...], natural_freqs: FloatArray, ratios: FloatArray, stds: FloatArray
) -> SleeveDampings:
    """The dampings of sleeves that are closed at rest, by least squares over the modes, from the rig's own on.

    Args:
        linear: the rig at rest.
        sleeves: names.
        natural_freqs: (n_modes,) identified, Hz; each belongs to the computed mode that is nearest.
        ratios: (n_modes,) identified damping ratios.
        stds: (n_modes,) of the ratios.

    Raises:
        InputError: an unknown or open sleeve, fewer modes than sleeves, a frequency that no mode has, or sleeves whose
            dampings do the same to all of these modes.
    """
    if len(ratios) < len(sleeves) or not sleeves:
        raise InputError(
            f"{len(ratios)} modes for {len(sleeves)} sleeves",
            "each mode tells one number, so as many modes as sleeves are needed",
            "name fewer sleeves or identify more modes",
        )
    dashpots = Dashpots.of(linear, sleeves)

    def computed(dampings: FloatArray) -> tuple[FloatArray, FloatArray]:
        poles, slopes = dashpots.poles(dampings)
        chosen = nearest_modes(np.abs(poles) / (2.0 * np.pi), natural_freqs)
        return ratios_of(poles[chosen]), ratio_slopes(poles[chosen, None], slopes[chosen])

    def fault(dampings: FloatArray) -> FloatArray:
        return np.asarray((computed(dampings)[0] - ratios) / stds)

    def slope(dampings: FloatArray) -> FloatArray:
        return np.asarray(computed(dampings)[1] / stds[:, None])

    found = least_squares(
        fault,
        np.maximum(dashpots.own, np.finfo(float).tiny),
        jac=slope,
        bounds=(0.0, np.inf),
        x_scale="jac",
        xtol=1e-10,
        ftol=1e-12,
    )
    _, slopes = computed(found.x)
    weighted = slopes / stds[:, None]
    sizes = np.linalg.svd(weighted / np.maximum(np.linalg.norm(weighted, axis=0), np.finfo(float).tiny))[1]
    if sizes[-1] < ALIKE * sizes[0]:
        raise InputError(
            f"the dampings of {', '.join(sleeves)} from modes at {', '.join(f'{f:.4g}' for f in natural_freqs)} Hz",
            "each sleeve damps these modes in shares of its own",
            "name fewer sleeves or identify more modes",
        )
    left = (ratios - computed(found.x)[0]) / stds
    spare = len(ratios) - len(sleeves)
    widening = max(1.0, float(np.sum(left**2)) / spare) if spare else 1.0
    covariance = np.asarray(widening * np.linalg.inv(weighted.T @ weighted), np.float64)
    return SleeveDampings(sleeves, found.x, covariance, slopes, left)
