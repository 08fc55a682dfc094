"""The force that the model lacks where laws act, so that a person sees a dead zone, a loop or a drift.

Between the places where contacts and laws act the structure is linear and its input is measured. So the forces at the
places follow from the channels, whatever the law is; what is lacking is that force less what the model's law gives for
the motion which the same forces cause. With the model's own run as origin (its force and its motion at a place, its
channels), three equations hold:

    channels - model's channels = H_s d + free decays + noise       d: force that differs from the model's run, N
    motion - model's motion     = H_q d, from rest
    d = law(motion) - law(model's motion) + m                       m: the missing force, N

H is that of the structure without its sleeves (``free_beam``). They are solved by turns: the law's part is taken at
the last motion, m is the regularised force for what it leaves of the channels (``force_estimate``), and the motion is
formed anew. Where the noise hides a force, m is 0: it holds only the band in which it can be told, up to 0.35 fs at
most; from accelerometers, a constant force and a shift of the place at rest cannot be told. Half the contact's
stiffness is moved from the law to the structure, which changes no equation and makes the turns converge where the
motion is slow and accelerometers see nothing.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import fft

from identification.evaluate import Evaluator, TimeTarget, scored_spectrum
from identification.force_estimate import ForceEstimate
from identification.free_beam import FreeBeam, sensor_rows
from identification.hypothesis import Hypothesis
from identification.law_history import contact_along, law_along
from identification.result import MissingForce
from models.arrays import ComplexArray, FloatArray
from models.band_limit import raise_rate, record_channels
from models.effects.protocol import Measurement
from models.plant import Plant
from models.ports import PointLaw, Port
from models.simulate import Response, simulate

TURNS = 4
"""Turns between motion and missing force; later ones move the force by less than its noise."""


def missing_forces(evaluator: Evaluator, hypothesis: Hypothesis) -> tuple[MissingForce, ...]:
    """The force that a model lacks at each sleeve, other place of a law, or mass, in each time record.

    Args:
        evaluator: records, with the noise of each line.
        hypothesis: the calibrated model.

    Returns:
        one a record and place, records first; none for a beam on which no law acts.

    Raises:
        DivergenceError: the model's motion left the finite numbers.

    Source: the module's text; nothing but the definition of the missing force.
    """
    plant = _watched(hypothesis.plant())
    settings = replace(evaluator.settings, trace=True)
    found: list[MissingForce] = []
    for target in evaluator.timed:
        response = simulate(
            plant,
            hypothesis.at_zero(target.record),
            settings,
            hypothesis.starts.get(target.record.name),
            hypothesis.own.get(target.record.name),
        )
        if any(port.is_concentrated for port in response.model.ports):
            found.extend(_Run(target, response).missing_forces())
    return tuple(found)


def _watched(plant: Plant) -> Plant:
    """The plant, on an oscillator with a law of no force, so that the trace holds its motion in any case."""
    if plant.structure.is_beam:
        return plant
    return replace(plant, laws=(*plant.laws, PointLaw(Port(None), _no_force, ())))


def _no_force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG001
    return 0.0


class _Run:
    """One record beside the model's own run of it."""

    def __init__(self, target: TimeTarget, response: Response) -> None:
        assert response.trace is not None
        self.target, self.response, self.trace = target, response, response.trace
        self.model, self.record = response.model, target.record
        self.plant = self.model.plant
        self.places = tuple(dict.fromkeys(port.position for port in self.model.ports if port.is_concentrated))
        self.springs = np.array([self._spring(place) for place in self.places])
        self.beam = FreeBeam.of(self.model, self.places, self.springs, self.record.n_samples, self.record.fs)
        by_name = {sensor.name: sensor for sensor in self.plant.sensors}
        self.rows, self.order = sensor_rows(self.model, [by_name[name] for name in self.record.sensors])

    def missing_forces(self) -> list[MissingForce]:
        shapes, still = self.beam.shapes, np.zeros(len(self.places))
        estimate = self._estimate()
        gap = self.target.measured - scored_spectrum(self.response.channels)
        own = self._forces(self.trace.q, self.trace.v)
        by_law = np.zeros((len(self.places), self.record.n_samples))
        for _ in range(TURNS):
            left = gap - scored_spectrum(self._measured(self.beam.response(self.rows, self.order, by_law)))
            missing = estimate.force(left)
            moved = self.beam.response(shapes, still, by_law + missing)
            speed = self.beam.response(shapes, still + 1.0, by_law + missing)
            q, v = self._moved(self.trace.q, moved), self._moved(self.trace.v, speed)
            by_law = self._recorded(self._forces(q, v) - own) + self.springs[:, None] * moved
        at = [self._port(place) for place in self.places]
        q, v = self._recorded(q[at]), self._recorded(v[at])
        return [
            MissingForce(self._name(place), self.record.name, q[i], v[i], missing[i], self.record.fs)
            for i, place in enumerate(self.places)
        ]

    def _spring(self, place: float | None) -> float:
        """Half the contact's elastic force per deepest penetration; without a contact, what makes a slow mass turn."""
        q = self.trace.q[self._port(place)]
        for contact in self.plant.contacts:
            if contact.position == place:
                depth = max(float(np.abs(q - contact.offset).max()) - contact.clearance, SHALLOW * float(np.ptp(q)))
                return 0.5 * contact.law.elastic(depth) / depth
        slow = 2.0 * np.pi * LEAST_CYCLES / self.record.duration
        return float(np.sum(self.model.carried**2)) * slow**2

    def _port(self, place: float | None) -> int:
        """The port of a place whose motion is relative to the base, if there is one."""
        ports = [i for i, port in enumerate(self.model.ports) if port.is_concentrated and port.position == place]
        return min(ports, key=lambda i: self.model.ports[i].frame != "base")

    def _name(self, place: float | None) -> str:
        if place is None:
            return "mass"
        return next((c.sleeve for c in self.plant.contacts if c.position == place), f"{place:.3f} m")

    def _moved(self, own: FloatArray, moved: FloatArray) -> FloatArray:
        """(n_ports, M) the ports' motion: the model's own, and at the places the difference at the stepper's rate."""
        total = own.copy()
        for i, port in enumerate(self.model.ports):
            if port.is_concentrated:
                total[i] += raise_rate(moved[self.places.index(port.position)], self.response.steps_per_sample)
        return total

    def _forces(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """(n_places, M) force of all contacts and laws at the places, N, along a motion of the ports."""
        total = np.zeros((len(self.places), q.shape[1]))
        index, fs = {port: i for i, port in enumerate(self.model.ports)}, self.trace.fs
        for law in self.plant.laws:
            if law.port.is_concentrated:
                i = index[law.port]
                total[self.places.index(law.port.position)] += law_along(law, q[i], v[i], fs)
        for contact in self.plant.contacts:
            i = index[Port(contact.position)]
            total[self.places.index(contact.position)] += contact_along(contact, q[i], v[i], fs)
        return total

    def _recorded(self, fine: FloatArray) -> FloatArray:
        return record_channels(fine, self.response.steps_per_sample, self.record.n_samples, self.record.fs)

    def _estimate(self) -> ForceEstimate:
        n, lines = self.record.n_samples, self.target.measured.shape[1]
        frf = self.beam.frf(self.rows, self.order, n // 2 + 1)
        # The impulse stands in the middle, so that a change of the channels finds nothing at the record's ends.
        impulses = np.roll(fft.irfft(frf, n, axis=0), n // 2, axis=0)
        frf = np.stack([self._lines(impulses[:, :, i].T, lines, -(n // 2)) for i in range(len(self.places))], axis=2)
        decays = [self._lines(decay, lines) for decay in self.beam.decays(self.rows, self.order)]
        return ForceEstimate(frf, np.stack(decays, axis=2), n * self.target.density.T, n)

    def _lines(self, channels: FloatArray, lines: int, shift: int = 0) -> ComplexArray:
        """(lines, n_sensors) spectrum of channels as the measurement chain reads them, turned back by a shift."""
        return np.asarray(fft.rfft(np.roll(self._measured(channels), shift, axis=1), axis=1)[:, :lines].T)

    def _measured(self, channels: FloatArray) -> FloatArray:
        """(n_sensors, N) what the measurement chain makes of a difference of true channels."""
        measurement = Measurement(self.record.sensors, self.record.fs, {})
        nothing = np.zeros_like(channels)
        for effect in self.plant.effects:
            channels = effect.change_channels(channels, measurement)
            nothing = effect.change_channels(nothing, measurement)
        return channels - nothing


LEAST_CYCLES = 2.0
"""Cycles within the record of a mass that nothing but the moved spring holds; without it its motion has no spectrum."""

SHALLOW = 0.01
"""Least penetration, as a share of the motion, for the secant of a contact that never touches."""
