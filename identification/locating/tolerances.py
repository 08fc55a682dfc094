"""What the rig's toleranced numbers could do to the force balance of a record, at the motion that the channels tell.

A number changes the structure, and with it the response to all forces that act; or it changes a law, and with it the
force at its place along the motion. Both are taken at the motion and the forces that explain the channels, so that no
feedback through the sleeves is left in them. Forces on a slope, or spread along the beam, stay as they are.
"""

from dataclasses import dataclass, replace

import numpy as np

from identification.free_beam import FreeBeam, sensor_rows
from identification.hypothesis import Unknown, rig_unknowns
from identification.locating.beside import BesideRun
from models.arrays import ComplexArray, FloatArray
from models.band_limit import STOP_EDGE
from models.drive import drive_of
from models.modal import ModalModel, build_modal
from models.plant import Plant


@dataclass(frozen=True, eq=False)
class Tolerances:
    """Changes of a record's channels by one standard deviation of each number.

    Attributes:
        columns: (lines, n_sensors, n_numbers) what remains to be explained changes by, per standard deviation.
        at: (n_numbers,) where the calibration has put the numbers, in standard deviations from the given ones.
    """

    columns: ComplexArray
    at: FloatArray


def tolerances_of(run: BesideRun) -> Tolerances:
    """The columns of all toleranced numbers of the rig file for one record.

    Args:
        run: settled or not.
    """
    unknowns = rig_unknowns(run.hypothesis.rig)
    changed = _Changes(run)
    columns = [changed.by(unknown) for unknown in unknowns]
    shape = (run.target.measured.shape[1], len(run.record.sensors), 0)
    at = np.array([unknown.get(run.hypothesis) for unknown in unknowns])
    return Tolerances(np.stack(columns, axis=2) if columns else np.zeros(shape, complex), at)


class _Changes:
    """Changes about the motion of one record."""

    def __init__(self, run: BesideRun) -> None:
        self.run, settled = run, run.settled
        self.own = run.forces(run.plant, settled.q, settled.v)
        ports = [run.port_of(place) for place in run.places]
        rest = run.model.rest.position[ports]
        at_rest = run.forces(run.plant, run.model.rest.position[:, None], np.zeros((len(run.model.ports), 1)))
        slow = run.recorded(settled.q[ports] - rest[:, None]) if ports else np.zeros((0, run.record.n_samples))
        law = run.recorded(self.own - at_rest) if ports else slow
        self.inputs = np.vstack([law + run.springs[:, None] * slow + settled.missing, self._drive()])
        self.as_is = self._response(run.model)

    def by(self, unknown: Unknown) -> ComplexArray:
        """(lines, n_sensors) per unit of the unknown."""
        run, x = self.run, unknown.get(self.run.hypothesis)
        steps = (unknown.set(run.hypothesis, x + side * unknown.step) for side in (1.0, -1.0))
        moved = max(steps, key=lambda hypothesis: abs(unknown.get(hypothesis) - x))
        plant = moved.plant()
        laws = (*plant.laws, *run.plant.laws[len(plant.laws) :])
        plant = replace(plant, laws=laws, excitation=run.plant.excitation)
        model = build_modal(plant, STOP_EDGE * run.record.fs, run.n_modes)
        change = np.zeros_like(self.as_is)
        if plant.structure != run.plant.structure:
            change += self._response(model) - self.as_is
        if run.places:
            change += run.beam.response(run.rows, run.order, self._law(plant, model))
        return np.asarray(run.read(change).T / (unknown.get(moved) - x))

    def _law(self, plant: Plant, model: ModalModel) -> FloatArray:
        """(n_places, N) change of the forces about rest along the motion, N; the rest moves with the numbers."""
        run, q = self.run, self.run.settled.q
        shift = (model.rest.position - run.model.rest.position)[:, None]
        still = np.zeros((len(model.ports), 1))
        rests = (run.forces(p, m.rest.position[:, None], still) for p, m in ((plant, model), (run.plant, run.model)))
        new, old = rests
        return run.recorded(run.forces(plant, q + shift, run.settled.v) - self.own - new + old)

    def _drive(self) -> FloatArray:
        """(2, N) the excitation's force, N, and the base's acceleration, m/s^2."""
        run, signals = self.run, np.zeros((2, self.run.record.n_samples))
        record = run.hypothesis.at_zero(run.record)
        if record.excitation is not None and self._is_pushed:
            signals[0] = record.excitation
            for effect in run.plant.effects:
                signals[0] = effect.change_excitation(signals[0])
        seen = drive_of(record, run.plant, 1, run.hypothesis.own.get(record.name, {})).seen
        if seen is not None:
            signals[1] = seen[2]
        return signals

    @property
    def _is_pushed(self) -> bool:
        excitation = self.run.plant.excitation
        return excitation is not None and excitation.quantity == "force"

    def _response(self, model: ModalModel) -> FloatArray:
        """(n_sensors, N) response of a structure to all forces."""
        run, named = self.run, {sensor.name: sensor for sensor in self.run.plant.sensors}
        beam = FreeBeam.of(model, run.places, run.springs, run.record.n_samples, run.record.fs)
        excitation = model.plant.excitation
        driven = model.rows(excitation.position) if excitation is not None and self._is_pushed else np.zeros(model.n)
        shapes = np.vstack([beam.shapes, driven, -model.carried])
        rows, order = sensor_rows(model, [named[name] for name in run.record.sensors])
        start = run.hypothesis.starts.get(run.record.name)
        return beam.acting_at(shapes).response(rows, order, self.inputs, start)
