"""The balance of harmonics at the ports: x = H(i k omega) (excitation + forces of x), with its slopes.

Only the ports, where laws and contacts act, carry unknowns: the rest of the model is linear and follows from them by
its receptances. The forces are sampled over one period and turned into harmonics, as are their slopes, whose harmonics
stand in the Jacobian on diagonals and antidiagonals.

Source: M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), chapters 2 and 3.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple, Self

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from models.harmonic_balance.drive import SineDrive
from models.harmonic_balance.kernel import Frame, Sine, Waves, over_period, residual_of, slopes_of
from models.harmonic_balance.poles import Poles, StateSpace
from models.law import LawFunction
from models.modal import ModalModel
from models.point_forces import Items, PointForce, compile_items
from models.ports import Port
from models.rest import is_bilateral

SAMPLES_PER_HARMONIC, LEAST_SAMPLES = 16, 512
"""Of the forces over a period: enough for a contact's corners not to come back as low harmonics."""

PROBES = ((1e-3, 0.1), (-1e-3, -0.1))
"""Displacements, m, and velocities, m/s, at which laws are asked whether they change with time."""

DEPTH = 2e-3
"""m, of a contact that is asked; it is closed then."""

LATER = (0.37, 11.0)
"""s, when they are asked again."""


class OverPeriod(NamedTuple):
    """What the laws and contacts do in one period of a motion.

    Attributes:
        forces: (n_ports, N) less those at rest, N.
        by_q, by_v: (n_ports, N) their slopes over the motion, N/m and N s/m.
    """

    forces: FloatArray
    by_q: FloatArray
    by_v: FloatArray


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of a modal model under a sinusoidal excitation, for harmonics 0 to H.

    Motion of the ports is told by n real coefficients in a row: per port the mean, then real and imaginary part of each
    harmonic, q = x_0 + 2 Re sum x_k exp(i k omega t), m about rest.

    Attributes:
        model: with its rest.
        n_harmonics: H.
        drive: the excitation.
        receptance: of the linear part, from the ports and the excitation to the ports.
        items: compiled laws and contacts.
        rest_force: (n_ports,) at rest, N.
    """

    model: ModalModel
    n_harmonics: int
    drive: SineDrive
    receptance: Poles
    items: Items
    rest_force: FloatArray

    @classmethod
    def of(cls, model: ModalModel, n_harmonics: int) -> Self:
        """Of a modal model.

        Args:
            model: whose laws do not change with time.
            n_harmonics: H.

        Raises:
            InputError: a law with a memory or a clock, a structure that drifts or that nothing holds.
        """
        _refuse_what_is_not_periodic(model)
        plant = model.plant
        forces = [PointForce(law.port, law.force, law.parameters) for law in plant.laws]
        forces += [
            PointForce(
                Port(contact.position),
                contact.law.normal_force,
                contact.law.values,
                contact=(contact.clearance, contact.offset, 0.0),
                bilateral=is_bilateral(contact),
            )
            for contact in plant.contacts
        ]
        drive, items = SineDrive.of(model), compile_items(forces, model.ports)
        load = np.column_stack([model.port_rows.T, drive.load])
        receptance = StateSpace.of(model).between(model.port_rows, load)
        return cls(model, n_harmonics, drive, receptance, items, model.port_forces(model.rest))

    @cached_property
    def n_samples(self) -> int:
        """N of one period, a power of two."""
        return max(LEAST_SAMPLES, 1 << (SAMPLES_PER_HARMONIC * self.n_harmonics - 1).bit_length())

    @cached_property
    def n_unknowns(self) -> int:
        """n, real numbers that describe the motion of the ports."""
        return len(self.model.ports) * (2 * self.n_harmonics + 1)

    def packed(self, x: ComplexArray) -> FloatArray:
        """(n,) real numbers of (n_ports, H + 1) two-sided Fourier coefficients."""
        y = np.empty((len(x), 2 * self.n_harmonics + 1))
        y[:, 0], y[:, 1::2], y[:, 2::2] = x[:, 0].real, x[:, 1:].real, x[:, 1:].imag
        return y.ravel()

    def unpacked(self, y: FloatArray) -> ComplexArray:
        """The coefficients of real numbers."""
        rows = y.reshape(len(self.model.ports), -1)
        x = np.empty((len(rows), self.n_harmonics + 1), complex)
        x[:, 0], x[:, 1:] = rows[:, 0], rows[:, 1::2] + 1j * rows[:, 2::2]
        return x

    def residual(self, y: FloatArray, omega: float, amplitude: float) -> FloatArray:
        """(n,) what is left of the equations, m.

        Args:
            y: (n,) motion, m.
            omega: rad/s.
            amplitude: of the excitation, in its own quantity.
        """
        return residual_of(self._frame, self._rows(y), self._sine(omega, amplitude)).ravel()

    def slopes(self, y: FloatArray, omega: float, amplitude: float) -> FloatArray:
        """(n, n + 2) slopes of what is left over the motion, omega and the amplitude.

        Args:
            y: (n,) motion, m.
            omega: rad/s.
            amplitude: of the excitation, in its own quantity.
        """
        return slopes_of(self._frame, self._rows(y), self._sine(omega, amplitude))

    def over_period(self, y: FloatArray, omega: float, amplitude: float) -> OverPeriod:
        """The forces of a motion and their slopes.

        Args:
            y: (n,) motion, m.
            omega: rad/s.
            amplitude: of the excitation, in its own quantity.
        """
        return OverPeriod(*over_period(self._frame, self._rows(y), self._sine(omega, amplitude)))

    @cached_property
    def _frame(self) -> Frame:
        return Frame(
            items=self.items,
            rest=self.model.rest.position,
            rest_force=self.rest_force,
            absolute=self.drive.absolute,
            poles=self.receptance.poles,
            residues=self.receptance.residues,
            waves=_waves(self.n_harmonics, self.n_samples),
        )

    def _rows(self, y: FloatArray) -> FloatArray:
        return y.reshape(-1, 2 * self.n_harmonics + 1)

    def _sine(self, omega: float, amplitude: float) -> Sine:
        drive, half = self.drive, 0.5 * amplitude
        base, given = drive.base_at(omega), drive.input_at(omega)
        return Sine(
            omega=omega,
            base=half * base,
            base_by_omega=half * drive.base_slope_at(omega),
            base_by_amplitude=0.5 * base,
            given=half * given,
            given_by_omega=half * drive.input_slope_at(omega),
            given_by_amplitude=0.5 * given,
        )


@lru_cache(maxsize=16)
def _waves(n_harmonics: int, n_samples: int) -> Waves:
    """Matrices between a period's samples and its coefficients."""
    angles = 2.0 * np.pi / n_samples * np.outer(np.arange(1, 2 * n_harmonics + 1), np.arange(n_samples))
    rows = np.empty((4 * n_harmonics + 1, n_samples))
    rows[0], rows[1::2], rows[2::2] = 1.0, np.cos(angles), -np.sin(angles)
    size = 2 * n_harmonics + 1
    to_time = rows[:size].copy()
    to_time[1:] *= 2.0
    back = rows.T / n_samples
    return Waves(to_time, np.ascontiguousarray(back[:, :size]), np.ascontiguousarray(back))


def _refuse_what_is_not_periodic(model: ModalModel) -> None:
    """No memory, no clock: motion that repeats has neither."""
    if model.plant.structure.stiffness_rate != 0.0:
        _refuse("a bending stiffness that drifts")
    for effect in model.plant.effects:
        if effect.base_acceleration(np.zeros(2), dict.fromkeys(effect.record_parameters, 0.0)) is not None:
            _refuse(f"{effect.kind}, which moves the base by itself")
    for law in model.plant.laws:
        if law.rate is not None:
            _refuse(f"{law.owner}, which has a memory")
        place = float(model.rest.position[model.ports.index(law.port)])
        if _has_a_clock(law.force, law.parameters, place):
            _refuse(f"{law.owner}, which changes with time")
    for contact in model.plant.contacts:
        if contact.clearance_rate != 0.0 or _has_a_clock(contact.law.normal_force, contact.law.values, DEPTH):
            _refuse(f"{contact.sleeve}, whose contact changes with time")


def _has_a_clock(law: LawFunction, values: Sequence[float], place: float) -> bool:
    """Whether a law says something else later, in motion about a place, m."""
    probes = [(place + q, v) for q, v in PROBES]
    return any(law(t, q, v, 0.0, values) != law(0.0, q, v, 0.0, values) for q, v in probes for t in LATER)


def _refuse(what: str) -> None:
    raise InputError(
        what,
        "harmonic balance seeks motion that repeats in every period, without memory from before",
        "leave it out, or step the model in time",
    )
