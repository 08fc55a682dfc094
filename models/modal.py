"""The reduced modal model of a plant: a few modes, exact static flexibility at every port, and the state at rest."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import eigh

from models.arrays import FloatArray
from models.beam.assembly import BeamMatrices, assemble_beam, natural_modes, own_damping, solve_static
from models.errors import InputError
from models.plant import Plant
from models.ports import PointLaw, Port
from models.rest import RestState, find_rest
from models.structure import Structure

MIN_MODES = 10
"""Dynamic modes kept at least: 8 and the static shapes reach 0.02 % on the reference rig, strong dashpots in sleeves
need two more (docs/theory.md), and the stepper's lanes hold 16 for the price of 11."""

MOST_MODES = 100
"""Modes kept at most; a rig whose band holds more is not in SI units, or no rig for this model."""

BAND_MARGIN = 1.5
"""Modes are kept up to this many times the upper edge of the recorder's band."""

SPARE_MODES = 16
"""Clamped-free modes beyond those kept, from which modes of a changed beam are formed."""


Load = tuple[float, int]
"""Where a force bends the beam, m, and on which derivative of the deflection it acts."""


@dataclass(frozen=True, eq=False)
class Modes:
    """A linear structure in its modes: what stays as it is while only contacts and laws change.

    Attributes:
        omega, damping, carried: see ``ModalModel``.
        shapes: (n_ritz, n) in the columns, by the coordinates of ``matrices``, or of an oscillator and its absorbers.
        matrices: of a beam; None for an oscillator.
    """

    omega: FloatArray
    damping: FloatArray
    carried: FloatArray
    shapes: FloatArray = field(repr=False)
    matrices: BeamMatrices | None = field(repr=False)
    _rows: dict[tuple[float | None, int], FloatArray] = field(default_factory=dict, init=False, repr=False)

    def rows(self, position: float | None, derivative: int = 0) -> FloatArray:
        """(n,) displacement (slope, curvature) at a position by modal coordinate; an oscillator has one only."""
        row = self._rows.get((position, derivative))
        if row is None:
            row = self._rows[position, derivative] = self._row(position or 0.0, derivative)
            row.flags.writeable = False
        return row

    def port_rows(self, ports: Sequence[Port]) -> FloatArray:
        """(n_ports, n) motion of ports by modal coordinate."""
        if not ports:
            return np.empty((0, len(self.omega)))
        return np.stack([self.rows(port.position, port.derivative) for port in ports])

    def _row(self, position: float, derivative: int) -> FloatArray:
        if self.matrices is None:
            return np.array(self.shapes[0])
        return np.asarray(self.matrices.row(position, derivative) @ self.shapes)


@dataclass(frozen=True, eq=False)
class ModalModel:
    """Modal equations q'' + C q' + omega^2 q = forces at ports, about the state at rest.

    Attributes:
        plant: the rig with its effects.
        ports: where forces act: the point laws', then the contacts', each once.
        modes: of the structure without sleeves and point laws.
        rest: the state at rest under gravity.
    """

    plant: Plant
    ports: tuple[Port, ...]
    modes: Modes
    rest: RestState

    @property
    def omega(self) -> FloatArray:
        """(n,) natural circular frequencies of the structure without sleeves, rad/s, the static shapes' last."""
        return self.modes.omega

    @property
    def damping(self) -> FloatArray:
        """(n, n) modal damping matrix, 1/s; diagonal unless dashpots or springs are attached."""
        return self.modes.damping

    @property
    def carried(self) -> FloatArray:
        """(n,) modal inertia against a base acceleration, sqrt(kg)."""
        return self.modes.carried

    @property
    def n(self) -> int:
        """Modal coordinates."""
        return len(self.omega)

    def rows(self, position: float | None, derivative: int = 0) -> FloatArray:
        """(n,) displacement (slope, curvature) at a position by modal coordinate; an oscillator has one only."""
        return self.modes.rows(position, derivative)

    @cached_property
    def port_rows(self) -> FloatArray:
        """(n_ports, n) motion of the ports by modal coordinate."""
        return self.modes.port_rows(self.ports)

    def port_forces(self, rest: RestState) -> FloatArray:
        """(n_ports,) forces of laws and contacts together on the structure at rest, N.

        Args:
            rest: where the ports are.
        """
        ports = [*(law.port for law in self.plant.laws), *(Port(contact.position) for contact in self.plant.contacts)]
        total = np.zeros(len(self.ports))
        np.add.at(total, [self.ports.index(port) for port in ports], [*rest.law_forces, *rest.contact_forces])
        return total

    def rest_deflection(self, x: FloatArray) -> FloatArray:
        """(n,) deflection of the beam at rest, m, upwards from its unloaded axis.

        Args:
            x: (n,) m from the clamp.
        """
        return np.array([self._matrices.row(float(position)) @ self._bent for position in x])

    @cached_property
    def bending(self) -> FloatArray:
        """(n, n) share of the beam's own bending in the modal stiffness, 1/s^2: what a drift of E I changes."""
        return _tidy(self.modes.shapes.T @ self._matrices.bending @ self.modes.shapes)

    @cached_property
    def bending_at_rest(self) -> FloatArray:
        """(n,) modal force with which the beam's own bending resists the deflection at rest."""
        return np.asarray(self.modes.shapes.T @ (self._matrices.bending @ self._bent))

    @cached_property
    def _bent(self) -> FloatArray:
        """(n_ritz,) deflection at rest."""
        load = self._matrices.weight + self.port_forces(self.rest) @ _port_rows(self._matrices, self.ports)
        return solve_static(self._matrices.stiffness, load)

    @property
    def _matrices(self) -> BeamMatrices:
        assert self.modes.matrices is not None
        return self.modes.matrices


@lru_cache(maxsize=64)
def build_modal(plant: Plant, band: float, n_modes: int | None = None) -> ModalModel:
    """The modal model for motion up to a frequency, kept for the next record.

    Args:
        plant: the rig with its effects.
        band: highest frequency of interest, Hz, normally 0.43 fs.
        n_modes: dynamic modes to keep; by default those below ``BAND_MARGIN`` times the band, ``MIN_MODES`` at least.
    """
    ports = _ports(plant)
    if not plant.structure.is_beam:
        return _oscillator(plant, ports)
    named = [(port.position, port.derivative) for port in ports if not port.spread]
    if plant.excitation is not None:
        named.append((plant.excitation.position, 0))
    loads = tuple(sorted({(position, order) for position, order in named if position is not None}))
    kept = n_modes if n_modes is not None else modes_below(plant.structure, BAND_MARGIN * band)
    # A drift begins with the record: the beam of its start is the beam without it.
    modes = _modes_of_beam(replace(plant.structure, stiffness_rate=0.0), kept, loads)
    yielded = _yielded(modes, ports)
    plant = replace(plant, laws=_yielding(plant.laws, ports, yielded.flexibility))
    return ModalModel(plant, ports, modes, find_rest(plant, ports, yielded.sag, yielded.flexibility))


@lru_cache(maxsize=256)
def _modes_of_beam(structure: Structure, kept: int, loads: tuple[Load, ...]) -> Modes:
    """``kept`` modes and the residual shapes of ``loads``."""
    matrices = assemble_beam(structure, kept + SPARE_MODES, tuple(position for position, order in loads if order == 0))
    shapes, square = _reduce(matrices, kept, loads)
    damping = _tidy(shapes.T @ matrices.damping @ shapes)
    return Modes(np.sqrt(square), damping, shapes.T @ matrices.carried, shapes, matrices)


@dataclass(frozen=True, eq=False)
class _Yielded:
    """How a beam yields at its ports.

    Attributes:
        sag: (n_ports,) under its own weight without sleeves, m.
        flexibility: (n_ports, n_ports) displacement by force, m/N.
    """

    sag: FloatArray
    flexibility: FloatArray


@lru_cache(maxsize=256)
def _yielded(modes: Modes, ports: tuple[Port, ...]) -> _Yielded:
    matrices = modes.matrices
    assert matrices is not None
    rows = _port_rows(matrices, ports)
    sag = rows @ solve_static(matrices.stiffness, matrices.weight)
    return _Yielded(sag, rows @ solve_static(matrices.stiffness, rows.T))


def modes_below(structure: Structure, freq: float) -> int:
    """How many modes of the plain beam lie below a frequency, Hz, ``MIN_MODES`` at least."""
    radius = np.sqrt(structure.bending_stiffness / (structure.line_mass * structure.length**4))
    n = int(np.sqrt(2.0 * np.pi * freq / radius) / np.pi + 0.5)
    if n > MOST_MODES:
        raise InputError(
            f"structure: {n} modes of a beam of length = {structure.length:g} m, diameter = {structure.diameter:g} m "
            f"lie below {freq:.4g} Hz",
            f"the modal model keeps {MOST_MODES} at most",
            "see that the rig file is in m, Pa and kg/m^3, or ask for lower frequencies",
        )
    return max(MIN_MODES, n)


def _yielding(laws: Sequence[PointLaw], ports: Sequence[Port], flexibility: FloatArray) -> tuple[PointLaw, ...]:
    """The laws with what the model yields to them; all that it has is in its reduced coordinates too."""
    return tuple(law.yielding(float(flexibility[i, i])) for law in laws for i in [ports.index(law.port)])


def _ports(plant: Plant) -> tuple[Port, ...]:
    return tuple(dict.fromkeys([*(law.port for law in plant.laws), *(Port(c.position) for c in plant.contacts)]))


def _oscillator(plant: Plant, ports: tuple[Port, ...]) -> ModalModel:
    """All ports are on the first degree of freedom."""
    structure = plant.structure
    held = _held(structure)
    flexibility = 1.0 / held if held > 0.0 else 0.0
    sag = np.full(len(ports), -_inertia(structure).sum() * structure.gravity * flexibility)
    rest = find_rest(plant, ports, sag, np.full((len(ports), len(ports)), flexibility))
    return ModalModel(plant, ports, _modes_of_oscillator(structure), rest)


def _held(structure: Structure) -> float:
    """Stiffness of an oscillator against its base, N/m."""
    return structure.bending_stiffness + sum(k for _, k in structure.springs)


def _inertia(structure: Structure) -> FloatArray:
    """Masses of an oscillator and of its absorbers, kg."""
    own = structure.line_mass + sum(m for _, m in structure.masses)
    return np.array([own, *(absorber.mass for absorber in structure.absorbers)])


@lru_cache(maxsize=256)
def _modes_of_oscillator(structure: Structure) -> Modes:
    """One degree of freedom, then one per absorber that hangs on it."""
    n, inertia = 1 + len(structure.absorbers), _inertia(structure)
    own = np.array([[structure.line_mass if structure.loss_factor is None else inertia[0]]])
    stiffness, damping, first = np.zeros((n, n)), np.zeros((n, n)), np.eye(n)[0]
    stiffness[0, 0] = _held(structure)
    damping[0, 0] = own_damping(structure, own, np.array([[structure.bending_stiffness]]))[0, 0]
    damping[0, 0] += sum(c for _, c in structure.dashpots)
    for number, absorber in enumerate(structure.absorbers, start=1):
        spring, dashpot = absorber.coefficients
        stretch = np.eye(n)[number] - first
        stiffness += spring * np.outer(stretch, stretch)
        damping += dashpot * np.outer(stretch, stretch)
    square, shapes = eigh(stiffness, np.diag(inertia))
    shapes = _upwards(shapes, first)
    omega, damping = np.sqrt(np.maximum(square, 0.0)), _tidy(shapes.T @ damping @ shapes)
    return Modes(omega, damping, inertia @ shapes, shapes, None)


def _port_rows(matrices: BeamMatrices, ports: Sequence[Port]) -> FloatArray:
    rows = [matrices.row(port.position or 0.0, port.derivative) for port in ports]
    return np.stack(rows) if rows else np.empty((0, len(matrices.weight)))


def _reduce(matrices: BeamMatrices, kept: int, loads: tuple[Load, ...]) -> tuple[FloatArray, FloatArray]:
    """(n_ritz, n) mass-normalised modes and (n,) squared frequencies: the lowest ``kept``, then the residual shapes.

    The residual shapes are the static deflections under loads at the ports less what the kept modes give; the reduced
    eigenvalue problem keeps the flexibility there exact. A mode bends upwards at the clamp.
    """
    square, phi = natural_modes(matrices.stiffness, matrices.mass)
    phi = _upwards(phi, matrices.row(0.0, 2))
    if not loads:
        return phi[:, :kept], square[:kept]
    rows = np.stack([matrices.row(*load) for load in loads])
    rest, rest_square = phi[:, kept:], square[kept:]
    residual = (rest / rest_square) @ (rest.T @ rows.T)
    energy, direction = eigh(residual.T @ matrices.stiffness @ residual)
    keep = energy > RESIDUAL_DROP * energy[-1]
    residual = residual @ (direction[:, keep] / np.sqrt(energy[keep]))
    inertia, direction = eigh(residual.T @ matrices.mass @ residual)
    residual = residual @ (direction / np.sqrt(inertia))
    return np.hstack([phi[:, :kept], residual]), np.concatenate([square[:kept], 1.0 / inertia])


def _upwards(modes: FloatArray, row: FloatArray) -> FloatArray:
    """The modes with the sign that a row sees as positive: an eigenvector may have either.

    Without it a state, told mode by mode, would be another as soon as a number, an effect or the resolution changes.

    Args:
        modes: (n, n_modes) in the columns.
        row: (n,) displacement or curvature somewhere by the coordinates of the columns.
    """
    return modes * np.where(row @ modes < 0.0, -1.0, 1.0)


def _tidy(matrix: FloatArray) -> FloatArray:
    """Without the round-off that would make a proportional damping look coupled."""
    size = np.sqrt(np.abs(np.outer(np.diag(matrix), np.diag(matrix))))
    return np.where(np.abs(matrix) > COUPLING_ROUND_OFF * size, matrix, 0.0)


RESIDUAL_DROP = 1e-9
"""Residual shapes with a smaller share of the largest one's energy repeat another port."""

COUPLING_ROUND_OFF = 1e-9
