"""From a plant and a record's excitation to the channels that the model predicts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE, record_channels
from models.drive import Drive, drive_of
from models.effects.protocol import Measurement
from models.errors import DivergenceError, InputError
from models.marching import march_model
from models.memory import keep_freed_memory
from models.modal import ModalModel, Modes, build_modal
from models.plant import Plant
from models.ports import Port
from models.propagator import Blocks
from models.record import Record
from models.rig import Sensor

STEP_RATE = 6144.0
"""Steps per second at least; the reference rig then is within 0.06 % of the converged solution (docs/theory.md)."""

CONTACT_RESOLUTION = 0.02
"""Largest k h^2 / (6 m) of a contact on the mass that it meets within a step."""

MOST_STEPS, MOST_STEP_RATE = 64, 65536.0
"""Steps per sample at most, or as many as make so many a second of a record at a low rate."""

FORCE_TOLERANCE = 1e-9
"""Change of a force that ends the iteration in a step, as a share of the excitation's peak and the forces at rest."""

keep_freed_memory()  # for whatever simulates: a command, its workers, a notebook


@dataclass(frozen=True)
class Settings:
    """How finely the modal model is resolved; None chooses from the rig and the record.

    Attributes:
        n_modes: dynamic modes.
        steps_per_sample: steps of the integrator per sample of the record.
        trace: keep the motion of the ports and the forces there.
        times: as many steps, given or chosen, up to the most.
    """

    n_modes: int | None = None
    steps_per_sample: int | None = None
    trace: bool = False
    times: int = 1


@dataclass(frozen=True, eq=False)
class Trace:
    """Motion and forces at the ports, at every step.

    Attributes:
        fs: steps per second, Hz.
        ports: where.
        q, v: (n_ports, M) m and m/s, as the laws see them.
        law_forces: (n_laws, M) N.
        contact_forces: (n_contacts, M) N, positive upwards.
    """

    fs: float
    ports: tuple[Port, ...]
    q: FloatArray
    v: FloatArray
    law_forces: FloatArray
    contact_forces: FloatArray


@dataclass(frozen=True, eq=False)
class Motion:
    """How a structure moves about rest at one instant, whatever its modes.

    Attributes:
        positions: along the beam, m from the clamp; one, None, of an oscillator.
        displacement, velocity: (n_positions,) m and m/s.
    """

    positions: tuple[float | None, ...]
    displacement: FloatArray
    velocity: FloatArray


@dataclass(frozen=True, eq=False)
class Response:
    """What the model says the sensors read.

    Attributes:
        channels: (n_sensors, N) in the order of the record's sensors, SI.
        steps_per_sample: what was used.
        model: the modal model that moved.
        trace: motion and forces at the ports, if asked for.
    """

    channels: FloatArray
    steps_per_sample: int
    model: ModalModel
    trace: Trace | None


def simulate(
    plant: Plant,
    record: Record,
    settings: Settings = Settings(),
    start: FloatArray | Motion | None = None,
    free: Mapping[str, float] | None = None,
    zero: float = 0.0,
) -> Response:
    """Predict a record's channels from its measured excitation.

    Args:
        plant: the rig with its effects.
        record: its excitation, rate, length and sensors are used, its responses are not.
        settings: resolution.
        start: (2n,) modal displacements and velocities at the first sample, or how another model moves then; from rest
            by default.
        free: the record's own parameters of effects that have some.
        zero: what the excitation channel reads at rest, SI.

    Raises:
        DivergenceError: the motion left the finite numbers.
        InputError: a record that does not fit the plant.
    """
    plant = plant.driven_at(record.excitation_position)
    sensors = _sensors_of(plant, record)
    model, factor, load = _resolved(plant, record, settings, free or {}, zero)
    drive = drive_of(record, plant, factor, free or {}, zero)
    fine, trace = _march(model, drive, record, factor, sensors, start, FORCE_TOLERANCE * load, settings.trace)
    order = np.array([1.0 if s.quantity == "acceleration" else 0.0 for s in sensors])
    channels = record_channels(fine, factor, record.n_samples, record.fs, order)
    if drive.seen is not None:
        channels += np.stack([_seen_of_base(drive.seen, s) for s in sensors])
    measurement = Measurement(record.sensors, record.fs, free or {})
    for effect in plant.effects:
        channels = effect.change_channels(channels, measurement)
    return Response(channels, factor, model, trace)


def motion_at(
    plant: Plant,
    record: Record,
    sample: int,
    settings: Settings = Settings(),
    start: FloatArray | Motion | None = None,
    free: Mapping[str, float] | None = None,
    zero: float = 0.0,
) -> Motion:
    """How the structure moves at a sample of a record; laws may remember more than that.

    Args:
        plant: the rig with its effects.
        record: what drives it.
        sample: counted from 0.
        settings: resolution.
        start: at the first sample, from rest by default.
        free: the record's own parameters of effects that have some.
        zero: what the excitation channel reads at rest, SI.

    Raises:
        DivergenceError: the motion left the finite numbers before.
    """
    plant = plant.driven_at(record.excitation_position)
    model, factor, load = _resolved(plant, record, settings, free or {}, zero)
    drive, h = drive_of(record, plant, factor, free or {}, zero), 1.0 / (factor * record.fs)
    out, trace, everything = np.empty((2 * model.n, sample * factor + 1)), np.empty((0, 0)), np.eye(model.n)
    done = march_model(
        model, drive, h, STOP_EDGE * record.fs, _state_of(start, model),
        lambda system: np.vstack([system.displacement(everything), system.velocity(everything)]), out, trace,
        FORCE_TOLERANCE * load,
    )  # fmt: skip
    if done < sample * factor:
        raise DivergenceError(_lost(record, done * h))
    positions = _positions(model)
    rows = _rows_at(positions, model)
    return Motion(positions, rows @ out[: model.n, -1], rows @ out[model.n :, -1])


N_POSITIONS = 48
"""Along a beam at which its motion is told; the shortest wave of the kept modes spans several."""


def _lost(record: Record, after: float) -> str:
    return (
        f"{record.name}: the motion grew without bound {after:.4f} s after the start; "
        "a passive structure stays finite; look for a negative stiffness or damping among the effects"
    )


def _positions(model: ModalModel) -> tuple[float | None, ...]:
    structure = model.plant.structure
    if not structure.is_beam:
        return (None,)
    return tuple((np.arange(1, N_POSITIONS + 1) * structure.length / N_POSITIONS).tolist())


def modal_state(motion: Motion, plant: Plant, fs: float) -> FloatArray:
    """(2n,) modal displacements and velocities of a plant's model, as a record of this rate asks for, that moves so.

    Args:
        motion: of the structure.
        plant: the rig with its effects.
        fs: Hz.
    """
    return _state_moving_so(motion, build_modal(plant, STOP_EDGE * fs))


def _state_of(start: FloatArray | Motion | None, model: ModalModel) -> FloatArray | None:
    """(2n,) modal displacements and velocities of a model that starts so; None from rest."""
    if start is None:
        return None
    return _state_moving_so(start, model) if isinstance(start, Motion) else _resized(start, model.n)


def _state_moving_so(motion: Motion, model: ModalModel) -> FloatArray:
    both = np.stack([motion.displacement, motion.velocity])
    return np.asarray((both @ _inverse_rows(motion.positions, model).T).ravel())


@lru_cache(maxsize=16)
def _inverse_rows(positions: tuple[float | None, ...], model: ModalModel) -> FloatArray:
    """(n, n_positions) modal coordinates by displacement, kept for the next part of a record."""
    return np.asarray(np.linalg.pinv(_rows_at(positions, model), rcond=LEAST_SHAPE), np.float64)


def _rows_at(positions: Sequence[float | None], model: ModalModel) -> FloatArray:
    """(n_positions, n) displacement by modal coordinate."""
    return np.stack([model.rows(position) for position in positions])


LEAST_SHAPE = 1e-6
"""Shapes of the motion at its positions that are less than this of the largest are taken to be none."""


def _resolved(
    plant: Plant, record: Record, settings: Settings, free: Mapping[str, float], zero: float
) -> tuple[ModalModel, int, float]:
    """The model, its steps per sample, and the force that its forces are weighed against, N."""
    model = build_modal(plant, STOP_EDGE * record.fs, settings.n_modes)
    load = load_of(model, drive_of(record, plant, 1, free, zero))
    steps = settings.steps_per_sample or steps_per_sample(model, record.fs, load)
    return model, max(steps, min(settings.times * steps, most_steps(record.fs))), load


def most_steps(fs: float) -> int:
    """Steps per sample beyond which none are chosen, at a record's rate, Hz."""
    return max(MOST_STEPS, int(np.ceil(MOST_STEP_RATE / fs)))


def steps_per_sample(model: ModalModel, fs: float, load: float) -> int:
    """Steps per sample: enough for the band and for the stiffest contact on the mass it meets.

    Args:
        model: with its contacts.
        fs: rate of the record, Hz.
        load: force at which the contacts' slopes are taken, N.
    """
    factor = max(1, int(np.ceil(STEP_RATE / fs)))
    if not model.plant.contacts:
        return factor
    slope = np.array([contact.law.slope_under(load) for contact in model.plant.contacts])
    square = np.stack([model.rows(contact.position) for contact in model.plant.contacts]) ** 2
    most = most_steps(fs)
    while factor < most:
        if (slope * (square @ _yielding(model.omega, 1.0 / (factor * fs)))).max() < CONTACT_RESOLUTION:
            break
        factor = min(2 * factor, most)
    return factor


def _yielding(omega: FloatArray, h: float) -> FloatArray:
    """(n,) displacement at the end of a step under a unit force that grows in it from 0, 1 / (m N): h^2 / 6 if slow."""
    angle = np.maximum(omega * h, 1e-4)
    return np.asarray(h**2 * (1.0 - np.sin(angle) / angle) / angle**2)


def load_of(model: ModalModel, drive: Drive) -> float:
    """Peak of what drives the model, as a force, and the forces at rest, N; 1 where there is none of both."""
    force, base = drive.peaks
    peak = force + base * float(np.sum(model.carried**2))
    return peak + float(np.abs(model.rest.law_forces).sum() + np.abs(model.rest.contact_forces).sum()) or 1.0


def _sensors_of(plant: Plant, record: Record) -> tuple[Sensor, ...]:
    by_name = {sensor.name: sensor for sensor in plant.sensors}
    missing = [name for name in record.sensors if name not in by_name]
    if missing:
        raise InputError(
            f"{record.name}: sensor {missing[0]!r}", f"the rig has {', '.join(by_name)}", "rename the channel"
        )
    return tuple(by_name[name] for name in record.sensors)


def output_rows(model: ModalModel, system: Blocks, sensors: tuple[Sensor, ...]) -> FloatArray:
    """(n_sensors, 2n) velocity for accelerations and velocities, slope rate for gyroscopes, displacement.

    Args:
        model: that moves.
        system: its state.
        sensors: what is read.
    """
    return _output_rows(model.modes, system, tuple((sensor.position, sensor.quantity) for sensor in sensors))


@lru_cache(maxsize=256)
def _output_rows(modes: Modes, system: Blocks, seen: tuple[tuple[float | None, str], ...]) -> FloatArray:
    """The same, kept while only contacts, laws and records change, by place and quantity of each sensor."""
    shapes = [modes.rows(position, 1 if quantity == "angular_velocity" else 0) for position, quantity in seen]
    rows = np.reshape(shapes, (len(seen), len(modes.omega)))
    displaced = np.array([quantity == "displacement" for _, quantity in seen], np.bool_)
    found = np.where(displaced[:, None], system.displacement(rows), system.velocity(rows))
    found.flags.writeable = False
    return found


def _seen_of_base(seen: FloatArray, sensor: Sensor) -> FloatArray:
    if sensor.quantity == "angular_velocity":
        return np.zeros_like(seen[0])
    return np.asarray(seen[("displacement", "velocity", "acceleration").index(sensor.quantity)])


def _march(
    model: ModalModel,
    drive: Drive,
    record: Record,
    factor: int,
    sensors: tuple[Sensor, ...],
    start: FloatArray | Motion | None,
    tolerance: float,
    keep_trace: bool,  # noqa: FBT001
) -> tuple[FloatArray, Trace | None]:
    """(n_sensors, M) motion read out at every step, and the trace."""
    h, n_steps = 1.0 / (factor * record.fs), record.n_samples * factor - 1
    out, n_forces = np.empty((len(sensors), n_steps + 1)), len(model.plant.laws) + len(model.plant.contacts)
    trace = np.empty((n_steps + 1 if keep_trace else 0, 2 * len(model.ports) + n_forces))
    state = _state_of(start, model)
    done = march_model(
        model, drive, h, STOP_EDGE * record.fs, state, lambda system: output_rows(model, system, sensors),
        out, trace, tolerance,
    )  # fmt: skip
    if done < n_steps:
        raise DivergenceError(_lost(record, done * h))
    return out, _trace_of(model, trace, factor * record.fs) if keep_trace else None


def _resized(start: FloatArray, n: int) -> FloatArray:
    """(2n,) the state of a model with more or fewer static shapes, which rest at the start, from that of another."""
    state = np.zeros((2, n))
    known = start.reshape(2, -1)[:, :n]
    state[:, : known.shape[1]] = known
    return state.ravel()


def _trace_of(model: ModalModel, trace: FloatArray, fs: float) -> Trace:
    n_ports, n_laws = len(model.ports), len(model.plant.laws)
    rows = trace.T
    forces = rows[2 * n_ports :]
    return Trace(fs, model.ports, rows[:n_ports], rows[n_ports : 2 * n_ports], forces[:n_laws], forces[n_laws:])
