"""What the sensors of a plant would read, from the true excitation, by the fine discretisation."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE, record_channels
from models.effects.protocol import Measurement
from models.errors import DivergenceError
from models.fine.collocation import march
from models.fine.course import Course, applied_force, base_motion
from models.fine.desk import make_desk
from models.fine.drifting import Run, march_drifting
from models.fine.system import FineSystem, build_system
from models.fine.tables import make_tables
from models.plant import Plant
from models.point_forces import Stretch, compile_items
from models.rig import Sensor

FORCE_TOLERANCE = 1e-10
"""Where Newton's iteration ends, as a share of the largest excitation force and the forces at rest."""

BASE_ROW = {"displacement": 0, "velocity": 1, "acceleration": 2}


@dataclass(frozen=True)
class FineSettings:
    """How finely the truth is resolved.

    Attributes:
        n_elements: finite elements along the beam at least.
        steps_per_sample: whole steps per sample of the record; they are quartered further where a force is not smooth.
        bend_tolerance: how far a port's force may leave a straight line within a step, as a share of the largest
            excitation force and the forces at rest.
        free: the record's own parameters of effects that have some (a phase), by name.
    """

    n_elements: int = 40
    steps_per_sample: int = 16
    bend_tolerance: float = 0.01
    free: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion about the state at rest, at every whole step.

    Attributes:
        out: (n_out, M) what was read out.
        q, v, force: (n_ports, M) motion of the ports as the laws see it, and the force on the structure there.
        state: (2n,) at the end.
        n_steps: steps of any size taken.
    """

    out: FloatArray
    q: FloatArray
    v: FloatArray
    force: FloatArray
    state: FloatArray
    n_steps: int


def fine_response(
    plant: Plant,
    excitation: FloatArray,
    fs: float,
    settings: FineSettings = FineSettings(),
) -> FloatArray:
    """Simulate the channels of all sensors from rest.

    Args:
        plant: the rig with its effects. Those of the sensors and channels are applied; a change of the excitation's
            channel is not, since the excitation given here is the true one.
        excitation: (N,) true excitation at the record's rate, band-limited between samples; N, m/s^2, m/s or m.
        fs: sampling rate, Hz.
        settings: resolution.

    Returns:
        (n_sensors, N) in the order of ``plant.sensors``, SI, as recorded without noise.

    Raises:
        DivergenceError: the motion left the finite numbers.
        InputError: no state at rest is found, or an axial load buckles the beam.
    """
    system, factor = build_system(plant, settings.n_elements), settings.steps_per_sample
    force = applied_force(plant, excitation, fs, factor)
    base = base_motion(plant, excitation, fs, factor, settings.free)
    rows = np.stack([_sensor_row(system, sensor) for sensor in plant.sensors])
    h, bend = 1.0 / (fs * factor), settings.bend_tolerance
    motion = move(system, plant, force, base, h, rows, bend_tolerance=bend, band=STOP_EDGE * fs)
    order = np.array([1.0 if sensor.quantity == "acceleration" else 0.0 for sensor in plant.sensors])
    channels = record_channels(motion.out, factor, len(excitation), fs, order)
    if base.shape[1]:
        seen = record_channels(base[:3], factor, len(excitation), fs)
        for i, sensor in enumerate(plant.sensors):
            if sensor.quantity in BASE_ROW:
                channels[i] += seen[BASE_ROW[sensor.quantity]]
    measurement = Measurement(tuple(sensor.name for sensor in plant.sensors), fs, settings.free)
    for effect in plant.effects:
        channels = effect.change_channels(channels, measurement)
    return channels


def move(
    system: FineSystem,
    plant: Plant,
    force: FloatArray,
    base: FloatArray,
    h: float,
    rows: FloatArray,
    *,
    bend_tolerance: float = 0.01,
    start: FloatArray | None = None,
    trace: bool = False,
    band: float = inf,
) -> Motion:
    """March a system through a given course.

    Args:
        system: the plant discretised.
        plant: the same plant, for the place of the excitation.
        force: (2, M) force at the excitation and its time derivative, N and N/s.
        base: (4, M) of ``course.base_motion``, or (4, 0).
        h: whole step, s.
        rows: (n_out, 2n) what is read out of the state.
        bend_tolerance: see ``FineSettings``.
        start: (2n,) state to start from, about the state at rest; at rest by default.
        trace: keep the motion of the ports.
        band: highest frequency of interest, Hz, to which the segments of a stiffness that drifts are short enough.

    Raises:
        DivergenceError: the motion left the finite numbers.
    """
    n, n_ports = len(system.omega), len(system.ports)
    place = None if plant.excitation is None else plant.excitation.position
    inputs, known = [system.row(place)], [force]
    if base.shape[1]:
        inputs.append(-system.carried)
        known.append(base[2:])
    held = system.forces_at_rest()
    scale = float(np.abs(held).sum() + np.abs(force[0]).max())
    if base.shape[1]:
        scale += float(system.carried @ system.carried * np.abs(base[2]).max())
    drift = plant.structure.stiffness_rate
    if drift != 0.0:
        inputs.append(-system.bending_at_rest)
        known.append(np.stack([drift * h * np.arange(force.shape[1]), np.full(force.shape[1], drift)]))
    course = Course(
        inputs=np.stack([pair[0] for pair in known]),
        slopes=np.stack([pair[1] for pair in known]),
        base=base,
        absolute=np.array([0.0 if isinstance(p, Stretch) or p.frame == "base" else 1.0 for p in system.ports]),
        at_rest=system.port_rows @ system.rest,
        held=held,
        force_tolerance=FORCE_TOLERANCE * scale or FORCE_TOLERANCE,
        bend_tolerance=bend_tolerance * scale or bend_tolerance,
    )
    items = compile_items(system.forces, system.ports)
    state = np.zeros(2 * n) if start is None else start.copy()
    out, kept = np.empty((force.shape[1], len(rows))), np.empty((force.shape[1] if trace else 0, 3, n_ports))
    desk = make_desk(n, n_ports, len(system.forces), n_ports + len(inputs))
    if drift != 0.0:
        run = Run(system, plant.structure, course, np.stack(inputs), items, rows, h)
        done, taken = march_drifting(run, band, desk, state, out, kept)
    else:
        tables = make_tables(system.omega, system.damping, system.port_rows, np.stack(inputs), h)
        rows = np.ascontiguousarray(rows)
        done, taken = march(desk, tables, course, items, state, rows, out, kept, 0, len(out) - 1)
    if done < len(out) - 1:
        raise DivergenceError(
            f"the motion grew without bound {done * h:.4f} s after the start; a passive structure stays finite; "
            "look for a negative stiffness or damping among the effects"
        )
    q, v, forces = np.ascontiguousarray(kept.transpose(1, 2, 0))
    return Motion(np.ascontiguousarray(out.T), q, v, forces, state, taken)


def _sensor_row(system: FineSystem, sensor: Sensor) -> FloatArray:
    """(2n,) velocity for accelerations and velocities, rate of the slope, or displacement."""
    row = system.row(sensor.position, 1 if sensor.quantity == "angular_velocity" else 0)
    still = np.zeros_like(row)
    return np.concatenate([row, still] if sensor.quantity == "displacement" else [still, row])
