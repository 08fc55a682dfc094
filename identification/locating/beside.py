"""A record beside the model's own run of it: the motion at the places of laws, and what their forces leave unexplained.

Between the places where contacts and laws act the structure is linear and its input is measured. So the forces at the
places follow from the channels, whatever the law is. With the model's own run as origin (its force and its motion at a
place, its channels), three equations hold:

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
from dataclasses import dataclass, replace

import numpy as np

from identification.evaluate import Evaluator, TimeTarget, scored_spectrum
from identification.evidence import LEAST_EVIDENCE
from identification.force_estimate import ForceEstimate
from identification.free_beam import FreeBeam, sensor_rows
from identification.hypothesis import Hypothesis
from identification.law_history import contact_along, law_along
from models.arrays import ComplexArray, FloatArray
from models.band_limit import raise_rate, record_channels
from models.computed_once import computed_once
from models.effects.protocol import Measurement
from models.plant import Plant
from models.ports import PointLaw, Port
from models.simulate import Response

TURNS = 4
"""Turns between motion and missing force; later ones move the force by less than its noise. Where no force is told at
first there is none: a law would answer to the noise of the motion, and the force to that."""

RUN_AWAY = 30.0
"""Times as far as the model moves its places, beyond which a missing force is none: 26 kN came out where 20 N drove."""

UNHEARD = 1e12
"""Times its noise, with which a channel says nothing."""


@dataclass(frozen=True, eq=False)
class Settled:
    """What the turns between motion and missing force end with.

    Attributes:
        q, v: (n_ports, M) motion of the ports at the stepper's rate, m and m/s.
        by_law: (n_places, N) force of the laws beyond that in the model's own run, and of the moved springs, N.
        missing: (n_places, N) N.
        left: (n_sensors, lines) spectrum that the laws leave of the channels.
        estimate: of the missing force, which knows its uncertainty; None where no law acts.
    """

    q: FloatArray
    v: FloatArray
    by_law: FloatArray
    missing: FloatArray
    left: ComplexArray
    estimate: ForceEstimate | None


def runs_beside(
    evaluator: Evaluator, hypothesis: Hypothesis, probe: float | None = None, unheard: str | None = None
) -> list["BesideRun"]:
    """Every time record beside the model's own run of it.

    Args:
        evaluator: records, with the noise of each line.
        hypothesis: the calibrated model.
        probe: a position where no law acts but a force is looked for, m from the clamp.
        unheard: a channel that is not listened to.

    Raises:
        DivergenceError: the model's motion left the finite numbers.
    """
    plant = watched(hypothesis.plant(), probe)
    settings = replace(evaluator.settings, trace=True)
    return [
        BesideRun(target, hypothesis.simulated(target.record, settings, plant), hypothesis, settings.n_modes, unheard)
        for target in evaluator.timed
    ]


def watched(plant: Plant, probe: float | None = None) -> Plant:
    """The plant with a law of no force at a position, on an oscillator at its mass, so that the trace holds its motion.

    Args:
        plant: of a hypothesis.
        probe: m from the clamp; None for none.
    """
    if plant.structure.is_beam and probe is None:
        return plant
    return replace(plant, laws=(*plant.laws, PointLaw(Port(probe), _no_force, ())))


def _no_force(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG001
    return 0.0


class BesideRun:
    """One record beside the model's own run of it.

    Args:
        target: the record.
        response: the model's, with its trace.
        hypothesis: the model.
        n_modes: dynamic modes asked for.
        unheard: a channel that is not listened to.
    """

    def __init__(
        self,
        target: TimeTarget,
        response: Response,
        hypothesis: Hypothesis,
        n_modes: int | None = None,
        unheard: str | None = None,
    ) -> None:
        assert response.trace is not None
        self.target, self.response, self.trace = target, response, response.trace
        self.hypothesis, self.n_modes, self.unheard = hypothesis, n_modes, unheard
        self.model, self.record = response.model, target.record
        self.plant = self.model.plant
        self.places = tuple(dict.fromkeys(port.position for port in self.model.ports if port.is_concentrated))
        self.springs = np.array([self._spring(place) for place in self.places])
        self.beam = FreeBeam.of(self.model, self.places, self.springs, self.record.n_samples, self.record.fs)
        by_name = {sensor.name: sensor for sensor in self.plant.sensors}
        self.rows, self.order = sensor_rows(self.model, [by_name[name] for name in self.record.sensors])
        self.gap = target.measured - target.spectrum(response.channels)

    @computed_once
    def settled(self) -> Settled:
        """The motion that the channels tell, and what the laws leave of them there."""
        q, v, left = self.trace.q, self.trace.v, self.gap
        by_law = missing = np.zeros((len(self.places), self.record.n_samples))
        if not self.places:
            return Settled(q, v, by_law, missing, left, None)
        still, estimate = np.zeros(len(self.places)), self._estimate()
        own = self.forces(self.plant, self.trace.q, self.trace.v)
        turns = [(np.inf, q, v, by_law, estimate.force(left), left)]
        for _ in range(TURNS if estimate.evidence > LEAST_EVIDENCE else 0):
            missing = turns[-1][4]
            moved = self.beam.response(self.beam.shapes, still, by_law + missing)
            speed = self.beam.response(self.beam.shapes, still + 1.0, by_law + missing)
            q, v = self.moved(self.trace.q, moved), self.moved(self.trace.v, speed)
            by_law = self.recorded(self.forces(self.plant, q, v) - own) + self.springs[:, None] * moved
            left = self.gap - self.read(self.beam.response(self.rows, self.order, by_law))
            missing = estimate.force(left)
            turns.append((estimate.surprise, q, v, by_law, missing, left))
        return Settled(*min(turns, key=lambda turn: turn[0])[1:], estimate)

    @computed_once
    def is_told(self) -> bool:
        """Whether the missing force may be one: it moves no place far beyond all that the model says.

        Where the model is far off, what it leaves of a record's ends has slow lines, in which a force hardly moves the
        sensors: one that explains them is out of all proportion. What nobody drives only decays, and is no measure.
        """
        if self.record.excitation is None:
            return True
        own, found = (float(np.ptp(q, axis=1).max(initial=0.0)) for q in (self.trace.q, self.settled.q))
        return found <= RUN_AWAY * own

    @property
    def variance(self) -> FloatArray:
        """(lines, n_sensors) of the noise's spectrum, SI^2."""
        variance = self.record.n_samples * self.target.density.T
        heard = np.array([1.0 if name != self.unheard else UNHEARD for name in self.record.sensors])
        variance[0] = np.where(self.target.without_zero, UNHEARD, 1.0) * variance[0]
        return np.asarray(variance * heard)

    @computed_once
    def chain(self) -> ComplexArray:
        """(lines, n_sensors) what the measurement chain makes of a true channel."""
        n = self.record.n_samples
        # The impulse stands in the middle, so that a change of the channels finds nothing at the record's ends.
        impulse = np.zeros((len(self.record.sensors), n))
        impulse[:, n // 2] = 1.0
        turned = np.roll(self._measured(impulse), -(n // 2), axis=1)
        return np.asarray(scored_spectrum(turned).T)

    @computed_once
    def decays(self) -> ComplexArray:
        """(lines, n_sensors, n_decays) spectra of the free decays that a force repeated with the record leaves."""
        decays = self.beam.decays(self.rows, self.order)
        spectra = scored_spectrum(decays.reshape(-1, decays.shape[2])).reshape(*decays.shape[:2], -1)
        return np.asarray(spectra.transpose(2, 1, 0) * self.chain[:, :, None])

    def read(self, channels: FloatArray) -> ComplexArray:
        """(n_sensors, lines) spectrum of what the measurement chain makes of a difference of true channels.

        Args:
            channels: (n_sensors, N) SI.
        """
        return scored_spectrum(self._measured(channels))

    def frf(self, shapes: FloatArray) -> ComplexArray:
        """(lines, n_sensors, n_places) channels under a unit force at each place.

        Args:
            shapes: (n_places, n) displacement of the places by modal coordinate.
        """
        lines = self.target.measured.shape[1]
        return np.asarray(self.beam.acting_at(shapes).frf(self.rows, self.order, lines) * self.chain[:, :, None])

    def port_of(self, place: float | None) -> int:
        """The port of a place whose motion is relative to the base, if there is one."""
        ports = [i for i, port in enumerate(self.model.ports) if port.is_concentrated and port.position == place]
        return min(ports, key=lambda i: self.model.ports[i].frame != "base")

    def moved(self, own: FloatArray, moved: FloatArray) -> FloatArray:
        """(n_ports, M) the ports' motion: the given one, and at the places the difference at the stepper's rate.

        Args:
            own: (n_ports, M) at the stepper's rate.
            moved: (n_places, N) at the record's.
        """
        total = own.copy()
        for i, port in enumerate(self.model.ports):
            if port.is_concentrated:
                total[i] += raise_rate(moved[self.places.index(port.position)], self.response.steps_per_sample)
        return total

    def forces(self, plant: Plant, q: FloatArray, v: FloatArray) -> FloatArray:
        """(n_places, M) force of all contacts and laws at the places, N, along a motion of the ports.

        Args:
            plant: whose laws act, at the same ports.
            q: (n_ports, M) m.
            v: (n_ports, M) m/s.
        """
        total = np.zeros((len(self.places), q.shape[1]))
        index, fs = {port: i for i, port in enumerate(self.model.ports)}, self.trace.fs
        for law in plant.laws:
            if law.port.is_concentrated:
                i = index[law.port]
                total[self.places.index(law.port.position)] += law_along(law, q[i], v[i], fs)
        for contact in plant.contacts:
            i = index[Port(contact.position)]
            total[self.places.index(contact.position)] += contact_along(contact, q[i], v[i], fs)
        return total

    def recorded(self, fine: FloatArray) -> FloatArray:
        """(n, N) signals at the stepper's rate as the recorder keeps them."""
        return record_channels(fine, self.response.steps_per_sample, self.record.n_samples, self.record.fs)

    def name_of(self, place: float | None) -> str:
        """A place in words."""
        if place is None:
            return "mass"
        return next((c.sleeve for c in self.plant.contacts if c.position == place), f"{place:.3f} m")

    def _spring(self, place: float | None) -> float:
        """Half the contact's elastic force per deepest penetration; without a contact, what makes a slow mass turn."""
        q = self.trace.q[self.port_of(place)]
        for contact in self.plant.contacts:
            if contact.position == place:
                reached = float(np.abs(q - contact.offset).max()) - contact.clearance
                depth = max(reached, SHALLOW * float(np.ptp(q)), LEAST_DEPTH)
                return 0.5 * contact.law.elastic(depth) / depth
        slow = 2.0 * np.pi * LEAST_CYCLES / self.record.duration
        return float(np.sum(self.model.carried**2)) * slow**2

    def _estimate(self) -> ForceEstimate:
        return ForceEstimate(self.frf(self.beam.shapes), self.decays, self.variance, self.record.n_samples)

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

SHALLOW, LEAST_DEPTH = 0.01, 1e-9
"""Least penetration, as a share of the motion and in m, for the secant of a contact that never touches."""
