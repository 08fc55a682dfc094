"""Frames of a moving rig: the beam between the walls of its sleeves, and the forces there."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from models.ports import Contact
from testbed.film.take import Take

WALL, BEAM, AXIS = "#8a6d3b", "#1f5a96", "0.8"
PUSHES = ("#b3471d", "#2d7d46", "#7a4fa3", "#8c8c2a")
"""Colours of the sleeves' forces, in their order."""

WIDTH, HEIGHT, DPI = 9.0, 5.2, 100
HALF_SLEEVE = 0.012
"""Half the drawn width of a sleeve, as a share of the beam's length."""

SOLID = 0.35
"""Opacity of a sleeve's wall: it yields, and a beam that is pressed into it is seen there."""


def frames(take: Take, n: int, title: str) -> Iterator[Image.Image]:
    """The frames, one after the other.

    Args:
        take: what moves.
        n: frames.
        title: above.
    """
    times, shapes = take.frames(n)
    figure = Figure(figsize=(WIDTH, HEIGHT), dpi=DPI, layout="constrained")
    canvas: Any = FigureCanvasAgg(figure)
    side, below = figure.subplots(2, 1, height_ratios=(3, 2))
    largest = 1e3 * max(float(np.abs(shapes).max()), max((_reach(c) for c in take.plant.contacts), default=0.0))
    _draw_sleeves(side, take, largest)
    _draw_forces(below, take)
    side.set_title(title, loc="left", fontsize=10)
    beam = side.plot([], [], color=BEAM, linewidth=3.5, solid_capstyle="round", animated=True)[0]
    clock = side.text(0.99, 0.95, "", transform=side.transAxes, ha="right", va="top", animated=True)
    now = below.axvline(times[0], color="0.3", linewidth=1.0, animated=True)
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    for time, shape in zip(times, shapes, strict=True):
        canvas.restore_region(still)
        beam.set_data(take.x, 1e3 * shape)
        clock.set_text(f"{time:.4f} s")
        now.set_xdata([time, time])
        for artist in (beam, clock):
            side.draw_artist(artist)
        below.draw_artist(now)
        yield Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())


def _reach(contact: Contact) -> float:
    return abs(contact.offset) + contact.clearance


def _draw_sleeves(ax: Axes, take: Take, largest: float) -> None:
    """The sleeves' walls, from where the beam's axis is when it touches them to the frame."""
    length = take.plant.structure.length
    height = 1.25 * largest
    ax.set_xlim(-0.02 * length, 1.02 * length)
    ax.set_ylim(-height, height)
    ax.axhline(0.0, color=AXIS, linewidth=0.8)
    ax.axvspan(-0.02 * length, 0.0, color="0.6")
    for number, contact in enumerate(take.plant.contacts):
        at, half = contact.position or 0.0, HALF_SLEEVE * length
        for wall in (1.0, -1.0):
            edge = 1e3 * (contact.offset + wall * contact.clearance)
            ax.fill_between([at - half, at + half], edge, wall * height, color=WALL, alpha=SOLID, linewidth=0.0)
            ax.plot([at - half, at + half], [edge, edge], color=WALL, linewidth=2.0, solid_capstyle="butt")
        ax.annotate(
            contact.sleeve, (at + half, -height), xytext=(3, 4), textcoords="offset points",
            color=PUSHES[number % len(PUSHES)], fontsize=9,
        )  # fmt: skip
    ax.set_xlabel("position [m]")
    ax.set_ylabel("beam's axis [mm]")


def _draw_forces(ax: Axes, take: Take) -> None:
    for number, (contact, force) in enumerate(zip(take.plant.contacts, take.contact_forces, strict=True)):
        ax.plot(take.force_time, force, color=PUSHES[number % len(PUSHES)], linewidth=1.0, label=contact.sleeve)
    if take.plant.contacts:
        ax.legend(loc="upper right", fontsize=8, ncols=len(take.plant.contacts))
    ax.set_xlim(take.time[0], take.time[-1])
    ax.set_xlabel("time [s]")
    ax.set_ylabel("force on the beam [N]")
    ax.grid(color="0.92")
