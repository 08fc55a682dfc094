"""What the compiled stepper needs to know of the linear system: its step at every step size, as plain arrays."""

from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray
from models.fine.gauss import modal_steps

LEVELS = 5
QUARTERS = 4
TICKS = QUARTERS ** (LEVELS - 1)
"""Smallest steps in a whole one."""


class Tables(NamedTuple):
    """The linear system's step at each level, h / 4^level.

    Attributes:
        h: (LEVELS,) s.
        end: (LEVELS, 2, 4, n) of ``gauss.modal_steps``.
        free: (LEVELS, 4, n_ports, 2n) q then v at the early, then at the late stage, by the state.
        driven: (LEVELS, 4, n_ports, n_inputs, 2) the same by the inputs at the stages.
        reached: (LEVELS, 4, n_ports, 2, n_ports) the same by the port forces at the stages.
        ports: (n_ports, n) motion by coordinate.
        inputs: (n_inputs, n) generalised force of each input.
    """

    h: FloatArray
    end: FloatArray
    free: FloatArray
    driven: FloatArray
    reached: FloatArray
    ports: FloatArray
    inputs: FloatArray


def make_tables(omega: FloatArray, damping: FloatArray, ports: FloatArray, inputs: FloatArray, h: float) -> Tables:
    """The tables for whole steps of h.

    Args:
        omega, damping: (n,) rad/s and 1/s.
        ports: (n_ports, n).
        inputs: (n_inputs, n).
        h: s.
    """
    sizes = h / QUARTERS ** np.arange(LEVELS)
    pairs = [modal_steps(omega, damping, size) for size in sizes]
    stages = np.stack([stage.reshape(4, 4, -1) for _, stage in pairs])
    by_state = np.concatenate([stages[:, :, None, 0] * ports, stages[:, :, None, 1] * ports], axis=-1)
    return Tables(
        h=sizes,
        end=np.stack([end for end, _ in pairs]),
        free=np.ascontiguousarray(by_state),
        driven=np.ascontiguousarray(np.einsum("lrsn,pn,in->lrpis", stages[:, :, 2:], ports, inputs)),
        reached=np.ascontiguousarray(np.einsum("lrsn,pn,on->lrpso", stages[:, :, 2:], ports, ports)),
        ports=np.ascontiguousarray(ports),
        inputs=np.ascontiguousarray(inputs),
    )
