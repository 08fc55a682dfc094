"""What a picture of an effect shows inside: the force, the contact, the modes or the channel that it changed.

Which of them is asked of the plant with and without it: nothing here knows a kind.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from models.band_limit import STOP_EDGE
from models.effects import Effect
from models.linear import NaturalModes, linearised, natural_modes
from models.modal import build_modal
from models.plant import Plant
from models.ports import Port
from models.simulate import Response
from testbed.effects_page.bench import BAND, FS, Bench
from testbed.effects_page.panels import PERCENT, Answers, Curve, CurveName, Panel
from testbed.effects_page.spectra import lines, spectra

STRETCH = 0.3
"""Seconds of a record over which a loop is drawn."""

ZOOM = 0.06
"""Seconds about the largest force over which it is drawn in time."""

MILLI = 1e3


@dataclass(frozen=True)
class Axes:
    """How the motion that a port reads is shown, and the force on it.

    Attributes:
        motion, rate, force: labels.
        scale: of motion and rate.
    """

    motion: str
    rate: str
    force: str
    scale: float


AXES: Mapping[int, Axes] = {
    0: Axes("displacement [mm]", "velocity [mm/s]", "force [N]", MILLI),
    1: Axes("slope [mrad]", "slope rate [mrad/s]", "moment [N m]", MILLI),
    2: Axes("curvature [1/km]", "curvature rate [1/(km s)]", "force on it [N m^2]", MILLI),
}
"""By the derivative that a port reads."""


def inside_panels(bench: Bench, effect: Effect, answers: Answers, sensor: int) -> tuple[Panel, Panel]:
    """Two panels of what the effect is, as far as the plant shows it.

    Args:
        bench: with the rig without it.
        effect: that is shown.
        answers: with the effect.
        sensor: index of the one whose channel changes most.
    """
    without, plant = bench.plant(), bench.plant(effect)
    if plant.structure != without.structure:
        return _modes(without, plant, bench.records["high"][0].duration)
    if len(plant.laws) > len(without.laws):
        return _force(bench.traced(effect), len(without.laws), through_time=effect.family == "time")
    changed = [new for new, old in zip(plant.contacts, without.contacts, strict=True) if new != old]
    if changed:
        contact = plant.contacts.index(changed[0])
        return _contact(bench.traced(), bench.traced(effect), contact, through_time=effect.family == "time")
    return _channel(bench, answers, sensor)


def _force(response: Response, first: int, *, through_time: bool) -> tuple[Panel, Panel]:
    """The largest of the effect's forces against what its port reads: the loop, and force over speed.

    Args:
        response: with the effect, traced.
        first: index of the effect's first law.
        through_time: it is not the same early and late.
    """
    trace = response.trace
    assert trace is not None
    size = np.std(trace.law_forces[first:], axis=1)
    law = first + int(np.argmax(size))
    port = response.model.plant.laws[law].port
    row, axes = trace.ports.index(port), AXES[port.derivative]
    parts = _parts(trace.fs, trace.q.shape[1], through_time=through_time)
    force, motion, rate = trace.law_forces[law], axes.scale * trace.q[row], axes.scale * trace.v[row]
    where = f" at {port.position:.2f} m" if len(size) > 1 and port.position is not None else ""
    return (
        Panel(
            f"its force{where}, high level",
            axes.motion,
            axes.force,
            tuple(Curve(name, motion[part], force[part]) for name, part in parts),
        ),
        Panel(
            f"its force{where}, high level",
            axes.rate,
            axes.force,
            tuple(Curve(name, rate[part], force[part]) for name, part in parts),
        ),
    )


def _contact(without: Response, shown: Response, contact: int, *, through_time: bool) -> tuple[Panel, Panel]:
    """The sleeve's force over the displacement there, and over time about its largest value, late where that matters.

    Args:
        without: traced, without the effect.
        shown: traced, with it.
        contact: index.
        through_time: it is not the same early and late.
    """
    loops, courses = [], []
    assert shown.trace is not None
    pressed = np.abs(shown.trace.contact_forces[contact])
    first = len(pressed) * 3 // 4 if through_time else 0
    centre = first + int(np.argmax(pressed[first:]))
    for response, stage in ((without, False), (shown, True)):
        trace = response.trace
        assert trace is not None
        row = trace.ports.index(Port(response.model.plant.contacts[contact].position))
        force = trace.contact_forces[contact]
        for name, part in _parts(trace.fs, len(force), through_time=through_time and stage):
            loops.append(Curve(name if stage else "without", MILLI * trace.q[row, part], force[part]))
        half = round(0.5 * ZOOM * trace.fs)
        near = slice(max(0, centre - half), centre + half)
        time = MILLI * np.arange(len(force))[near] / trace.fs
        courses.append(Curve("with" if stage else "without", time - time[0], force[near]))
    axes, sleeve = AXES[0], shown.model.plant.contacts[contact].sleeve
    return (
        Panel(f"force of {sleeve}, high level", axes.motion, axes.force, tuple(loops)),
        Panel(
            f"force of {sleeve} over time{', late' if through_time else ''}", "time [ms]", axes.force, tuple(courses)
        ),
    )


def _parts(fs: float, n_samples: int, *, through_time: bool) -> tuple[tuple[CurveName, slice], ...]:
    """Which stretches of a record are drawn: the last one, or the first and the last."""
    n = round(STRETCH * fs)
    late = slice(n_samples - n, n_samples)
    return (("early", slice(0, n)), ("late", late)) if through_time else (("with", late),)


def _modes(without: Plant, plant: Plant, duration: float) -> tuple[Panel, Panel]:
    """Natural frequencies and damping ratios of the structure without sleeves.

    Args:
        without: the effect.
        plant: with it.
        duration: of a record, s, at whose end a structure that changes in time is shown.
    """
    drifts = plant.structure.stiffness_rate != 0.0
    old, new = _free_modes(without), _free_modes(replace(plant, structure=plant.structure.at(duration)))
    nearest = [int(np.argmin(np.abs(np.log(old.natural_freqs / freq)))) for freq in new.natural_freqs]
    shift = PERCENT * (new.natural_freqs / old.natural_freqs[nearest] - 1.0)
    still = Curve("without", old.natural_freqs, np.zeros(len(old.natural_freqs)), marks=True)
    dampings: tuple[tuple[CurveName, NaturalModes], ...] = (("without", old), ("with", new))
    return (
        Panel(
            "free natural frequencies at the end" if drifts else "natural frequencies without sleeves",
            "mode [Hz]",
            "change [%]",
            (still, Curve("with", old.natural_freqs[nearest], shift, marks=True)),
            least_span=1.0,
        ),
        Panel(
            "free damping at the end" if drifts else "damping without sleeves",
            "mode [Hz]",
            "damping ratio [%]",
            tuple(
                Curve(name, modes.natural_freqs, PERCENT * modes.damping_ratios, marks=True) for name, modes in dampings
            ),
            from_zero=True,
        ),
    )


def _free_modes(plant: Plant) -> NaturalModes:
    bare = replace(plant, contacts=(), laws=())
    return natural_modes(linearised(build_modal(bare, STOP_EDGE * FS)), plant.sensors, BAND[1])


def _channel(bench: Bench, answers: Answers, sensor: int) -> tuple[Panel, Panel]:
    """One channel over itself as it was, at the low level: amplitude and phase."""
    before, after = (spectra(rows["low"][:, sensor]) for rows in (bench.answers, answers))
    cross, power = np.mean(after * before.conj(), axis=0), np.mean(np.abs(before) ** 2, axis=0)
    read = np.sqrt(np.mean(np.abs(after) ** 2, axis=0) / power)
    turned = np.rad2deg(np.angle(cross))
    name, freq = bench.rig.sensors[sensor].name, lines()
    return (
        Panel(
            f"{name} over {name} without, low level",
            "frequency [Hz]",
            "amplitude [-]",
            (Curve("without", freq, np.ones(len(freq))), Curve("with", freq, read)),
            log_y=bool(read.max() > MANY_TIMES * read.min()),
            least_span=1.0,
        ),
        Panel(
            f"{name} over {name} without, phase",
            "frequency [Hz]",
            "phase [deg]",
            (Curve("without", freq, np.zeros(len(freq))), Curve("with", freq, turned)),
            least_span=20.0,
        ),
    )


MANY_TIMES = 20.0
"""Largest over least amplitude above which a panel is logarithmic."""
