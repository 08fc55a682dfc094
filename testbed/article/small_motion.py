"""Natural frequencies of thousands of rigs at once: contacts, clearances and Young's modulus change, modes do not.

In the modes of the nominal rod without sleeves the stiffness is ``diag(omega^2) + (e - 1) B``, where ``e`` is Young's
modulus over its nominal value and ``B`` the part of bending: all but the clamp's spring. Contacts that carry the rod at
rest add ``k r r'`` and ``c r r'``. Which ones do follows from the rest state, one of four, that contradicts nothing.
"""

from dataclasses import dataclass
from itertools import product
from typing import Self

import numpy as np

from models.arrays import BoolArray, ComplexArray, FloatArray
from models.linear import LEAST_TURN
from models.modal import ModalModel
from models.rig import Beam, Rig
from testbed.article.rig import at_rest

MODES = 4


@dataclass(frozen=True, eq=False)
class Draws:
    """N rigs, ``(N, 2)`` where there is one number a sleeve.

    Attributes:
        stiffness: of the contacts, N/m.
        damping: of the contacts, N s/m.
        clearance: m.
        modulus: (N,) Young's modulus over the nominal one.
    """

    stiffness: FloatArray
    damping: FloatArray
    clearance: FloatArray
    modulus: FloatArray

    @classmethod
    def of(cls, rig: Rig, n: int) -> Self:
        """N times the same rig.

        Args:
            rig: of this study.
            n: how many.
        """
        stiffness, damping, clearance = (
            np.array([[getattr(sleeve, key) for sleeve in rig.sleeves]] * n)
            for key in ("stiffness", "damping", "clearance")
        )
        return cls(stiffness, damping, clearance, np.ones(n))


@dataclass(frozen=True, eq=False)
class SmallMotion:
    """The nominal rod in its modes without sleeves.

    Attributes:
        stiffness, bending: (n, n) of it, and the part of it that goes with Young's modulus, 1/s^2.
        damping: (n, n) 1/s.
        material: s, Rayleigh's factor on the stiffness, by which the damping goes with Young's modulus too.
        rows: (2, n) motion of the sleeves.
        weight: (n,) gravity's load, sqrt(kg) m/s^2.
    """

    stiffness: FloatArray
    bending: FloatArray
    damping: FloatArray
    material: float
    rows: FloatArray
    weight: FloatArray

    @classmethod
    def of(cls, rig: Rig) -> Self:
        """The rod of a rig.

        Args:
            rig: of this study, whose contacts and their changes over time are left out.
        """
        model = at_rest(rig)
        stiffness = np.diag(model.omega**2)
        assert isinstance(rig.structure, Beam)
        rows = np.stack([model.rows(contact.position) for contact in model.plant.contacts])
        weight = -rig.structure.gravity * model.carried
        material = rig.structure.rayleigh_damping[1]
        return cls(stiffness, stiffness - _clamp(rig, model), model.damping, material, rows, weight)

    def poles(self, draws: Draws) -> ComplexArray:
        """(N, 4) of the lowest modes that oscillate, 1/s.

        Args:
            draws: the rigs.
        """
        closed = self.touching(draws)
        K = self._stiffness(draws) + _at_sleeves(self.rows, draws.stiffness * closed)
        softened = (draws.modulus - 1.0)[:, None, None] * self.bending
        C = self.damping + self.material * softened + _at_sleeves(self.rows, draws.damping * closed)
        n = len(self.weight)
        system = np.zeros((len(K), 2 * n, 2 * n))
        system[:, :n, n:] = np.eye(n)
        system[:, n:, :n], system[:, n:, n:] = -K, -C
        values = np.linalg.eigvals(system).astype(complex)
        size = np.where(values.imag > LEAST_TURN * np.abs(values), np.abs(values), np.inf)
        return np.take_along_axis(values, np.argsort(size, axis=1)[:, :MODES], axis=1)

    def natural_freqs(self, draws: Draws) -> FloatArray:
        """(N, 4) Hz.

        Args:
            draws: the rigs.
        """
        return np.abs(self.poles(draws)) / (2.0 * np.pi)

    def touching(self, draws: Draws) -> BoolArray:
        """(N, 2) which sleeves carry the rod at rest; it sags, so it lies on their lower walls.

        Args:
            draws: the rigs.
        """
        K = self._stiffness(draws)
        found = np.zeros((len(K), 2), bool)
        for state in product((False, True), repeat=2):
            closed = np.array(state)
            load = self.weight - (draws.stiffness * closed * draws.clearance) @ self.rows
            place = np.linalg.solve(K + _at_sleeves(self.rows, draws.stiffness * closed), load[:, :, None])[:, :, 0]
            below = -place @ self.rows.T - draws.clearance
            found[((below > 0.0) == closed).all(axis=1)] = closed
        return found

    def _stiffness(self, draws: Draws) -> FloatArray:
        return self.stiffness + (draws.modulus - 1.0)[:, None, None] * self.bending


def _at_sleeves(rows: FloatArray, values: FloatArray) -> FloatArray:
    """(N, n, n) from (N, 2) springs or dashpots."""
    return np.asarray(np.einsum("si,Ns,sj->Nij", rows, values, rows))


def _clamp(rig: Rig, model: ModalModel) -> FloatArray:
    """(n, n) the clamp's spring in the modes."""
    turn = model.rows(0.0, 1)
    clamps = [entry.settings for entry in rig.effects if entry.kind == "clamp_compliance"]
    spring = sum(float(settings["rotational_stiffness"]) for settings in clamps)
    return np.asarray(spring * np.outer(turn, turn))
