"""What a picture of an effect shows outside: in frequency, at two levels, over time and along the beam."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.ndimage import uniform_filter1d

from models.arrays import FloatArray
from testbed.effects_page.bench import FS, LEVELS, Bench, Level
from testbed.effects_page.spectra import amplitudes, lines
from testbed.quantities import frf_unit

CurveName = Literal["without", "with", "early", "late", "low", "high"]

WINDOW = 0.25
"""Seconds over which the change is averaged."""

PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class Curve:
    """One line of a panel.

    Attributes:
        name: which of the figure's colours it has.
        x, y: (n,) as drawn.
        marks: points instead of a line.
    """

    name: CurveName
    x: FloatArray
    y: FloatArray
    marks: bool = False


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes of a picture.

    Attributes:
        title: what it shows.
        x_label, y_label: with units.
        curves: in the order in which they are drawn.
        log_x, log_y: logarithmic scales.
        least_span: of the y axis, so that rounding does not fill it.
        from_zero: the y axis begins at 0.
        marked: x of vertical lines: sleeves along the beam.
        place: x of the effect, or None.
    """

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    log_x: bool = False
    log_y: bool = False
    least_span: float = 0.0
    from_zero: bool = False
    marked: tuple[float, ...] = ()
    place: float | None = None


Answers = Mapping[Level, FloatArray]


def relative_change(without: FloatArray, answers: FloatArray) -> FloatArray:
    """(n_sensors,) rms of the change of each channel as a share of its own rms.

    Args:
        without: (n_realisations, n_sensors, N) as it was.
        answers: the same with the effect.
    """
    return np.asarray(np.sqrt(np.mean((answers - without) ** 2, axis=(0, 2)) / np.mean(without**2, axis=(0, 2))))


def sensor_shown(bench: Bench, answers: Answers) -> int:
    """Index of the sensor whose channel changes most, both levels in the shares of their own size.

    Args:
        bench: with the answers of the rig as it is.
        answers: with the effect.
    """
    change = np.zeros(len(bench.rig.sensors))
    for level, without in bench.answers.items():
        change += np.sqrt(np.mean((answers[level] - without) ** 2, axis=(0, 2)) / np.mean(without**2))
    return int(np.argmax(change))


def frequency_panels(bench: Bench, answers: Answers, sensor: int) -> tuple[Panel, ...]:
    """Response over force at a sensor, one panel a level.

    Args:
        bench: with the answers of the rig as it is.
        answers: with the effect.
        sensor: index.
    """
    name = bench.rig.sensors[sensor].name
    panels = []
    for level, rms in LEVELS.items():
        before, after = (amplitudes(r[level][:, sensor], bench.records[level]) for r in (bench.answers, answers))
        panels.append(
            Panel(
                f"frequency, {level} level ({rms:g} N)",
                "frequency [Hz]",
                f"{name} [{frf_unit(bench.rig, name)}]",
                (Curve("without", lines(), before), Curve("with", lines(), after)),
                log_x=True,
                log_y=True,
            )
        )
    return tuple(panels)


def time_panel(bench: Bench, answers: Answers) -> Panel:
    """Short-time rms of the change over that of the response, all channels together.

    Args:
        bench: with the answers of the rig as it is.
        answers: with the effect.
    """
    curves = []
    for level, without in bench.answers.items():
        change, response = (
            uniform_filter1d(np.mean(signal**2, axis=(0, 1)), round(WINDOW * FS))
            for signal in (answers[level] - without, without)
        )
        short = np.sqrt(np.maximum(change, 0.0) / response)  # the running mean rounds below 0
        step = round(WINDOW * FS / 8)
        time = np.arange(len(short)) / FS
        curves.append(Curve(level, time[::step], PERCENT * short[::step]))
    return Panel("time", "time [s]", "change [% of response]", tuple(curves), least_span=1.0, from_zero=True)


def place_panel(bench: Bench, answers: Answers, place: float | None) -> Panel:
    """Change of every channel as a share of its own rms, along the beam.

    Args:
        bench: with the answers of the rig as it is.
        answers: with the effect.
        place: where the effect sits, m from the clamp, or None.
    """
    x = np.array([sensor.position or 0.0 for sensor in bench.rig.sensors])
    curves = [
        Curve(level, x, PERCENT * relative_change(without, answers[level]), marks=True)
        for level, without in bench.answers.items()
    ]
    return Panel(
        "place",
        "position from the clamp [m]" if bench.rig.sleeves else "one place",
        "change [% of channel]",
        tuple(curves),
        least_span=1.0,
        from_zero=True,
        marked=tuple(sleeve.position for sleeve in bench.rig.sleeves),
        place=place,
    )
