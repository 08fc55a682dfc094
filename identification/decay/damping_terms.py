"""The three-parameter damping c(t) = a0 m + a1 k + a3 j k, its terms weighted so that the loss is counted once.

With a0 = 2 omega xi, a1 = 2 xi / omega and a3 = 2 xi each term by itself loses, at the frequency
omega = sqrt(k / m), what a dashpot 2 xi omega m loses; all three at full strength lose it three times. Weights that sum
to 1 share it out. The complex term is a force in phase with the velocity and in proportion to the displacement: in the
time domain j x is the signal turned by a quarter period, which for one frequency is v / omega.
docs/theory.md, section 13.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from models.arrays import FloatArray
from models.errors import InputError

EQUAL = (1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)
"""Of the three terms where a single mode cannot tell them apart; the dashpot that they equal is the same for all."""


@dataclass(frozen=True, eq=False)
class ThreeTerms:
    """The damping of one mode with equivalent mass m and stiffness k, (n,) each.

    Attributes:
        mass_term: weight a0 m, N s/m.
        stiffness_term: weight a1 k, N s/m.
        hysteretic_term: weight a3 k, the loss stiffness that multiplies j x, N/m.
        dashpot: what all three together equal at the mode's frequency, N s/m.
    """

    mass_term: FloatArray
    stiffness_term: FloatArray
    hysteretic_term: FloatArray
    dashpot: FloatArray


def three_terms(
    damping_ratio: FloatArray,
    omega: FloatArray,
    mass: float,
    stiffness: float,
    weights: tuple[float, float, float] = EQUAL,
) -> ThreeTerms:
    """The weighted terms along a decay.

    Args:
        damping_ratio: (n,).
        omega: (n,) rad/s.
        mass: equivalent, kg.
        stiffness: equivalent, N/m.
        weights: of the mass, the stiffness and the hysteretic term, not negative and 1 together.

    Raises:
        InputError: weights that do not sum to 1, or a mass or stiffness that is not positive.

    Source: Zhang et al., Actuators 14 (2025) 58, equations (14) to (16), weighted here.
    """
    if min(weights) < 0.0 or abs(sum(weights) - 1.0) > 1e-9:
        raise InputError(
            f"weights {weights} of the three damping terms",
            "they are not negative and sum to 1, or the loss is counted more or less than once",
            "divide them by their sum",
        )
    if mass <= 0.0 or stiffness <= 0.0:
        raise InputError(
            f"an equivalent mass of {mass:g} kg and stiffness of {stiffness:g} N/m",
            "both are positive",
            "name those of the mode whose damping it is",
        )
    first = weights[0] * 2.0 * omega * damping_ratio * mass
    second = weights[1] * 2.0 * damping_ratio / omega * stiffness
    third = weights[2] * 2.0 * damping_ratio * stiffness
    return ThreeTerms(first, second, third, first + second + third / omega)


@dataclass(frozen=True, eq=False)
class Shares:
    """How modes share their damping among the three mechanisms.

    Attributes:
        coefficients: a0 (1/s), a1 (s) and a3 (-) common to all modes, not negative.
        weights: (n_modes, 3) of each mode's damping ratio, which sum to 1.
        misfit: rms of (identified - 2 xi of the three) over the identified, -.
    """

    coefficients: FloatArray
    weights: FloatArray
    misfit: float


def shares_of(omega: FloatArray, damping_ratios: FloatArray) -> Shares:
    """The mechanisms that explain several modes' damping ratios together: 2 xi = a0 / omega + a1 omega + a3.

    Args:
        omega: (n_modes,) rad/s.
        damping_ratios: (n_modes,); with one mode the shares are equal.

    Source: Rayleigh damping with a loss factor; Lawson and Hanson, Solving Least Squares Problems, 1974, ch. 23.
    """
    if len(omega) == 1:
        c = 2.0 * damping_ratios[0] / 3.0
        return Shares(np.array([c * omega[0], c / omega[0], c]), np.array([EQUAL]), 0.0)
    columns = np.stack([1.0 / omega, omega, np.ones_like(omega)], axis=1)
    target = 2.0 * damping_ratios
    scale = np.linalg.norm(columns / target[:, None], axis=0)
    scaled, _ = nnls(columns / target[:, None] / scale, np.ones(len(omega)))
    coefficients = scaled / scale
    parts = columns * coefficients
    explained = parts.sum(axis=1)
    weights = parts / np.where(explained > 0.0, explained, 1.0)[:, None]
    return Shares(coefficients, weights, float(np.sqrt(np.mean((1.0 - explained / target) ** 2))))
