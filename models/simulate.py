"""From a plant and a record's excitation to the channels that the model predicts."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE, record_channels
from models.drive import Drive, drive_of
from models.effects.protocol import Measurement
from models.errors import DivergenceError, InputError
from models.modal import ModalModel, build_modal
from models.plant import Plant
from models.ports import Port
from models.propagator import Blocks, Step, exact_step, to_blocks
from models.record import Record
from models.rest import is_bilateral
from models.rig import Sensor
from models.stepping import march

STEP_RATE = 8192.0
"""Steps per second at least; the reference rig then is within 0.1 % of the converged solution (docs/theory.md)."""

CONTACT_RESOLUTION = 0.02
"""Largest k h^2 / (6 m) of a contact on the mass that it meets within a step."""

MAX_STEPS_PER_SAMPLE = 64

FORCE_TOLERANCE = 1e-9
"""Change of a port force that ends the iteration in a step, as a share of the excitation's peak and the forces at rest."""


@dataclass(frozen=True)
class Settings:
    """How finely the modal model is resolved; None chooses from the rig and the record.

    Attributes:
        n_modes: dynamic modes.
        steps_per_sample: steps of the integrator per sample of the record.
        trace: keep the motion of the ports and the forces there.
    """

    n_modes: int | None = None
    steps_per_sample: int | None = None
    trace: bool = False


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
    settings: Settings = Settings(),  # noqa: B008
    start: FloatArray | None = None,
    free: Mapping[str, float] | None = None,
) -> Response:
    """Predict a record's channels from its measured excitation.

    Args:
        plant: the rig with its effects.
        record: its excitation, rate, length and sensors are used, its responses are not.
        settings: resolution.
        start: (2n,) modal displacements and velocities at the first sample, from rest by default.
        free: the record's own parameters of effects that have some.

    Raises:
        DivergenceError: the motion left the finite numbers.
        InputError: a record that does not fit the plant.
    """
    plant = _at_record(plant, record)
    model = build_modal(plant, STOP_EDGE * record.fs, settings.n_modes)
    sensors = _sensors_of(plant, record)
    factor = settings.steps_per_sample or steps_per_sample(model, record.fs)
    system, step = _system(model, 1.0 / (factor * record.fs))
    drive = drive_of(record, plant, factor)
    fine, trace = _march(model, system, step, drive, record, factor, sensors, start, settings.trace)
    order = np.array([1.0 if s.quantity == "acceleration" else 0.0 for s in sensors])
    channels = record_channels(fine, factor, record.n_samples, record.fs, order)
    if drive.seen is not None:
        channels += np.stack([_seen_of_base(drive.seen, s) for s in sensors])
    measurement = Measurement(record.sensors, record.fs, free or {})
    for effect in plant.effects:
        channels = effect.change_channels(channels, measurement)
    return Response(channels, factor, model, trace)


def steps_per_sample(model: ModalModel, fs: float) -> int:
    """Steps per sample: enough for the band and for the stiffest contact on the mass it meets."""
    factor = max(1, int(np.ceil(STEP_RATE / fs)))
    if not model.plant.contacts:
        return factor
    stiffest = max(contact.law.stiffness for contact in model.plant.contacts)
    while factor < MAX_STEPS_PER_SAMPLE:
        _, step = _system(model, 1.0 / (factor * fs))
        rows = np.hstack([model.port_rows, np.zeros_like(model.port_rows)])
        if stiffest * np.abs(np.einsum("pk,pk->p", rows, _ports_part(step.end, model))).max() < CONTACT_RESOLUTION:
            break
        factor *= 2
    return factor


def _ports_part(inputs: FloatArray, model: ModalModel) -> FloatArray:
    return inputs[: len(model.ports)]


def _at_record(plant: Plant, record: Record) -> Plant:
    if record.excitation_position is None or plant.excitation is None:
        return plant
    return replace(plant, excitation=plant.excitation.model_copy(update={"position": record.excitation_position}))


def _sensors_of(plant: Plant, record: Record) -> tuple[Sensor, ...]:
    by_name = {sensor.name: sensor for sensor in plant.sensors}
    missing = [name for name in record.sensors if name not in by_name]
    if missing:
        raise InputError(
            f"{record.name}: sensor {missing[0]!r}", f"the rig has {', '.join(by_name)}", "rename the channel"
        )
    return tuple(by_name[name] for name in record.sensors)


def _system(model: ModalModel, h: float) -> tuple[Blocks, Step]:
    """Blocks and step of the model; inputs are the ports, then a force at the excitation, then the base."""
    excitation = model.plant.excitation
    place = excitation.position if excitation is not None and excitation.position is not None else None
    force = model.rows(place)
    inputs = np.column_stack([*model.port_rows, force, -model.carried])
    system = to_blocks(model.omega, model.damping, inputs, model.port_rows)
    return system, exact_step(system, h)


def _output_rows(model: ModalModel, system: Blocks, sensors: tuple[Sensor, ...]) -> FloatArray:
    """(n_sensors, 2n) velocity for accelerations and velocities, slope rate for gyroscopes, displacement."""
    back = np.linalg.inv(system.from_modal) if not _is_modal(system) else None
    rows = np.zeros((len(sensors), 2 * model.n))
    for i, sensor in enumerate(sensors):
        shape = model.rows(sensor.position, 1 if sensor.quantity == "angular_velocity" else 0)
        half = slice(None, model.n) if sensor.quantity == "displacement" else slice(model.n, None)
        rows[i, half] = shape
    return rows if back is None else rows @ back


def _is_modal(system: Blocks) -> bool:
    return np.array_equal(system.from_modal, np.eye(len(system.from_modal)))


def _seen_of_base(seen: FloatArray, sensor: Sensor) -> FloatArray:
    if sensor.quantity == "angular_velocity":
        return np.zeros_like(seen[0])
    return np.asarray(seen[("displacement", "velocity", "acceleration").index(sensor.quantity)])


def _march(  # noqa: PLR0913
    model: ModalModel,
    system: Blocks,
    step: Step,
    drive: Drive,
    record: Record,
    factor: int,
    sensors: tuple[Sensor, ...],
    start: FloatArray | None,
    keep_trace: bool,  # noqa: FBT001
) -> tuple[FloatArray, Trace | None]:
    """(n_sensors, M) motion read out at every step, and the trace."""
    n_ports, n_steps = len(model.ports), record.n_samples * factor - 1
    inputs, columns = _known_inputs(drive, n_ports)
    items = _Items.of(model)
    out = np.empty((n_steps + 1, len(sensors)))
    trace = np.empty((n_steps + 1 if keep_trace else 0, 2 * n_ports + len(items.port)))
    state = np.zeros(2 * model.n) if start is None else system.from_modal @ start
    peak = max((float(np.abs(row).max()) for row in inputs), default=0.0)
    scale = peak * (1.0 if drive.force is not None else float(np.linalg.norm(model.carried)) ** 2)
    tolerance = FORCE_TOLERANCE * (scale + float(np.abs(items.rest).sum())) or FORCE_TOLERANCE
    done = march(
        step.exponential, step.start[columns], step.end[columns], step.start[:n_ports], step.end[:n_ports],
        state, inputs, system.displacement, system.velocity, model.rest.position, drive.base_motion,
        np.array([1.0 if port.frame == "ground" else 0.0 for port in model.ports]),
        _output_rows(model, system, sensors), out, trace, n_steps, 1.0 / (factor * record.fs),
        items.port, items.law, items.rate, items.values, items.offsets, items.contacts, items.is_contact, items.rest,
        tolerance,
    )  # fmt: skip
    if done < n_steps:
        raise DivergenceError(
            f"{record.name}: the motion grew without bound {done / (factor * record.fs):.4f} s after the start; "
            "a passive structure stays finite; look for a negative stiffness or damping among the effects"
        )
    return np.ascontiguousarray(out.T), _trace_of(model, trace, factor * record.fs) if keep_trace else None


def _known_inputs(drive: Drive, n_ports: int) -> tuple[FloatArray, list[int]]:
    rows = [(n_ports, drive.force), (n_ports + 1, drive.base)]
    present = [(column, signal) for column, signal in rows if signal is not None]
    return np.stack([signal for _, signal in present]), [column for column, _ in present]


def _trace_of(model: ModalModel, trace: FloatArray, fs: float) -> Trace:
    n_ports, n_laws = len(model.ports), len(model.plant.laws)
    rows = trace.T
    forces = rows[2 * n_ports :]
    return Trace(fs, model.ports, rows[:n_ports], rows[n_ports : 2 * n_ports], forces[:n_laws], forces[n_laws:])


@dataclass(frozen=True, eq=False)
class _Items:
    """Point laws, then contacts, as the stepper's arrays (see ``stepping.march``)."""

    port: FloatArray
    law: FloatArray
    rate: FloatArray
    values: FloatArray
    offsets: FloatArray
    contacts: FloatArray
    is_contact: FloatArray
    rest: FloatArray

    @classmethod
    def of(cls, model: ModalModel) -> "_Items":
        from models.law import law_address

        plant = model.plant
        index = {port: i for i, port in enumerate(model.ports)}
        values: list[float] = []
        offsets: list[int] = []
        for numbers in (*(law.parameters for law in plant.laws), *(c.law.values for c in plant.contacts)):
            offsets.append(len(values))
            values.extend(numbers)
        laws = [law.force for law in plant.laws] + [c.law.normal_force for c in plant.contacts]
        rates = [law_address(law.rate) if law.rate is not None else 0 for law in plant.laws]
        contacts = [(c.clearance, c.offset, c.clearance_rate, float(is_bilateral(c))) for c in plant.contacts]
        return cls(
            port=np.array(
                [index[law.port] for law in plant.laws] + [index[Port(c.position)] for c in plant.contacts], np.int64
            ),
            law=np.array([law_address(law) for law in laws], np.int64),
            rate=np.array([*rates, *(0 for _ in plant.contacts)], np.int64),
            values=np.array(values, float),
            offsets=np.array(offsets, np.int64),
            contacts=np.array([(0.0,) * 4] * len(plant.laws) + contacts, float).reshape(-1, 4),
            is_contact=np.array([0] * len(plant.laws) + [1] * len(plant.contacts), np.int64),
            rest=np.concatenate([model.rest.law_forces, model.rest.contact_forces]),
        )
