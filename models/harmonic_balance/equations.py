"""The balance of harmonics at the ports: x = H(i k omega) (excitation + forces of x), with its exact slopes.

Only the ports, where laws and contacts act, carry unknowns: the rest of the model is linear and follows from them by
its receptances. The forces are sampled over one period and sent through a Fourier transform, as are their slopes, whose
harmonics stand in the Jacobian on diagonals and antidiagonals.

Source: M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), chapters 2 and 3.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from models.arrays import ComplexArray, FloatArray, IntArray
from models.errors import InputError
from models.harmonic_balance.drive import SineDrive
from models.harmonic_balance.forces import forces_over_period
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


@dataclass(frozen=True, eq=False)
class Balance:
    """The harmonics at the ports put into the equations.

    Attributes:
        residual: (n_ports, H + 1) m.
        by_x: (n, n) slope of the real residual over the real unknowns (``packed``).
        by_omega: (n,) over omega, m s.
        by_amplitude: (n,) over the excitation's amplitude.
        forces: (n_ports, N) of the laws, less those at rest, over one period, N.
        by_q, by_v: (n_ports, N) their slopes over the motion, N/m and N s/m.
    """

    residual: ComplexArray
    by_x: FloatArray
    by_omega: FloatArray
    by_amplitude: FloatArray
    forces: FloatArray
    by_q: FloatArray
    by_v: FloatArray


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of a modal model under a sinusoidal excitation, for harmonics 0 to H.

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
        """Real numbers that describe the motion of the ports."""
        return len(self.model.ports) * (2 * self.n_harmonics + 1)

    @cached_property
    def _orders(self) -> FloatArray:
        return np.arange(self.n_harmonics + 1.0)

    @cached_property
    def _places(self) -> tuple[IntArray, IntArray]:
        """(H + 1, H + 1) row - column and row + column: which harmonic of a slope couples them."""
        k = np.arange(self.n_harmonics + 1)
        return k[:, None] - k, k[:, None] + k

    def packed(self, x: ComplexArray) -> FloatArray:
        """(n,) real numbers of (n_ports, H + 1) two-sided Fourier coefficients: mean, real and imaginary parts."""
        return np.concatenate([x.real, x.imag[:, 1:]], axis=1).ravel()

    def unpacked(self, y: FloatArray) -> ComplexArray:
        """The coefficients of real numbers."""
        rows = y.reshape(len(self.model.ports), -1)
        x = rows[:, : self.n_harmonics + 1].astype(complex)
        x[:, 1:] += 1j * rows[:, self.n_harmonics + 1 :]
        return x

    def motion(self, x: ComplexArray, omega: float, amplitude: float) -> tuple[FloatArray, FloatArray]:
        """(n_ports, N) displacement and velocity as the laws see them over one period.

        Args:
            x: (n_ports, H + 1) coefficients about rest, m.
            omega: rad/s.
            amplitude: of the excitation.
        """
        seen = np.stack([x, x])
        seen[:, :, 1] += 0.5 * amplitude * self.drive.base_at(omega) * self.drive.absolute
        seen[1] *= 1j * omega * self._orders
        q, v = np.fft.irfft(seen, self.n_samples, axis=2, norm="forward")
        q += self.model.rest.position[:, None]
        return q, v

    def balance(self, x: ComplexArray, omega: float, amplitude: float) -> Balance:
        """Residual and slopes.

        Args:
            x: (n_ports, H + 1) coefficients about rest, m: q = x_0 + 2 Re sum x_k exp(i k omega t).
            omega: rad/s.
            amplitude: of the excitation, in its own quantity.
        """
        n, kept = self.n_samples, self.n_harmonics + 1
        q, v = self.motion(x, omega, amplitude)
        over_period = np.empty((4, *q.shape))
        force, by_q, by_v, by_turn = over_period
        forces_over_period(self.items, 2.0 * np.pi / (omega * n), q, v, force, by_q, by_v)
        force -= self.rest_force[:, None]
        np.multiply(by_v, v, out=by_turn)
        spectra = np.fft.rfft(over_period, axis=2)[:, :, : 2 * kept] / n
        pushed, slope_q, slope_v, changed = spectra[0, :, :kept].T, spectra[1], spectra[2], spectra[3, :, :kept] / omega

        turn = np.asarray(1j * omega * self._orders, complex)
        response, response_slope = self.receptance.at(turn), self.receptance.slope_at(turn)
        given, given_slope = self.drive.input_at(omega), self.drive.input_slope_at(omega)
        load = np.column_stack([pushed, np.zeros(kept)])
        load[1, -1] = 0.5 * amplitude * given
        residual = x - (response @ load[:, :, None])[:, :, 0].T

        own = response[:, :, :-1]
        forth, back = self._coupling(slope_q, slope_v, omega)
        by_x = self._real_slope(own, forth, back)

        # v = i k omega x and the base's motion change with omega, and so do the receptances.
        if self.drive.order is not None:
            changed += self._of_base(forth, back, 0.5 * amplitude * self.drive.base_slope_at(omega))
        by_omega = -(own @ changed.T[:, :, None])[:, :, 0].T
        by_omega -= ((1j * self._orders)[:, None, None] * response_slope @ load[:, :, None])[:, :, 0].T
        by_omega[:, 1] -= response[1, :, -1] * (0.5 * amplitude * given_slope)

        by_amplitude = np.zeros_like(residual)
        if self.drive.order is not None:
            moved = self._of_base(forth, back, 0.5 * self.drive.base_at(omega))
            by_amplitude -= (own @ moved.T[:, :, None])[:, :, 0].T
        by_amplitude[:, 1] -= response[1, :, -1] * (0.5 * given)
        return Balance(residual, by_x, self.packed(by_omega), self.packed(by_amplitude), force, by_q, by_v)

    def _coupling(
        self, slope_q: ComplexArray, slope_v: ComplexArray, omega: float
    ) -> tuple[ComplexArray, ComplexArray]:
        """(n_ports, H + 1, H + 1) twice: harmonics of the force by those of the motion, and by their conjugates."""
        apart, together = self._places
        turn = 1j * omega * self._orders

        def diagonal(slope: ComplexArray) -> ComplexArray:
            picked = slope[:, np.abs(apart)]
            return np.where(apart >= 0, picked, picked.conj())

        forth = diagonal(slope_q) + turn * diagonal(slope_v)
        back = slope_q[:, together] - turn * slope_v[:, together]
        back[:, :, 0] = 0.0
        return forth, back

    def _of_base(self, forth: ComplexArray, back: ComplexArray, first: complex) -> ComplexArray:
        """(n_ports, H + 1) harmonics of the force under a first harmonic of the base."""
        return np.asarray(self.drive.absolute[:, None] * (forth[:, :, 1] * first + back[:, :, 1] * np.conj(first)))

    def _real_slope(self, own: ComplexArray, forth: ComplexArray, back: ComplexArray) -> FloatArray:
        """(n, n) of x - H f over the packed unknowns; own: (H + 1, n_ports, n_ports) receptances."""
        shares = own.transpose(1, 2, 0)[:, :, :, None]
        plus, minus = shares * (forth + back), shares * (forth - back)
        n_ports, kept = plus.shape[0], plus.shape[2]
        slope = np.empty((n_ports, 2 * kept - 1, n_ports, 2 * kept - 1))
        for i in range(n_ports):
            for j in range(n_ports):
                block = slope[i, :, j, :]
                block[:kept, :kept], block[kept:, :kept] = -plus[i, j].real, -plus[i, j].imag[1:]
                block[:kept, kept:], block[kept:, kept:] = minus[i, j].imag[:, 1:], -minus[i, j].real[1:, 1:]
        flat = slope.reshape(self.n_unknowns, self.n_unknowns)
        flat[np.diag_indices_from(flat)] += 1.0
        return flat


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
