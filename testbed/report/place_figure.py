"""The picture of the place: where along the beam one missing force explains most, what it follows, and its course."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from identification.locating.located import Shape
from identification.result import Diagnosis
from models.rig import Rig
from testbed.figures.report_force import plot_force_close, plot_force_in_time
from testbed.figures.report_place import plot_channels, plot_curve, plot_profile
from testbed.figures.report_style import literal
from testbed.report.figures import DOTS, WIDTH
from testbed.report.picture import Picture, picture


def place_picture(diagnosis: Diagnosis, rig: Rig) -> Picture | None:
    """Where along the beam one missing force explains most, and its shape there; None where no place was looked for."""
    found = diagnosis.located
    if found is None:
        return None
    rows = 3 if found.shape is not None else 1
    figure = Figure(figsize=(WIDTH, 2.6 * rows), layout="constrained")
    upper, *lower = figure.subfigures(rows, 1, squeeze=False)[:, 0]
    profile, channels = upper.subplots(1, 2, width_ratios=(3.2, 1.0))
    plot_profile(
        profile,
        found.positions,
        found.explained,
        interval=found.interval,
        sleeves={s.name: s.position for s in rig.sleeves if s.position is not None},
        sensors={s.name: s.position for s in rig.sensors if s.position is not None},
    )
    plot_channels(
        channels,
        tuple(channel.sensor for channel in found.channels),
        np.array([channel.explained for channel in found.channels]),
    )
    if found.shape is not None:
        panels = panels_of(found.shape)
        _draw_shape(lower[0].subplots(1, len(panels)), panels, found.shape)
        _draw_course(lower[1].subplots(1, 2, width_ratios=(1.6, 1.0)), found.shape)
    profiles = (
        "how much of the misfit beyond the noise one force explains, free in time, wherever it acts; beside it "
        "the same for a signal of one channel's own."
    )
    below = (
        " Below: the force at the most likely place; means in bins with two standard errors, the band in which it is "
        "not told filled by what it follows. Last: its course in the record where it is largest, and close up around "
        "its largest value, with the displacement there (dashed)."
    )
    caption = f"H{profiles[1:]}" if found.shape is None else f"Above: {profiles}{below}"
    return picture(figure, f"Place of the missing force: {found.words}", caption)


Panel = tuple[str, float, str]
"""Quantity, factor to the shown unit, and label."""

MOTION: tuple[Panel, ...] = (
    ("displacement", 1e3, "displacement [mm]"),
    ("velocity", 1e3, "velocity [mm/s]"),
    ("acceleration", 1.0, "acceleration [m/s$^2$]"),
)
SIZES: tuple[Panel, ...] = (("time", 1.0, "time [s]"), ("amplitude", 1e3, "amplitude [mm]"))


def panels_of(shape: Shape) -> tuple[Panel, ...]:
    """Displacement and velocity, acceleration where it predicts the force best, and the force's sizes.

    Args:
        shape: of the force.
    """
    explained = dict(shape.explained)
    best = max((name for name, _, _ in MOTION if name in explained), key=lambda name: explained[name])
    return (*MOTION[: 3 if best == "acceleration" else 2], *SIZES)


def _draw_shape(axes: Sequence[Axes], panels: Sequence[Panel], shape: Shape) -> None:
    curves, kept = {curve.of: curve for curve in shape.curves}, DOTS // (4 * len(shape.samples))
    for ax, (name, scale, label) in zip(axes, panels, strict=True):
        curve, dots = curves[name], None
        if name in ("displacement", "velocity"):
            thinned = [(s.q if name == "displacement" else s.v, s.force) for s in shape.samples]
            x, y = (np.concatenate([pair[k][:: max(1, len(pair[k]) // kept)] for pair in thinned]) for k in (0, 1))
            dots = scale * x, y
        middle = shape.middle if name == "displacement" else 0.0
        plot_curve(ax, dots, (scale * (curve.x + middle), curve.mean, curve.error), label)
    axes[0].set_ylabel("force [N]")
    for ax in axes[-len(SIZES) :]:
        ax.set_title("its mean size", loc="left")


def _draw_course(axes: Sequence[Axes], shape: Shape) -> None:
    largest = max(shape.samples, key=lambda sample: float(np.abs(sample.force).max()))
    n, middle = len(largest.force), int(np.argmax(np.abs(largest.force)))
    half = max(CLOSE_UP_SAMPLES, int(CLOSE_UP * n)) // 2
    near = slice(max(0, middle - half), min(n, middle + half))
    whole, close = axes
    plot_force_in_time(whole, largest.time, largest.force)
    whole.set_title(literal(largest.record), loc="left")
    whole.set_ylabel("force [N]")
    plot_force_close(close, largest.time[near], largest.force[near], 1e3 * largest.q[near])


CLOSE_UP, CLOSE_UP_SAMPLES = 0.02, 200
"""Share of a record that is shown close up, and samples at least."""
