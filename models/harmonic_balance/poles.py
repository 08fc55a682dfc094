"""The linear part of the modal model by its poles and residues: receptances at any frequency for the price of a sum."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from models.modal import ModalModel

LARGEST_CONDITION = 1e12
"""Of the eigenvectors; beyond it two poles have one vector, as those of a body that nothing holds."""


@dataclass(frozen=True, eq=False)
class Poles:
    """H(s) = sum of residues / (s - pole), m/N from forces at places to displacements at places.

    Attributes:
        poles: (2n,) 1/s.
        residues: (2n, n_out * n_in), m/(N s).
        shape: (n_out, n_in).
    """

    poles: ComplexArray
    residues: ComplexArray
    shape: tuple[int, int]

    def at(self, s: ComplexArray) -> ComplexArray:
        """(n_s, n_out, n_in) receptances at s, 1/s."""
        return np.asarray((1.0 / (s[:, None] - self.poles)) @ self.residues).reshape(-1, *self.shape)


@dataclass(frozen=True, eq=False)
class StateSpace:
    """The modal model without its ports' forces, its state turned to the poles.

    Attributes:
        poles: (2n,) 1/s.
        vectors: (2n, 2n) states, displacements then velocities, by pole.
        inverse: of ``vectors``.
    """

    poles: ComplexArray
    vectors: ComplexArray
    inverse: ComplexArray

    @classmethod
    def of(cls, model: ModalModel) -> Self:
        """Of a modal model.

        Args:
            model: with its damping.

        Raises:
            InputError: a structure that nothing holds.
        """
        n = model.n
        system = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(model.omega**2), -model.damping]])
        poles, vectors = np.linalg.eig(system)
        if not np.linalg.cond(vectors) < LARGEST_CONDITION:
            raise InputError(
                "a structure whose poles have no vectors of their own, such as a body without a spring",
                "harmonic balance needs a static deflection for every force",
                "hold the structure by a spring, or step it in time",
            )
        return cls(poles.astype(complex), vectors.astype(complex), np.linalg.inv(vectors).astype(complex))

    def between(self, read: FloatArray, load: FloatArray) -> Poles:
        """Receptances from modal loads to modal readings.

        Args:
            read: (n_out, n) displacement by modal coordinate.
            load: (n, n_in) modal force per unit input.
        """
        n = read.shape[1]
        left, right = read @ self.vectors[:n], self.inverse[:, n:] @ load
        residues = left.T[:, :, None] * right[:, None, :]
        return Poles(self.poles, residues.reshape(len(self.poles), -1), (left.shape[0], right.shape[1]))
