"""A modal model marched through what drives it, its structure as it is or with a bending stiffness that grows."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from models.arrays import FloatArray
from models.drift_tables import AT_ONCE, segments_of, steps_of_segment
from models.drive import Drive
from models.modal import ModalModel
from models.propagator import Blocks
from models.step_tables import items_of, linear_of, linear_with, signals_of
from models.stepping import Memory, Reading, march, march_on
from models.structure import check_drift


def march_model(
    model: ModalModel,
    drive: Drive,
    h: float,
    band: float,
    start: FloatArray | None,
    read: Callable[[Blocks], FloatArray],
    out: FloatArray,
    trace: FloatArray,
    tolerance: float,
) -> int:
    """March over all columns of ``out`` and record.

    Args:
        model: that moves.
        drive: its inputs at every step.
        h: step, s.
        band: highest frequency of interest, Hz.
        start: (2m,) modal displacements and velocities, from rest; None for rest.
        read: (n_out, 2n) rows by the state of a system.
        out: (n_out, n_steps + 1), filled.
        trace: of ``stepping.march_on``, filled.
        tolerance: change of a force that ends the iteration in a step, N.

    Returns:
        the number of steps done; less than n_steps where the motion left the finite numbers.

    Raises:
        DivergenceError: a stiffness that drifts is used up.
    """
    if model.plant.structure.stiffness_rate != 0.0:
        return _march_drifting(model, drive, h, band, start, read, out, trace, tolerance)
    system, linear, inputs = linear_of(model, drive, h)
    state = np.zeros(len(system.from_modal)) if start is None else system.from_modal @ start
    done: int = march(
        linear, items_of(model), inputs, drive.base_motion, state, Reading.of(read(system)), out, trace, tolerance
    )
    return done


def _march_drifting(
    model: ModalModel,
    drive: Drive,
    h: float,
    band: float,
    start: FloatArray | None,
    read: Callable[[Blocks], FloatArray],
    out: FloatArray,
    trace: FloatArray,
    tolerance: float,
) -> int:
    """The same in segments of constant stiffness, each going on from the state and the memory of the one before."""
    n_steps, m, rate = int(out.shape[1] - 1), model.n, model.plant.structure.stiffness_rate
    check_drift(rate, n_steps * h)
    items = items_of(model)
    memory = Memory.fresh(len(model.ports), len(items.port))
    columns, signals = signals_of(model, drive)
    columns, signals = [*columns, -1], [*(s[: n_steps + 1] for s in signals), rate * h * np.arange(n_steps + 1.0)]
    inputs, base = np.stack(signals), drive.base_motion
    rows = read(_of_modes(m))
    length = steps_of_segment(rate, model.omega, band, h)
    modal = np.zeros(2 * m) if start is None else start
    for number, first in enumerate(range(0, max(n_steps, 1), length)):
        last, s = min(first + length, n_steps), number % AT_ONCE
        if s == 0:
            segments = segments_of(model, h, length, number // AT_ONCE)
            readings = segments.read(rows)
        at = slice(first, last + 1)
        linear = linear_with(model, segments.step(s), columns, segments.motion(s), h)
        state, part = segments.from_modal[s] @ modal, np.empty((len(out), last - first + 1))
        done: int = march_on(
            linear, items, np.ascontiguousarray(inputs[:, at]), np.ascontiguousarray(base[:, at]), state, memory, first,
            readings[s], part, trace[at], tolerance,
        )  # fmt: skip
        out[:, at] = part
        if done < last - first:
            return first + done
        modal = segments.to_modal[s] @ state
    return n_steps


@lru_cache(maxsize=16)
def _of_modes(m: int) -> Blocks:
    """A system whose state is the modal displacements and velocities; of it only what it reads is asked."""
    return Blocks(np.empty((0, 2, 2)), np.empty((0, 0)), np.eye(2 * m), np.eye(2 * m))
