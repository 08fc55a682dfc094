"""Room in which the compiled stepper works on one step, and the names of its rows."""

from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray, IntArray

START, END = 2, 3
"""Beside the stages 0 and 1."""

Q, V, FORCE, LAW, BY_Q, BY_V = range(6)
"""Of a port: its motion, the force assumed there, the force that the laws give, and the slopes of that."""

Z, BY_Z, RATE, RATE_BY_Q, RATE_BY_V, RATE_BY_Z = range(6)
"""Of an item: its internal state, the slope of its force by that, the state's rate and the slopes of that."""


class Desk(NamedTuple):
    """Room for one step.

    Attributes:
        port: (6, 4, n_ports) ``Q`` to ``BY_V`` at the two stages, the step's start and its end.
        item: (6, 4, n_items) ``Z`` to ``RATE_BY_Z`` likewise.
        closed: (n_items,) 0 for an open contact, else the side on which it presses, 1 or -1; 2 for a bilateral one.
        strength: (2, n_sources) of the sources at the stages.
        free: (4, n_ports) motion of the ports at the stages without any source.
        matrix: Newton's equations for the forces at the stages, then for the internal states.
        fault: their right-hand side.
        pushed: (2, n) generalised force at the stages.
        new: (2n,) state at the step's end.
    """

    port: FloatArray
    item: FloatArray
    closed: IntArray
    strength: FloatArray
    free: FloatArray
    matrix: FloatArray
    fault: FloatArray
    pushed: FloatArray
    new: FloatArray


def make_desk(n: int, n_ports: int, n_items: int, n_sources: int) -> Desk:
    """Empty room for a system of n coordinates, its ports, point forces and sources."""
    size = 2 * (n_ports + n_items)
    return Desk(
        port=np.zeros((6, 4, n_ports)),
        item=np.zeros((6, 4, n_items)),
        closed=np.zeros(n_items, np.int64),
        strength=np.zeros((2, n_sources)),
        free=np.zeros((4, n_ports)),
        matrix=np.zeros((size, size)),
        fault=np.zeros(size),
        pushed=np.zeros((2, n)),
        new=np.zeros(2 * n),
    )
