"""Steady vibration by harmonic balance: the first harmonic of an oscillator with laws under a sine.

With the linear part's dynamic stiffness D(w) and the laws' describing functions kappa(A, w) the amplitude A solves
|D + kappa| A = |F|. Where a fold leaves several, the one next to the line before is taken, as a slow test does.
Source: M. Krack, J. Gross, Harmonic Balance for Nonlinear Vibration Problems (2019), sections 2.2 and 4.1.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Self

import numpy as np
from scipy.interpolate import CubicSpline

from identification.hypothesis import Hypothesis
from identification.stepped_sine.describing import describing_function
from identification.stepped_sine.record import SteppedSine
from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError, InputError
from models.linear import frf, linearised
from models.modal import build_modal
from models.plant import Plant
from models.ports import PointLaw
from models.rig import Sensor

PER_DECADE = 16
"""Amplitudes at which laws are evaluated; a cubic spline between them is right to 1e-5 of a law's stiffness."""

BETWEEN = 8
"""Straight pieces between those, on which the balance is looked for; Newton's steps make the rest of it."""

LEAST_SHARE, MOST_SHARE = 0.02, 20.0
"""Amplitudes looked at: from this share of the smallest measured one up to so many times the largest."""

PROBE = Sensor(name="probe", quantity="displacement")


@dataclass(frozen=True, eq=False)
class Balance:
    """A model of an oscillator as the lines of a stepped-sine test see it.

    Attributes:
        record: the test.
        stiffness: (n,) dynamic stiffness of the linear part, N/m.
        reading: (n_sensors, n) what the sensors read per displacement.
        log_a: (m,) logarithms of amplitudes, m, or none where there is no law.
        laws: describing functions of all laws over them, at the lowest and at the highest frequency.
        share: (n,) where each line lies between those.
    """

    record: SteppedSine
    stiffness: ComplexArray
    reading: ComplexArray
    log_a: FloatArray
    laws: CubicSpline | None
    share: FloatArray

    @classmethod
    def of(cls, hypothesis: Hypothesis, record: SteppedSine) -> Self:
        """The model of a hypothesis.

        Args:
            hypothesis: an oscillator with its effects.
            record: its frequencies and forces are used.

        Raises:
            InputError: a rig that is no oscillator under a force.
        """
        plant = hypothesis.plant()
        if plant.structure.is_beam or plant.excitation is None or plant.excitation.quantity != "force":
            raise InputError(
                f"{record.name}: stepped sines on a rig that is no oscillator under a force",
                "harmonic balance is written for one degree of freedom",
                'describe the mode as a structure of kind = "oscillator" with a force as its excitation',
            )
        chain = tuple(effect for effect in plant.effects if effect.family == "measurement")
        linear, lines = replace(plant, laws=(), effects=chain), tuple(record.frequency.tolist())
        receptance = _frf(replace(linear, effects=(), sensors=(PROBE,)), lines, (PROBE.name,))[0]
        stiffness, reading = 1.0 / receptance, _frf(linear, lines, record.sensors) / receptance
        omega = 2.0 * np.pi * record.frequency
        ends = (float(omega.min()), float(max(omega.max(), omega.min() * (1.0 + 1e-6))))
        share = (omega - ends[0]) / (ends[1] - ends[0])
        if not plant.laws:
            return cls(record, stiffness, reading, np.empty(0), None, share)
        first, last = (round(PER_DECADE * np.log10(a)) for a in _range_of(record, reading))
        powers = range(first, last + 1)
        log_a = np.array(powers) / PER_DECADE * np.log(10.0)
        ends_kappa = [np.sum([_table(law, powers, end) for law in plant.laws], axis=0) for end in ends]
        return cls(record, stiffness, reading, log_a, CubicSpline(log_a, np.stack(ends_kappa, axis=-1)), share)

    def held(self, log_a: FloatArray) -> ComplexArray:
        """(n, ...) dynamic stiffness with the laws; within a narrow band they are straight in the frequency.

        Args:
            log_a: (n,) a logarithm of amplitude for each line, or (1, m) some for all of them.
        """
        if self.laws is None:
            return self.stiffness
        at_line = (slice(None), None) if log_a.ndim > 1 else slice(None)
        share = self.share[at_line]
        low, high = np.moveaxis(self.laws(log_a), -1, 0)
        return np.asarray(self.stiffness[at_line] + (1.0 - share) * low + share * high)

    def steady_state(self) -> ComplexArray:
        """(n_sensors, n) first harmonics that the sensors read, SI, with the phase against the force.

        Raises:
            DivergenceError: no amplitude balances the force.
        """
        return np.asarray(self.reading * self.record.force / self.held(self._found()))

    def imbalance(self) -> ComplexArray:
        """(n_sensors, n) the force that the measured motion lacks in this model, as the response that it would make.

        To first order the error of the steady state, without its folds; of many sensors the first tells the motion.
        """
        motion = self.record.responses[0] / self.reading[0]
        needed = self.record.force / motion
        held = self.held(np.clip(np.log(np.abs(motion)), *self._range))
        return np.asarray(self.record.responses * (needed - held) / needed)

    @property
    def _range(self) -> tuple[float, float]:
        return (float(self.log_a[0]), float(self.log_a[-1])) if len(self.log_a) else (-np.inf, np.inf)

    def _found(self) -> FloatArray:
        """(n,) logarithms of the amplitudes that balance the force."""
        log_force = np.log(self.record.force)
        if self.laws is None:
            return np.asarray(log_force - np.log(np.abs(self.stiffness)))
        fine = np.linspace(*self._range, (len(self.log_a) - 1) * BETWEEN + 1)
        excess = np.log(np.abs(self.held(fine[None]))) + fine - log_force[:, None]
        found = _branch(fine, excess, self.record.name)
        for _ in range(POLISHED):
            now, ahead = (np.log(np.abs(self.held(x))) + x - log_force for x in (found, found + NUDGE))
            slope = (ahead - now) / NUDGE
            step = np.divide(-now, slope, out=np.zeros_like(now), where=np.abs(slope) > LEAST_SLOPE)
            found = np.clip(found + np.clip(step, -LARGEST_STEP, LARGEST_STEP), *self._range)
        return np.asarray(found)


POLISHED, NUDGE, LEAST_SLOPE, LARGEST_STEP = 3, 1e-6, 1e-3, 0.02
"""Newton's steps in the logarithm of the amplitude, their difference, the slope of a fold, and the longest step."""


@lru_cache(maxsize=64)
def _frf(plant: Plant, lines: tuple[float, ...], sensors: tuple[str, ...]) -> ComplexArray:
    """(n_sensors, n) what the sensors of a linear plant read per unit force, kept for other laws and levels."""
    return frf(linearised(build_modal(plant, 2.0 * max(lines))), np.array(lines), sensors)


def _range_of(record: SteppedSine, reading: ComplexArray) -> tuple[float, float]:
    """Amplitudes, m, between which the steady state is looked for."""
    size = np.abs(record.responses[0] / reading[0])
    return LEAST_SHARE * float(size.min()), MOST_SHARE * float(size.max())


def _table(law: PointLaw, powers: range, omega: float) -> ComplexArray:
    """(m,) the describing function at these powers of ten, in units of 1 / PER_DECADE.

    Other numbers of the rig and other levels find a value as it is.
    """
    known = _known(law, omega)
    missing = [power for power in powers if power not in known]
    if missing:
        amplitudes = 10.0 ** (np.array(missing) / PER_DECADE)
        known.update(zip(missing, describing_function(law, amplitudes, omega).tolist(), strict=True))
    table = np.array([known[power] for power in powers])
    if not np.isfinite(table).all():
        raise DivergenceError(f"{law.owner}: a force without bound under a sine; its numbers are out of all range")
    return table


@lru_cache(maxsize=128)
def _known(law: PointLaw, omega: float) -> dict[int, complex]:  # noqa: ARG001
    """Values of a law's describing function by power, filled as they are asked for."""
    return {}


def _branch(fine: FloatArray, excess: FloatArray, name: str) -> FloatArray:
    """(n,) logarithms of the amplitudes at which the (n, m) excess of force passes 0, next to the line before."""
    crossed = (excess[:, :-1] < 0.0) != (excess[:, 1:] < 0.0)
    found, before = np.empty(len(excess)), -np.inf
    for k, row in enumerate(crossed):
        at = np.flatnonzero(row)
        if len(at) == 0:
            raise DivergenceError(f"{name}: no amplitude balances the force on line {k}; look for a negative damping")
        part = -excess[k, at] / (excess[k, at + 1] - excess[k, at])
        roots = fine[at] + part * (fine[at + 1] - fine[at])
        found[k] = roots[0] if before == -np.inf else roots[np.argmin(np.abs(roots - before))]
        before = found[k]
    return found
