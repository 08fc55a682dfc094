"""What happened in the sleeves: the beam between their walls, and the forces there."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from models.arrays import FloatArray
from models.plant import Plant
from models.simulators.protocol import Motion

WALL, BEAM, PUSH = "0.75", "#1f5a96", "#b3471d"
WINDOW = 0.4
"""Seconds about the largest force that are drawn."""


def contact_figure(motion: Motion, plant: Plant, title: str) -> Figure:
    """For each sleeve the beam in its gap over time, with the force on it, about the largest force.

    Args:
        motion: finished.
        plant: whose sleeves they are.
        title: above.
    """
    n, part = motion.gaps.shape[1], _about_the_peak(motion)
    figure = Figure(figsize=(9.0, 2.6 * len(plant.contacts) + 0.6), layout="constrained")
    axes = figure.subplots(len(plant.contacts), 1, sharex=True, squeeze=False)[:, 0]
    time = np.arange(n)[part] / motion.fs
    for ax, contact, place, force in zip(axes, plant.contacts, motion.places, motion.contact_forces, strict=True):
        _draw(ax, time, 1e3 * place[part], force[part], 1e3 * contact.clearance, 1e3 * contact.offset)
        ax.set_title(f"{contact.sleeve}, {contact.position:.3g} m", loc="left", fontsize=10)
    axes[-1].set_xlabel("time [s]")
    plane = "" if motion.across is None else ", in the rig's plane"
    figure.suptitle(f"{title}: in the sleeves about the largest force{plane}", fontsize=11)
    return figure


def orbit_figure(motion: Motion, plant: Plant, title: str) -> Figure:
    """The way of the beam in each round sleeve, seen along its axis, about the largest force; paler is earlier.

    Args:
        motion: finished, in space.
        plant: whose sleeves they are.
        title: above.
    """
    assert motion.across is not None
    part, n = _about_the_peak(motion), len(plant.contacts)
    figure = Figure(figsize=(4.2 * n, 4.6), layout="constrained")
    rows = zip(plant.contacts, motion.places[:, part], motion.across.places[:, part], strict=True)
    for ax, (contact, up, aside) in zip(figure.subplots(1, n, squeeze=False)[0], rows, strict=True):
        ax.add_patch(
            Circle((0.0, 1e3 * contact.offset), 1e3 * contact.clearance, fill=False, color=WALL, linewidth=2.5)
        )
        age = np.linspace(0.15, 1.0, PIECES)
        for alpha, piece in zip(age, np.array_split(np.arange(len(up)), PIECES), strict=True):
            longer = slice(piece[0], piece[-1] + 2)  # on to the next piece
            ax.plot(1e3 * aside[longer], 1e3 * up[longer], color=BEAM, alpha=float(alpha), linewidth=1.0)
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_title(f"{contact.sleeve}, {contact.position:.3g} m", loc="left", fontsize=10)
        ax.set_xlabel("across the plane [mm]")
        ax.set_ylabel("in the plane [mm]")
        ax.grid(color="0.93")
    figure.suptitle(f"{title}: the beam's axis in its gaps, seen from the free end", fontsize=11)
    return figure


PIECES = 24
"""Of the way, from pale to full."""


def _about_the_peak(motion: Motion) -> slice:
    """The samples of ``WINDOW`` seconds about the largest force."""
    n, half = motion.gaps.shape[1], round(0.5 * WINDOW * motion.fs)
    peak = int(np.argmax(motion.pushes.max(axis=0)))
    first = max(0, min(peak - half, n - 2 * half))
    return slice(first, min(n, first + 2 * half))


def _draw(ax: object, time: FloatArray, place: FloatArray, force: FloatArray, clearance: float, offset: float) -> None:
    from matplotlib.axes import Axes

    assert isinstance(ax, Axes)
    for side in (-1.0, 1.0):
        ax.axhline(offset + side * clearance, color=WALL, linewidth=1.5)
    ax.plot(time, place, color=BEAM, linewidth=1.0)
    ax.set_ylabel("beam [mm]", color=BEAM)
    other = ax.twinx()
    other.fill_between(time, force, color=PUSH, alpha=0.35, linewidth=0.0)
    other.set_ylabel("force on it [N]", color=PUSH)
