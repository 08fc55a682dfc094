"""Pictures of the study of contact laws: restitution set and obtained, force over penetration, what a beam loses."""

from collections.abc import Mapping, Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.ball import Strike
from testbed.contact_laws.ball_study import SPEEDS, BallRow
from testbed.contact_laws.beam_study import HOLDS, BeamRow
from testbed.contact_laws.laws import STUDY_LAWS
from testbed.figures.crosscheck import COLOURS

LOOP_SET, LOOP_SPEED = 0.5, SPEEDS[1]
MARKERS = {"modal": "", "mujoco": "x", "exudyn": "+"}
LEGEND_SIZE = 8


def _colours() -> dict[str, tuple[float, ...]]:
    return dict(zip(STUDY_LAWS, mpl.colormaps["tab10"].colors, strict=False))  # type: ignore[attr-defined]


def restitution_figure(rows: Sequence[BallRow]) -> Figure:
    """Restitution obtained over set, a panel for each speed: closed forms as lines, simulators as marks.

    Args:
        rows: of all simulators.
    """
    figure = Figure(figsize=(12.0, 4.4), layout="constrained")
    axes = figure.subplots(1, len(SPEEDS), sharex=True, sharey=True)
    for ax, speed in zip(axes, SPEEDS, strict=True):
        ax.plot([0.0, 1.0], [0.0, 1.0], color="0.8", linewidth=4.0)
        for key, colour in _colours().items():
            own = [row for row in rows if (row.law, row.speed) == (key, speed)]
            first = [row for row in own if row.simulator == "modal"]
            name = STUDY_LAWS[key].name
            ax.plot([r.set for r in first], [r.expected for r in first], color=colour, label=name, linewidth=1.2)
            for simulator, marker in MARKERS.items():
                marks = [row for row in own if row.simulator == simulator and marker]
                ax.plot([r.set for r in marks], [r.obtained for r in marks], marker, color=colour, markersize=6)
        ax.set_title(f"struck at {speed:g} m/s", loc="left", fontsize=10)
        ax.set_xlabel(f"restitution set at {SPEEDS[1]:g} m/s")
    axes[0].set_ylabel("restitution obtained")
    for simulator, marker in MARKERS.items():
        axes[-1].plot([], [], marker or "-", color="0.3", label="closed form" if not marker else simulator)
    figure.legend(*axes[-1].get_legend_handles_labels(), loc="outside right center", fontsize=LEGEND_SIZE)
    return figure


def loops_figure(strikes: Mapping[str, Strike]) -> Figure:
    """Force of the stop over penetration in one strike with each law; what a loop encloses is lost.

    Args:
        strikes: by law.
    """
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    ax: Axes = figure.subplots()
    for key, colour in _colours().items():
        strike = strikes[key]
        depth = 1e3 * (strike.place - strike.ball.room)
        pressed = depth > 0.0
        ax.plot(depth[pressed], strike.force[pressed], color=colour, label=STUDY_LAWS[key].name)
    ax.set_xlabel("penetration [mm]")
    ax.set_ylabel("force of the stop [N]")
    ax.set_title(f"A ball at {LOOP_SPEED:g} m/s, every law set for {LOOP_SET:g}", loc="left", fontsize=10)
    ax.legend(fontsize=LEGEND_SIZE)
    return figure


def beam_figure(rows: Sequence[BeamRow]) -> Figure:
    """Share of the energy that sleeves took or hold, and largest force, over the restitution set; the middle height.

    Args:
        rows: of all simulators.
    """
    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for key, colour in _colours().items():
        for simulator, marker in MARKERS.items():
            own = [row for row in rows if (row.law, row.simulator, row.hold) == (key, simulator, HOLDS[1])]
            wanted = [row.set for row in own]
            name = STUDY_LAWS[key].name if not marker else None
            for ax, values in ((left, [100.0 * r.taken / r.stored for r in own]), (right, [r.peak for r in own])):
                ax.plot(wanted, values, marker or "-", label=name, color=colour, markersize=6, linewidth=1.2)
    for simulator, marker in MARKERS.items():
        left.plot([], [], marker or "-", color=COLOURS[simulator], label=simulator)
    for ax in (left, right):
        ax.set_xlabel("restitution set")
    left.set_ylabel("energy that sleeves took or hold [%]")
    right.set_ylabel("largest force in a sleeve [N]")
    left.set_title(f"let go from {HOLDS[1]:g} N", loc="left", fontsize=10)
    figure.legend(*left.get_legend_handles_labels(), loc="outside right center", fontsize=LEGEND_SIZE)
    return figure
