"""What the compiled stepper needs to know of the linear system: its step at every step size, as plain arrays."""

from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray
from models.fine.gauss import modal_steps

LEVELS = 5
"""Step sizes, each a quarter of the one before."""


class Tables(NamedTuple):
    """The linear system's step at each level, h / 4^level. A source is a unit port force or a unit of a known input.

    Attributes:
        h: (LEVELS,) s.
        end: (LEVELS, 2, 4, n) of ``gauss.modal_steps``.
        free: (LEVELS, 4, n_ports, 2n) q and v of the ports at the early, then at the late stage, by the state.
        reached: (LEVELS, 4, n_ports, 2, n_sources) the same by the strength of the sources at the two stages.
        sources: (n_sources, n) generalised force of each: the ports', then the inputs'.
    """

    h: FloatArray
    end: FloatArray
    free: FloatArray
    reached: FloatArray
    sources: FloatArray


def make_tables(omega: FloatArray, damping: FloatArray, ports: FloatArray, inputs: FloatArray, h: float) -> Tables:
    """The tables for whole steps.

    Args:
        omega: (n,) rad/s.
        damping: (n,) 1/s.
        ports: (n_ports, n) motion of each port by coordinate.
        inputs: (n_inputs, n) generalised force of each known input.
        h: whole step, s.
    """
    sizes = np.array([h * 0.25**level for level in range(LEVELS)])
    pairs = [modal_steps(omega, damping, float(size)) for size in sizes]
    stages = np.stack([stage.reshape(4, 4, -1) for _, stage in pairs])
    sources = np.concatenate([ports, inputs])
    return Tables(
        h=sizes,
        end=np.stack([end for end, _ in pairs]),
        free=np.concatenate([stages[:, :, None, 0] * ports, stages[:, :, None, 1] * ports], axis=-1),
        reached=np.ascontiguousarray(np.einsum("lrtn,pn,sn->lrpts", stages[:, :, 2:], ports, sources)),
        sources=sources,
    )
