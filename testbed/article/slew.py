"""Control by prediction: the base is slewed so that a model's tip follows a wanted course, and the rig is watched.

The wanted course is smooth and sets out before the base has to; whatever the base must do for it is found on the
model by iteration: the tip's error, through the inverse of the linearised rig, is taken off the base's course, and
the nonlinear model says what is left. The rig never takes part, so this is feed-forward alone: a model's error is the
tip's.

Source: Ghosh and Paden, IEEE Trans. Autom. Control 47 (2002) 831, iteration with the inverse of a linear model.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.linear import frf, linearised
from models.modal import build_modal
from models.plant import Plant
from models.record import Record
from models.rig import Beam, Excitation, Rig, Sensor
from models.simulate import simulate
from models.simulators import simulator
from models.simulators.protocol import Trial
from testbed.article.rig import BAND

FS = 2048.0
"""Hz."""

DISTANCE, LASTS = 0.06, 0.25
"""Of the slew, m and s: both sleeves are left and struck, in little more than two periods of the first mode."""

BEFORE, AFTER = 1.0, 1.75
"""s of the record around the slew; what the inverse does beforehand has died out at its begin."""

INVERTED_TO = 60.0
"""Hz; above, the course asks for nothing and the base is left as it is."""

ITERATIONS, STEP = 12, 0.8
"""Of the inversion; share of the error that is taken off at once."""

WATCHED = 0.5
"""s after the slew during which the tip's error counts: there the grip closes."""

TIP = "tip"
Follow = Callable[[FloatArray], FloatArray]
"""From the base's course to the tip's, (N,) m each."""


@dataclass(frozen=True, eq=False)
class Slew:
    """What one course of the base did.

    Attributes:
        base: (N,) m.
        tip: (N,) m, from where it was at rest.
        rms: of the tip's error from the slew's begin to ``WATCHED`` after its end, m.
        largest: of the same, m.
        after: rms of the tip's error after the slew's end, m.
    """

    base: FloatArray
    tip: FloatArray
    rms: float
    largest: float
    after: float


def wanted() -> FloatArray:
    """(N,) m, of seventh order, so that jerk is smooth as well."""
    time = np.arange(round((BEFORE + LASTS + AFTER) * FS)) / FS
    s = np.clip((time - BEFORE) / LASTS, 0.0, 1.0)
    return np.asarray(DISTANCE * s**4 * (35.0 - 84.0 * s + 70.0 * s**2 - 20.0 * s**3))


def slewed(rig: Rig) -> Rig:
    """A rig whose base's course is given, and whose tip is watched.

    Args:
        rig: of this study.
    """
    assert isinstance(rig.structure, Beam)
    return rig.model_copy(
        update={
            "excitation": Excitation(name="base", quantity="base_displacement"),
            "sensors": (Sensor(name=TIP, position=rig.structure.length, quantity="displacement"),),
        }
    )


def by_model(plant: Plant) -> Follow:
    """The modal model's tip.

    Args:
        plant: of ``slewed``.
    """

    def follow(base: FloatArray) -> FloatArray:
        record = Record("slew", FS, base, (TIP,), np.zeros((1, len(base))))
        return np.asarray(simulate(plant, record).channels[0])

    return follow


def by_engine(plant: Plant, engine: str) -> Follow:
    """The tip of the rig on an engine's bench.

    Args:
        plant: of ``slewed``.
        engine: name of a simulator.
    """

    def follow(base: FloatArray) -> FloatArray:
        return np.asarray(simulator(engine).run(plant, Trial(FS, base)).channels[0])

    return follow


def fed_forward(plant: Plant) -> FloatArray:
    """(N,) the base's course for which the model's tip comes closest to the wanted one, m.

    Args:
        plant: the model, of ``slewed``.

    Raises:
        DivergenceError: the model's motion left the finite numbers.
    """
    goal, follow = wanted(), by_model(plant)
    inverse, best = _inverse(plant, len(goal)), goal
    base, least = goal, float("inf")
    for _ in range(ITERATIONS):
        miss = goal - follow(base)
        error = float(np.linalg.norm(miss))
        if error < least:
            best, least = base, error
        base = base + STEP * np.fft.irfft(inverse * np.fft.rfft(miss), len(goal))
    return best


def carried_out(base: FloatArray, follow: Follow) -> Slew:
    """Send a course to a rig.

    Args:
        base: (N,) m.
        follow: the rig.
    """
    tip = follow(base)
    error = tip - wanted()
    begin, end, last = (round(t * FS) for t in (BEFORE, BEFORE + LASTS, BEFORE + LASTS + WATCHED))
    counted, after = error[begin:last], error[end:last]
    return Slew(base, tip, _rms(counted), float(np.abs(counted).max()), _rms(after))


def courses(models: Mapping[str, Plant]) -> dict[str, FloatArray]:
    """The base's course by each model, and without one: the base does what the tip should.

    Args:
        models: of ``slewed``, by name.
    """
    return {"no model": wanted(), **{name: fed_forward(plant) for name, plant in models.items()}}


def _inverse(plant: Plant, n: int) -> ComplexArray:
    """(n // 2 + 1,) base over tip of the linearised rig, faded out where the course asks for nothing."""
    freq = np.asarray(np.fft.rfftfreq(n, 1.0 / FS), np.float64)
    used = (freq > 0.0) & (freq < INVERTED_TO)
    inverse = np.zeros(len(freq), complex)
    transfer = frf(linearised(build_modal(plant, BAND)), freq[used], [TIP])[0]
    inverse[used] = np.cos(0.5 * np.pi * freq[used] / INVERTED_TO) ** 2 / transfer
    inverse[0] = 1.0
    return inverse


def _rms(signal: FloatArray) -> float:
    return float(np.sqrt(np.mean(signal**2)))
