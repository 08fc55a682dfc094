"""The poles of the rig at rest over the dampings of its closed sleeves, exact and with their derivatives.

A sleeve that is closed at rest adds c r r' to the modal damping matrix, r being its motion by modal coordinate.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from models.arrays import ComplexArray, FloatArray, IntArray
from models.errors import InputError
from models.linear import LEAST_TURN, Linearised, Tangent

SAME_MODE = 0.1
"""Share by which an identified and a computed natural frequency may differ and still belong to one mode."""


@dataclass(frozen=True, eq=False)
class Dashpots:
    """The rig at rest, its closed sleeves' dampings left open.

    Attributes:
        stiffness, damping: (n, n) of ``Linearised``, the dampings of these sleeves taken out, 1/s^2 and 1/s.
        rows: (n_sleeves, n) motion of the sleeves by modal coordinate.
        own: (n_sleeves,) what was taken out, N s/m.
        springs: (n_sleeves,) tangent stiffness of the sleeves, N/m.
    """

    stiffness: FloatArray
    damping: FloatArray
    rows: FloatArray
    own: FloatArray
    springs: FloatArray

    @classmethod
    def of(cls, linear: Linearised, sleeves: tuple[str, ...]) -> Self:
        """Take the dampings of closed sleeves out of a linearised rig.

        Args:
            linear: the rig at rest.
            sleeves: names.

        Raises:
            InputError: a sleeve that the rig has not, or one that does not touch at rest.
        """
        model = linear.model
        tangents = [_closed(linear, name) for name in sleeves]
        rows = np.stack([model.port_rows[model.ports.index(tangent.port)] for tangent in tangents])
        own = np.array([tangent.damping for tangent in tangents])
        bare = linear.damping - (rows.T * own) @ rows
        return cls(linear.stiffness, bare, rows, own, np.array([tangent.stiffness for tangent in tangents]))

    def poles(self, dampings: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """(m,) poles of the modes that oscillate, by size, and (m, n_sleeves) their derivatives by the dampings.

        Args:
            dampings: (n_sleeves,) N s/m.

        Source: Adhikari, AIAA J. 37 (1999) 1452, eq. (25), for damping in place of a general parameter.
        """
        n = len(self.stiffness)
        damping = self.damping + (self.rows.T * dampings) @ self.rows
        system = np.block([[np.zeros((n, n)), np.eye(n)], [-self.stiffness, -damping]])
        values, vectors = np.linalg.eig(system)
        chosen = np.flatnonzero(values.imag > LEAST_TURN * np.abs(values))
        chosen = chosen[np.argsort(np.abs(values[chosen]))]
        value, shape = values[chosen], vectors[:n, chosen]
        weight = 2.0 * value * np.sum(shape**2, axis=0) + np.einsum("im,ij,jm->m", shape, damping, shape)
        return value, -((self.rows @ shape) ** 2 * value / weight).T


def _closed(linear: Linearised, sleeve: str) -> Tangent:
    contacts = [contact.sleeve for contact in linear.model.plant.contacts]
    if sleeve not in contacts:
        raise InputError(
            f"sleeve {sleeve!r}", f"the rig has {', '.join(contacts) or 'no sleeve'}", "use one of these names"
        )
    tangent = linear.tangents[len(linear.tangents) - len(contacts) + contacts.index(sleeve)]
    if tangent.stiffness == 0.0 and tangent.damping == 0.0:
        gap = -linear.model.rest.penetration[contacts.index(sleeve)]
        raise InputError(
            f"{sleeve}: it is open at rest, by {1e3 * gap:.3g} mm",
            "a dashpot that does not touch damps no small motion",
            "name a sleeve that touches at rest (testbed modes shows which)",
        )
    return tangent


def ratios_of(poles: ComplexArray) -> FloatArray:
    """Damping ratios of (...) poles, 1/s."""
    return np.asarray(-poles.real / np.abs(poles))


def ratio_slopes(poles: ComplexArray, slopes: ComplexArray) -> FloatArray:
    """Derivatives of the damping ratios of (...) poles from (...) derivatives of the poles by the same number."""
    size = np.abs(poles)
    return np.asarray(-slopes.real / size + poles.real * (poles.conj() * slopes).real / size**3)


def nearest_modes(computed: FloatArray, identified: FloatArray) -> IntArray:
    """(m,) places among (n,) computed natural frequencies of (m,) identified ones, Hz, no two the same.

    Raises:
        InputError: a frequency that none has.
    """
    apart = np.abs(np.log(np.asarray(identified)[:, None] / computed))
    if len(identified) <= len(computed):
        mode, number = linear_sum_assignment(np.minimum(apart, SAME_MODE))
        if (apart[mode, number] < SAME_MODE).all():
            return np.asarray(number, np.int64)
    near = computed[computed < 2.0 * np.max(identified)]
    raise InputError(
        f"modes at {', '.join(f'{freq:.4g}' for freq in identified)} Hz",
        f"the rig at rest has {', '.join(f'{freq:.4g}' for freq in near)} Hz, and each belongs to one within "
        f"{SAME_MODE:.0%}",
        "leave the others out, or correct the rig",
    )
