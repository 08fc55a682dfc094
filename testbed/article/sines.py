"""Sines through the first resonance at three levels: folds and backbones by harmonic balance, checked in time."""

from dataclasses import asdict, dataclass
from math import ceil, log
from time import perf_counter
from typing import Any

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.harmonic_balance import PeriodicCurve, backbone, nonlinear_frf
from models.plant import Plant, build_plant
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial
from testbed.article.rig import BAND as MODES_UP_TO
from testbed.article.rig import Geometry

Json = dict[str, Any]

AMPLITUDES = (1.0, 5.0, 20.0)
"""N: below the first strike, about where a sleeve opens, and far above."""

THROUGH = (5.0, 14.0)
"""Hz, about the first resonance."""

TIP = "P8"
"""The sensor whose reading is shown, and held at phase resonance."""

ENGINES = ("modal", "mujoco", "exudyn")
"""That step the rig in time to the steady state."""

FS, WATCHED, SPARE = 1024.0, 1.0, 0.25
"""Hz; s of steady state that are compared; s before the record's end that its filter spoils."""

SETTLED = 1e-3
"""Share of the transient that is left when a test counts as steady."""

LARGEST_MULTIPLIER = 0.95
"""Of motion that is compared: what settles more slowly is a bifurcation's neighbour, at which models part."""


@dataclass(frozen=True)
class Check:
    """One steady state, by harmonic balance and stepped in time.

    Attributes:
        freq: Hz, at which the curve has this motion alone.
        distortion: rms of the higher harmonics over the first at the tip.
        errors: per engine, difference of the first harmonics over their size, all eight points together.
        seconds: per engine, of processor until the motion is steady.
        until_steady: s of motion.
    """

    freq: float
    distortion: float
    errors: dict[str, float]
    seconds: dict[str, float]
    until_steady: float


@dataclass(frozen=True, eq=False)
class Sines:
    """The rig at one clearance and amplitude.

    Attributes:
        clearance: m.
        amplitude: N.
        curves: up through the band, and down where it folds back.
        seconds: of processor that they took.
        check: None where no motion of the curve is alone and settles.
    """

    clearance: float
    amplitude: float
    curves: tuple[PeriodicCurve, ...]
    seconds: float
    check: Check | None


def sines(geometry: Geometry, clearance: float, amplitude: float) -> Sines:
    """Follow the curve and check one point of it.

    Args:
        geometry: of the rig.
        clearance: of both sleeves, m.
        amplitude: of the shaker's sine, N.

    Raises:
        DivergenceError: no periodic motion was found at the lower frequency.
    """
    plant, began = build_plant(geometry.rig(clearance, "force")), perf_counter()
    curves = [nonlinear_frf(plant, amplitude, THROUGH, MODES_UP_TO)]
    if curves[0].ended:
        curves.append(nonlinear_frf(plant, amplitude, THROUGH, MODES_UP_TO, downwards=True))
    seconds = perf_counter() - began
    return Sines(clearance, amplitude, tuple(curves), seconds, _checked(plant, amplitude, curves))


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


def _checked(plant: Plant, amplitude: float, curves: list[PeriodicCurve]) -> Check | None:
    """The most distorted motion that is alone at its frequency and settles, by all engines."""
    curve, names = curves[0], [sensor.name for sensor in plant.sensors]
    if curve.ended:
        return None
    read = curve.read(names)
    tip = read[:, names.index(TIP)]
    distortion = np.linalg.norm(tip[:, 2:], axis=1) / np.abs(tip[:, 1])
    alone = np.array([_crossings(curve.freqs, freq) == 1 for freq in curve.freqs])
    fit = alone & (curve.largest_multiplier < LARGEST_MULTIPLIER)
    fit[[0, -1]] = False
    if not fit.any():
        return None
    point = int(np.argmax(np.where(fit, distortion, -1.0)))
    freq, multiplier = float(curve.freqs[point]), float(curve.largest_multiplier[point])
    until = log(SETTLED) / log(multiplier) / freq
    errors, seconds = {}, {}
    for engine in ENGINES:
        began = perf_counter()
        stepped = _stepped(engine, plant, amplitude, freq, until)
        seconds[engine] = perf_counter() - began
        errors[engine] = float(np.linalg.norm(stepped - read[point, :, 1]) / np.linalg.norm(stepped))
    return Check(freq, float(distortion[point]), errors, seconds, until)


def _crossings(freqs: FloatArray, freq: float) -> int:
    """How often a curve has a frequency; the point itself counts once."""
    above = freqs >= freq
    return int(np.count_nonzero(above[1:] != above[:-1]))


def _stepped(engine: str, plant: Plant, amplitude: float, freq: float, until: float) -> ComplexArray:
    """(n_sensors,) first harmonics of the steady state, begun from rest."""
    time = np.arange(ceil((until + WATCHED + SPARE) * FS)) / FS
    force = amplitude * np.cos(2.0 * np.pi * freq * time)
    channels = simulator(engine).run(plant, Trial(FS, force), Resolution()).channels
    seen = (time >= until) & (time < until + WATCHED)
    orders = range(1, int(0.4 * FS / freq) + 1)
    waves = [turn(2.0 * np.pi * freq * k * time[seen]) for k in orders for turn in (np.cos, np.sin)]
    fitted, *_ = np.linalg.lstsq(np.column_stack([np.ones(seen.sum()), *waves]), channels[:, seen].T)
    return np.asarray(fitted[1] - 1j * fitted[2])
