"""The model linearised at rest: what FRFs and mode shapes of small motion about the state at rest see.

Contacts that are closed at rest and point laws act with their tangents there; open contacts do not act. From one level
of such data no nonlinearity can be seen.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.band_limit import recorder_gain
from models.drive import ORDER
from models.effects.protocol import Measurement
from models.errors import InputError
from models.modal import ModalModel
from models.plant import Plant
from models.ports import Contact, PointLaw, Port
from models.rest import is_bilateral
from models.rig import Sensor

NUDGE = 1e-9
"""Half the difference from which tangents are formed, m, m/s and 1: small beside any clearance and slip velocity."""

LEAST_TURN = 1e-9
"""Share of the imaginary part below which an eigenvalue belongs to a motion that creeps back and does not oscillate."""

LINES_AT_ONCE = 1024
"""Frequency lines solved together, to bound the memory."""

CHAIN_SAMPLES, CHAIN_RATE = 256, 4.0
"""Length of the impulse that is sent through the measurement chain, and its rate in units of the highest frequency."""


@dataclass(frozen=True)
class Tangent:
    """A point law or a contact for small motion about rest.

    Attributes:
        owner: the effect's label or the sleeve's name.
        port: where.
        stiffness: -dF/dq, N/m, what hysteresis adds included.
        damping: -dF/dv, N s/m.
    """

    owner: str
    port: Port
    stiffness: float
    damping: float


@dataclass(frozen=True, eq=False)
class Linearised:
    """q'' + C q' + K q = forces, in the coordinates of the modal model.

    Attributes:
        model: what was linearised.
        stiffness: (n, n) K, 1/s^2.
        damping: (n, n) C, 1/s.
        tangents: the point laws', then the contacts'; 0 where a contact is open.
    """

    model: ModalModel
    stiffness: FloatArray
    damping: FloatArray
    tangents: tuple[Tangent, ...]


@dataclass(frozen=True, eq=False)
class NaturalModes:
    """Modes of small free motion about rest.

    Attributes:
        natural_freqs: (n_modes,) |lambda| / (2 pi), Hz.
        damping_ratios: (n_modes,) -Re(lambda) / |lambda|.
        shapes: (n_modes, n_sensors) displacement (slope for an angular sensor), the largest 1.
    """

    natural_freqs: FloatArray
    damping_ratios: FloatArray
    shapes: ComplexArray


def linearised(model: ModalModel) -> Linearised:
    """The modal model with every contact and point law replaced by its tangent at rest, at the record's start.

    Args:
        model: with its state at rest.
    """
    plant = model.plant
    place = dict(zip(model.ports, model.rest.position.tolist(), strict=True))
    tangents = (
        *(_law_tangent(law, place[law.port]) for law in plant.laws),
        *(_contact_tangent(contact, place[Port(contact.position)]) for contact in plant.contacts),
    )
    stiffness, damping = np.diag(model.omega**2), model.damping.copy()
    for tangent in tangents:
        row = model.port_rows[model.ports.index(tangent.port)]
        stiffness += tangent.stiffness * np.outer(row, row)
        damping += tangent.damping * np.outer(row, row)
    return Linearised(model, stiffness, damping, tangents)


def _law_tangent(law: PointLaw, q: float) -> Tangent:
    def force(dq: float = 0.0, v: float = 0.0, z: float = 0.0) -> float:
        return law.force(0.0, q + dq, v, z, law.parameters)

    stiffness = -(force(dq=NUDGE) - force(dq=-NUDGE)) / (2 * NUDGE)
    damping = -(force(v=NUDGE) - force(v=-NUDGE)) / (2 * NUDGE)
    if law.rate is not None:
        # dz = (d rate / d v) v dt, so z follows q, and the force of z is a spring's.
        forth, back = (law.rate(0.0, q, v, 0.0, law.parameters) for v in (NUDGE, -NUDGE))
        stiffness -= (force(z=NUDGE) - force(z=-NUDGE)) / (2 * NUDGE) * (forth - back) / (2 * NUDGE)
    return Tangent(law.owner, law.port, stiffness, damping)


def _contact_tangent(contact: Contact, q: float) -> Tangent:
    port, penetration = Port(contact.position), abs(q - contact.offset) - contact.clearance
    if penetration <= 0 and not is_bilateral(contact):
        return Tangent(contact.sleeve, port, 0.0, 0.0)

    def normal(dp: float = 0.0, rate: float = 0.0) -> float:
        return contact.law.normal_force(0.0, max(penetration, NUDGE) + dp, rate, 0.0, contact.law.values)

    stiffness = (normal(dp=NUDGE) - normal(dp=-NUDGE)) / (2 * NUDGE)
    damping = (normal(rate=NUDGE) - normal(rate=-NUDGE)) / (2 * NUDGE)
    return Tangent(contact.sleeve, port, stiffness, damping)


def natural_modes(linear: Linearised, sensors: Sequence[Sensor], highest: float) -> NaturalModes:
    """Natural frequencies, damping ratios and complex shapes of the modes that oscillate.

    Args:
        linear: the linearised model.
        sensors: where the shapes are wanted.
        highest: frequency up to which modes are wanted, Hz, within the model's band.
    """
    n = linear.model.n
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-linear.stiffness, -linear.damping]])
    value, vector = np.linalg.eig(system)
    wanted = (value.imag > LEAST_TURN * np.abs(value)) & (np.abs(value) <= 2 * np.pi * highest)
    chosen = np.flatnonzero(wanted)[np.argsort(np.abs(value[wanted]))]
    shapes = (sensor_rows(linear.model, sensors) @ vector[:n, chosen]).T
    size = np.abs(value[chosen])
    return NaturalModes(size / (2 * np.pi), -value[chosen].real / size, _with_largest_one(shapes))


def _with_largest_one(shapes: ComplexArray) -> ComplexArray:
    """Each row divided by its largest entry, unless there is no sensor or none moves."""
    if shapes.shape[1] == 0:
        return shapes
    largest = np.take_along_axis(shapes, np.abs(shapes).argmax(axis=1, keepdims=True), axis=1)
    return np.asarray(shapes / np.where(largest == 0, 1.0, largest))


def frf(
    linear: Linearised, frequency: FloatArray, sensors: Sequence[str], position: float | None = None
) -> ComplexArray:
    """FRFs as the channels read them, from the excitation's channel: sensor quantity per excitation quantity.

    An accelerometer under a force gives the accelerance, a displacement sensor the receptance, and with a driven base
    an accelerometer the transmissibility of the absolute acceleration.

    Args:
        linear: the linearised model.
        frequency: (n_freq,) Hz, within the model's band; above 0 where the base is driven.
        sensors: names of the rig's sensors.
        position: where the force acts, m from the clamp; by default where the rig says.

    Returns:
        (n_sensors, n_freq), SI.

    Raises:
        InputError: the rig has no excitation.
    """
    plant = linear.model.plant
    excitation = plant.excitation
    if excitation is None:
        raise InputError(
            "a rig without excitation", "an FRF needs to know what excites the rig", "add [excitation] to the rig file"
        )
    named = {sensor.name: sensor for sensor in plant.sensors}
    chosen = [named[name] for name in sensors]
    turn = 2j * np.pi * np.asarray(frequency, float)
    order = np.array([ORDER_READ[sensor.quantity] for sensor in chosen])
    if excitation.quantity == "force":
        place = excitation.position if position is None else position
        load = np.repeat(linear.model.rows(place)[:, None], len(turn), axis=1).astype(complex)
        motion = sensor_rows(linear.model, chosen) @ _solve(linear, turn, load)
        driven = 0
    else:
        motion = sensor_rows(linear.model, chosen) @ _solve(linear, turn, _base_load(linear, turn))
        motion[[sensor.quantity != "angular_velocity" for sensor in chosen]] += 1.0
        driven = ORDER[excitation.quantity]
    read: ComplexArray = turn[None, :] ** (order[:, None] - driven) * measurement_chain(plant, sensors, frequency)
    return motion * read


ORDER_READ = {"displacement": 0, "velocity": 1, "angular_velocity": 1, "acceleration": 2}
"""How often a sensor's quantity is the derivative of the deflection, or of the slope."""


def sensor_rows(model: ModalModel, sensors: Sequence[Sensor]) -> FloatArray:
    """(n_sensors, n) displacement, or slope for an angular sensor, by modal coordinate."""
    rows = [model.rows(s.position, 1 if s.quantity == "angular_velocity" else 0) for s in sensors]
    return np.stack(rows) if rows else np.empty((0, model.n))


def _base_load(linear: Linearised, turn: ComplexArray) -> ComplexArray:
    """(n, n_freq) modal force per unit displacement of the base: inertia, and laws that read absolute motion."""
    load = -np.outer(linear.model.carried, turn**2)
    for tangent in linear.tangents:
        if tangent.port.frame == "ground":
            row = linear.model.port_rows[linear.model.ports.index(tangent.port)]
            load -= np.outer(row, tangent.stiffness + turn * tangent.damping)
    return load


def _solve(linear: Linearised, turn: ComplexArray, load: ComplexArray) -> ComplexArray:
    """(n, n_freq) modal motion under (n, n_freq) modal forces at i omega = ``turn``."""
    motion = np.empty_like(load, dtype=complex)
    for start in range(0, len(turn), LINES_AT_ONCE):
        part = slice(start, start + LINES_AT_ONCE)
        s = turn[part, None, None]
        dynamic = s**2 * np.eye(linear.model.n) + s * linear.damping + linear.stiffness
        motion[:, part] = np.linalg.solve(dynamic, load.T[part, :, None])[..., 0].T
    return motion


def measurement_chain(plant: Plant, sensors: Sequence[str], frequency: FloatArray) -> ComplexArray:
    """What the channels read per unit truth, times the true excitation per unit read: gains, delays, inverted sensors.

    Args:
        plant: whose effects act on channels.
        sensors: names of the channels.
        frequency: (n_freq,) Hz.

    Returns:
        (n_sensors, n_freq), from the answer of the chain to an impulse; what it adds without input (a hum) is no FRF.
    """
    chain = np.ones((len(sensors), len(frequency)), complex)
    if not plant.effects:
        return chain
    fs = CHAIN_RATE * float(np.max(frequency))
    # As a recorder would have it: an impulse of all frequencies would ring without end once it is delayed.
    freq = np.asarray(np.arange(CHAIN_SAMPLES // 2 + 1) * (fs / CHAIN_SAMPLES), np.float64)
    gain = recorder_gain(freq, fs)
    impulse = np.roll(np.fft.irfft(gain, CHAIN_SAMPLES), CHAIN_SAMPLES // 2)

    def spectrum(signal: FloatArray) -> ComplexArray:
        late = np.flatnonzero(np.any(np.atleast_2d(signal), axis=0))
        kernel = np.exp(-2j * np.pi * np.outer(late - CHAIN_SAMPLES // 2, frequency) / fs)
        return np.asarray(signal[..., late] @ kernel)

    given = spectrum(impulse)
    for effect in plant.effects:
        measurement = Measurement(tuple(sensors), fs, dict.fromkeys(effect.record_parameters, 0.0))
        sent = np.tile(impulse, (len(sensors), 1))
        read = effect.change_channels(sent, measurement) - effect.change_channels(np.zeros_like(sent), measurement)
        chain *= spectrum(read) / given
        chain *= spectrum(effect.change_excitation(impulse.copy())) / given
    return chain
