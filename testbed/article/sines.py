"""Sines through the first resonance at three levels: folds and backbones by harmonic balance, checked in time."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import ceil
from time import process_time

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.harmonic_balance import PeriodicCurve, backbone, from_both_ends
from models.plant import Plant, build_plant
from models.record import Record
from models.simulate import simulate
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial
from testbed.article.rig import BAND as MODES_UP_TO
from testbed.article.rig import TIP, Geometry
from testbed.outputs import Json

AMPLITUDES = (1.0, 5.0, 20.0)
"""N: below the first strike, about where a sleeve opens, and far above."""

THROUGH = (5.0, 14.0)
"""Hz, about the first resonance."""

FS, WATCHED, SPARE = 1024.0, 1.0, 0.25
"""Hz; s of steady state that are compared; s before the record's end that its filter spoils."""

SETTLED, LONGEST = 1e-3, 60.0
"""Difference of the first harmonics from those at the end of the longest test, s, from which on motion is steady."""

LARGEST_MULTIPLIER = 0.95
"""Of motion that is compared: what settles more slowly is a bifurcation's neighbour, at which models part."""

ASIDE = 1e-3
"""Share of a frequency on either side at which the curve must have one motion too."""


CHOICES = (THROUGH, MODES_UP_TO, FS, WATCHED, SPARE, SETTLED, LONGEST, LARGEST_MULTIPLIER, ASIDE)
"""All of these, on which what is kept depends."""


@dataclass(frozen=True)
class Check:
    """One steady state, by harmonic balance and stepped in time.

    Attributes:
        freq: Hz, at which the curve has this motion alone.
        distortion: rms of the higher harmonics over the first at the tip.
        stays: difference of the first harmonics over their size, all eight points together, of the modal model begun on
            the curve and stepped as long as the others.
        errors: the same per engine, begun at rest.
        seconds: per engine, of processor until the motion is steady and has been watched.
        until_steady: s of motion.
    """

    freq: float
    distortion: float
    stays: float
    errors: dict[str, float]
    seconds: dict[str, float]
    until_steady: float


@dataclass(frozen=True, eq=False)
class Sines:
    """The rig at one clearance and amplitude.

    Attributes:
        clearance: m.
        amplitude: N.
        curves: up through the band, and down where another motion is reached at its upper end.
        seconds: of processor that they took.
        check: None where no motion of the curve is alone, or the one chosen does not settle.
    """

    clearance: float
    amplitude: float
    curves: tuple[PeriodicCurve, ...]
    seconds: float
    check: Check | None


def sines(geometry: Geometry, clearance: float, amplitude: float, engines: Sequence[str]) -> Sines:
    """Follow the curve and check one point of it.

    Args:
        geometry: of the rig.
        clearance: of both sleeves, m.
        amplitude: of the shaker's sine, N.
        engines: that step the rig in time to the steady state.

    Raises:
        DivergenceError: no periodic motion was found at the lower frequency.
    """
    plant, began = build_plant(geometry.rig(clearance, "force")), process_time()
    curves = from_both_ends(plant, amplitude, THROUGH, MODES_UP_TO)
    seconds = process_time() - began
    return Sines(clearance, amplitude, curves, seconds, _checked(plant, amplitude, curves, engines))


def sines_json(found: Sines) -> Json:
    """What the page and the figure show of it.

    Args:
        found: finished.
    """
    return {
        "clearance": found.clearance,
        "amplitude": found.amplitude,
        "curves": [curve_json(curve) for curve in found.curves],
        "seconds": found.seconds,
        "check": None if found.check is None else asdict(found.check),
    }


def curve_json(curve: PeriodicCurve) -> Json:
    """Frequencies, half the swing of the tip's reading, stability.

    Args:
        curve: finished.
    """
    return {
        "frequency": curve.freqs,
        "peak": curve.peaks([TIP])[:, 0],
        "stable": curve.is_stable,
        "amplitude": curve.amplitudes,
        "ended": curve.ended,
    }


def spine(geometry: Geometry, clearance: float) -> PeriodicCurve:
    """The backbone of the first resonance up to the largest amplitude.

    Args:
        geometry: of the rig.
        clearance: of both sleeves, m.
    """
    plant = build_plant(geometry.rig(clearance, "force"))
    return backbone(plant, TIP, AMPLITUDES[-1], THROUGH, MODES_UP_TO)


def _checked(plant: Plant, amplitude: float, curves: Sequence[PeriodicCurve], engines: Sequence[str]) -> Check | None:
    """The most distorted motion that is alone at its frequency and settles, by all engines."""
    names = [sensor.name for sensor in plant.sensors]
    curve, *others = curves
    if curve.ended:
        return None
    read = curve.read(names)
    tip = read[:, names.index(TIP)]
    distortion = np.linalg.norm(tip[:, 2:], axis=1) / np.abs(tip[:, 1])
    alone = np.array([_is_alone(curve.freqs, freq) for freq in curve.freqs])
    for other in others:
        alone &= (curve.freqs < other.freqs.min()) | (curve.freqs > other.freqs.max())
    fit = alone & (curve.largest_multiplier < LARGEST_MULTIPLIER)
    fit[[0, -1]] = False
    if not fit.any():
        return None
    point = int(np.argmax(np.where(fit, distortion, -1.0)))
    freq = float(curve.freqs[point])
    until = _settling(plant, amplitude, freq)
    if until is None:
        return None
    first, errors, seconds = read[point, :, 1], {}, {}
    for engine in engines:
        began = process_time()
        channels = _stepped(engine, plant, amplitude, freq, until)
        seconds[engine] = process_time() - began
        errors[engine] = _apart(_first_harmonics(channels, freq, [until])[0], first)
    begun = _first_harmonics(_stepped("modal", plant, amplitude, freq, until, curve.states()[point]), freq, [until])
    return Check(freq, float(distortion[point]), _apart(begun[0], first), errors, seconds, until)


def _apart(found: ComplexArray, expected: ComplexArray) -> float:
    """Difference over size, all sensors together."""
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


def _is_alone(freqs: FloatArray, freq: float) -> bool:
    """Whether the curve passes a frequency once; at a fold's tip it passes once, and beside it not."""
    aside = (freq * (1.0 - ASIDE), freq * (1.0 + ASIDE))
    return all(np.count_nonzero((freqs[1:] >= at) != (freqs[:-1] >= at)) == 1 for at in aside)


def _settling(plant: Plant, amplitude: float, freq: float) -> float | None:
    """S from rest until the modal model's motion is as at the end of a long test; None where it is not before."""
    begins = np.arange(1.0, LONGEST)
    found = _first_harmonics(_stepped("modal", plant, amplitude, freq, begins[-1]), freq, begins)
    apart = np.linalg.norm(found - found[-1], axis=1) > SETTLED * np.linalg.norm(found[-1])
    last = int(np.flatnonzero(apart)[-1]) if apart.any() else -1
    return None if last >= len(begins) // 2 else float(begins[last + 1])


def _stepped(
    engine: str, plant: Plant, amplitude: float, freq: float, until: float, start: FloatArray | None = None
) -> FloatArray:
    """(n_sensors, N) readings at ``FS`` until motion that is steady from a time on, s, has been watched.

    From rest, or from a state of the modal model.
    """
    time = np.arange(ceil((until + WATCHED + SPARE) * FS)) / FS
    force = amplitude * np.cos(2.0 * np.pi * freq * time)
    if engine != "modal":
        return simulator(engine).run(plant, Trial(FS, force), Resolution()).channels
    names = tuple(sensor.name for sensor in plant.sensors)
    record = Record("sine", FS, force, names, np.zeros((len(names), len(time))))
    return simulate(plant, record, start=start).channels


def _first_harmonics(channels: FloatArray, freq: float, begins: Sequence[float] | FloatArray) -> ComplexArray:
    """(n, n_sensors) of readings, each over ``WATCHED`` seconds from a time on, s."""
    time, orders = np.arange(channels.shape[1]) / FS, range(1, int(0.4 * FS / freq) + 1)
    rows = []
    for begin in begins:
        seen = (time >= begin) & (time < begin + WATCHED)
        waves = [turn(2.0 * np.pi * freq * k * time[seen]) for k in orders for turn in (np.cos, np.sin)]
        fitted, *_ = np.linalg.lstsq(np.column_stack([np.ones(seen.sum()), *waves]), channels[:, seen].T)
        rows.append(fitted[1] - 1j * fitted[2])
    return np.stack(rows)
