"""The reduced modal model, as one simulator among the others."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.integrate import cumulative_simpson, cumulative_trapezoid

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE
from models.drive import Drive, true_drive
from models.errors import DivergenceError, InputError
from models.linear import linearised, sensor_rows
from models.marching import march_model
from models.modal import ModalModel, build_modal
from models.plant import Plant
from models.rest import find_rest
from models.simulate import FORCE_TOLERANCE, load_of, steps_per_sample
from models.simulators.driving import driven
from models.simulators.protocol import EnergyBalance, Hold, Motion, Resolution, Simulator, Trial, of_the_chain
from models.simulators.recorded import Steps, recorded
from models.step_tables import items_of


class Modal(Simulator):
    """Modes and static shapes, stepped with the exact exponential of the linear part."""

    name: ClassVar[str] = "modal"
    source: ClassVar[str] = "docs/theory.md, sections 2 to 5"

    def cannot_carry(self, plant: Plant, resolution: Resolution) -> tuple[str, ...]:  # noqa: ARG002
        """No effect: the library is written for it; but it moves in the plane, as a thin rod."""
        return (*(("motion in space",) if resolution.spatial else ()), *of_the_chain(resolution))

    def natural_freqs(self, plant: Plant, n: int, resolution: Resolution) -> FloatArray:
        """(n,) Hz; by default with twice as many modes."""
        square = np.linalg.eigvalsh(linearised(build_modal(plant, 0.0, resolution.n_parts or 2 * n)).stiffness)
        return np.asarray(np.sqrt(square[:n]) / (2.0 * np.pi))

    def carry_out(self, plant: Plant, trial: Trial, resolution: Resolution) -> Motion:
        """One test."""
        plant = plant.driven_at(trial.position)
        model = build_modal(plant, STOP_EDGE * trial.fs, resolution.n_parts)
        load = load_of(model, true_drive(trial.excitation, trial.fs, plant, 1, trial.free))
        factor = resolution.steps_per_sample or steps_per_sample(model, trial.fs, load)
        choices = (
            f"{model.n} modes and static shapes" + ("" if resolution.n_parts else AUTO_MODES),
            f"steps of {1e6 / (trial.fs * factor):.3g} us, {factor} per sample"
            + ("" if resolution.steps_per_sample else AUTO_STEP),
        )
        return recorded(
            plant, trial, factor, _moved(model, trial, factor, FORCE_TOLERANCE * load), model.ports, choices
        )


AUTO_MODES = ": all modes below one and a half times the record's band"
AUTO_STEP = ": 6,144 steps per second, more where a contact is stiff for the mass that it meets"


@dataclass(frozen=True, eq=False)
class _Traced:
    """Modal coordinates and their speeds, (n, M) each, and what the ports did."""

    q: FloatArray
    v: FloatArray
    place: FloatArray
    speed: FloatArray
    forces: FloatArray


def _moved(model: ModalModel, trial: Trial, factor: int, tolerance: float) -> Steps:
    plant, h = model.plant, 1.0 / (trial.fs * factor)
    drive = true_drive(trial.excitation, trial.fs, plant, factor, trial.free)
    traced = _marched(model, drive, trial, factor, tolerance)
    force, base = driven(plant, trial, factor)
    at_force = model.rows(None if plant.excitation is None else plant.excitation.position)
    power = force * (at_force @ traced.v)
    if base.shape[1]:
        power -= base[2] * (model.carried @ traced.v)
    items = items_of(model)
    absolute = np.array([port.frame == "ground" for port in model.ports])[items.port]
    moved, speed = traced.place[items.port] - model.rest.position[items.port, None], traced.speed[items.port]
    if base.shape[1]:
        moved, speed = moved - absolute[:, None] * base[0], speed - absolute[:, None] * base[1]
    stored = 0.5 * np.sum(traced.v**2 + (model.omega[:, None] * traced.q) ** 2, axis=0)
    at, loss = slice(None, None, factor), np.asarray(-np.sum(traced.forces * speed, axis=0), float)
    if plant.structure.stiffness_rate != 0.0:
        loss += plant.structure.stiffness_rate * h * np.arange(len(loss)) * _resisted(model, traced)
    return Steps(
        read=sensor_rows(model, plant.sensors) @ traced.q,
        motion=traced.place,
        forces=traced.forces,
        energy=EnergyBalance(
            stored=(stored + items.rest_force @ moved)[at],
            supplied=cumulative_simpson(power, dx=h, initial=0.0)[at],
            damped=cumulative_simpson(np.sum(traced.v * (model.damping @ traced.v), axis=0), dx=h, initial=0.0)[at],
            taken=cumulative_trapezoid(loss, dx=h, initial=0)[at],
        ),
    )


def _resisted(model: ModalModel, traced: _Traced) -> FloatArray:
    """(M,) power that the beam's own bending takes, were it twice as stiff, beyond what it takes at the start, W."""
    strained = model.bending @ (traced.q + model.plant.structure.viscosity * traced.v)
    return np.asarray(np.sum(traced.v * (strained + model.bending_at_rest[:, None]), axis=0))


def _marched(model: ModalModel, drive: Drive, trial: Trial, factor: int, tolerance: float) -> _Traced:
    n_ports, n, n_samples, hold = len(model.ports), model.n, trial.n_samples * factor, trial.hold
    h = 1.0 / (trial.fs * factor)
    out = np.empty((2 * n, n_samples))
    trace = np.empty((n_samples, 2 * n_ports + len(model.plant.laws) + len(model.plant.contacts)))
    start = np.zeros(2 * n) if hold is None else np.append(held(model, hold), np.zeros(n))
    done = march_model(
        model, drive, h, STOP_EDGE * trial.fs, start,
        lambda system: np.vstack([system.displacement(np.eye(n)), system.velocity(np.eye(n))]),
        out, trace, tolerance,
    )  # fmt: skip
    if done < n_samples - 1:
        raise DivergenceError(
            f"modal: the motion grew without bound {done * h:.4f} s after the start; "
            "a passive structure stays finite; look for a negative stiffness or damping among the effects"
        )
    places = trace.T
    return _Traced(out[:n], out[n:], places[:n_ports], places[n_ports : 2 * n_ports], places[2 * n_ports :])


def held(model: ModalModel, hold: Hold) -> FloatArray:
    """(n,) modal coordinates, from rest, of the model that a static force holds besides.

    Args:
        model: with its contacts and laws.
        hold: where and how hard.

    Raises:
        InputError: a structure that does not resist, or no state at rest.
    """
    if not np.all(model.omega > 0.0):
        raise InputError(
            f"a hold of {hold.force:g} N on a structure without stiffness",
            "a static force deflects a structure that resists",
            "leave the hold out or give the structure a stiffness",
        )
    yielding = model.port_rows / model.omega**2
    flexibility, reach = yielding @ model.port_rows.T, model.rows(hold.position)
    at_rest = model.port_forces(model.rest)
    free = model.rest.position - flexibility @ at_rest + yielding @ reach * hold.force
    change = model.port_forces(find_rest(model.plant, model.ports, free, flexibility)) - at_rest
    return np.asarray((model.port_rows.T @ change + reach * hold.force) / model.omega**2)
