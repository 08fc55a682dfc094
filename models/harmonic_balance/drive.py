"""A sinusoidal excitation of the modal model, as modal force and as motion of the base."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from models.arrays import FloatArray
from models.drive import ORDER
from models.errors import InputError
from models.modal import ModalModel


@dataclass(frozen=True, eq=False)
class SineDrive:
    """Excitation amplitude cos(omega t) in the rig's own quantity.

    Attributes:
        load: (n,) modal force per N of the shaker, or per m/s^2 of the base.
        order: how often the base's displacement was differentiated in the quantity; None where a shaker pushes.
        absolute: (n_ports,) 1 where a law reads absolute motion and the base moves.
    """

    load: FloatArray
    order: int | None
    absolute: FloatArray

    @classmethod
    def of(cls, model: ModalModel) -> Self:
        """As the model's rig says.

        Args:
            model: with its excitation.

        Raises:
            InputError: a rig that nothing drives.
        """
        excitation = model.plant.excitation
        if excitation is None:
            raise InputError(
                "a rig without excitation",
                "a nonlinear FRF needs to know what drives the rig",
                "add [excitation] to the rig file",
            )
        ground = np.array([float(port.frame == "ground") for port in model.ports])
        if excitation.quantity == "force":
            return cls(model.rows(excitation.position), None, np.zeros(len(model.ports)))
        return cls(-model.carried, ORDER[excitation.quantity], ground)

    def input_at(self, omega: float) -> complex:
        """Force, N, or acceleration of the base, m/s^2, per unit of the excitation's quantity."""
        return 1.0 + 0.0j if self.order is None else (1j * omega) ** (2 - self.order)

    def input_slope_at(self, omega: float) -> complex:
        """Its derivative over omega."""
        if self.order is None or self.order == ORDER["base_acceleration"]:
            return 0.0j
        power = 2 - self.order
        return 1j * power * (1j * omega) ** (power - 1)

    def base_at(self, omega: float) -> complex:
        """Displacement of the base, m, per unit of the excitation's quantity; 0 where a shaker pushes."""
        return 0.0j if self.order is None else (1j * omega) ** (-self.order)

    def base_slope_at(self, omega: float) -> complex:
        """Its derivative over omega."""
        return 0.0j if self.order is None else -1j * self.order * (1j * omega) ** (-self.order - 1)
