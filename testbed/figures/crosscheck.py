"""Pictures of the cross-check: each difference beside its bound, the sleeves in three simulators, the orders."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from models.plant import Plant
from models.simulators.protocol import Motion
from testbed.crosscheck.measures import Measure
from testbed.crosscheck.study import Convergence

COLOURS = {"modal": "0.25", "mujoco": "#b3471d", "exudyn": "#1f5a96"}
WINDOW = 0.12
"""Seconds drawn about the largest force."""


def bounds_figure(measures: Sequence[Measure]) -> Figure:
    """Each difference as a share of its bound, on a logarithmic axis; 1 is the bound.

    Args:
        measures: finished.
    """
    rows = list(dict.fromkeys((m.rig, m.quantity) for m in measures))
    figure = Figure(figsize=(9.0, 0.27 * len(rows) + 1.2), layout="constrained")
    ax = figure.subplots()
    for measure in measures:
        share = (1.0 - measure.value) / (1.0 - measure.bound) if measure.unit == "" else measure.value / measure.bound
        place = len(rows) - 1 - rows.index((measure.rig, measure.quantity))
        offset = 0.15 if measure.simulator == "mujoco" else -0.15
        ax.plot(max(share, LEAST_SHARE), place + offset, "o", color=COLOURS[measure.simulator], markersize=5)
    ax.axvline(1.0, color="0.2", linewidth=1.0)
    ax.set_xscale("log")
    ax.set_xlim(LEAST_SHARE, 3.0)
    ax.set_yticks(range(len(rows)), [f"{quantity} ({rig})" for rig, quantity in reversed(rows)], fontsize=8)
    ax.set_xlabel("difference from the modal model, as a share of its bound")
    ax.grid(axis="x", color="0.9")
    for name in dict.fromkeys(m.simulator for m in measures):
        ax.plot([], [], "o", color=COLOURS[name], label=name)
    ax.legend(loc="lower left", fontsize=8)
    return figure


LEAST_SHARE = 1e-4


def sleeves_figure(motions: Mapping[str, Motion], plant: Plant) -> Figure:
    """The force in each sleeve over time in all simulators, about the largest one.

    Args:
        motions: by simulator.
        plant: whose sleeves they are.
    """
    figure = Figure(figsize=(9.0, 2.4 * len(plant.contacts) + 0.5), layout="constrained")
    axes = figure.subplots(len(plant.contacts), 1, squeeze=False)[:, 0]
    first = next(iter(motions.values()))
    for number, (ax, contact) in enumerate(zip(axes, plant.contacts, strict=True)):
        peak = float(np.argmax(np.abs(first.contact_forces[number])) / first.fs)
        for name, motion in motions.items():
            time = np.arange(motion.gaps.shape[1]) / motion.fs
            part = np.abs(time - peak) < 0.5 * WINDOW
            style = {"linewidth": 3.0, "alpha": 0.4} if name == "modal" else {"linewidth": 1.0}
            ax.plot(time[part], motion.contact_forces[number][part], color=COLOURS[name], label=name, **style)
        ax.set_title(f"{contact.sleeve}, {contact.position:.3g} m", loc="left", fontsize=10)
        ax.set_ylabel("force on the beam [N]")
    axes[0].legend(fontsize=8)
    axes[-1].set_xlabel("time [s]")
    return figure


def convergence_figure(found: Sequence[Convergence]) -> Figure:
    """How errors fall with segments, elements, modes and steps.

    Args:
        found: each with its order.
    """
    parts, steps = ([c for c in found if ("steps" in c.what) == is_step] for is_step in (False, True))
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    for ax, rows, title in zip(
        figure.subplots(1, 2), (parts, steps), ("f1 to f4 free", "motion with impacts"), strict=True
    ):
        for row in rows:
            label = f"{row.simulator}: {row.what.split(',')[0]}, order {row.order:.1f}"
            ax.loglog(row.values, row.errors, "o-", color=COLOURS[row.simulator], label=label, markersize=4)
        ax.set_title(title, fontsize=10)
        ax.set_xlabel("how many")
        ax.set_ylabel("error [%]")
        ax.grid(which="both", color="0.92")
        ax.legend(fontsize=8)
    return figure
